#!/usr/bin/python3
"""read_bag over bags that rosbag's Python API has written."""

import os
import signal
import subprocess
import sys
import tempfile
import unittest

import numpy

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import vibro_impact  # noqa: E402
from synthetic_bag import BLOCK, PERIOD, START, SyntheticBag, join_with_rosbag, stamp_of  # noqa: E402

from vibro_impact.msg import ModelInfo  # noqa: E402


class ReadBagTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.path = os.path.join(self.folder, "run.bag")
        self.run_ = SyntheticBag()

    def assert_same(self, recording, run):
        numpy.testing.assert_array_equal(recording.acceleration, run.acceleration)
        numpy.testing.assert_array_equal(recording.gap, run.gap)
        numpy.testing.assert_array_equal(recording.contact_force, run.force)
        self.assertEqual(recording.losses, [])

    def assert_lost(self, values, original, *lost):
        """NaN in the blocks that begin at `lost`, the original elsewhere."""
        expected = original.copy()
        for begin in lost:
            expected[begin : begin + BLOCK] = numpy.nan
        numpy.testing.assert_array_equal(values, expected)

    def assert_refused(self, words, bags, **options):
        with self.assertRaises(vibro_impact.Error) as caught:
            vibro_impact.read_bag(bags, **options)
        text = str(caught.exception)
        self.assertEqual(len(text.splitlines()), 1, text)
        for word in words:
            self.assertIn(word, text)

    def test_whole_run(self):
        for compression in ("none", "bz2", "lz4"):
            with self.subTest(compression):
                self.run_.write(self.path, compression=compression, chunk_threshold=5000)
                recording = vibro_impact.read_bag(self.path)
                self.assert_same(recording, self.run_)
                joined = join_with_rosbag(self.path)
                numpy.testing.assert_array_equal(recording.acceleration, joined["base_excitation"])
                numpy.testing.assert_array_equal(recording.gap, joined["gap"])
                numpy.testing.assert_array_equal(recording.contact_force, joined["contact_force"])
        self.assertEqual(recording.sample_period, PERIOD)
        self.assertEqual(recording.first, 0)
        self.assertEqual(recording.start_stamp, (START.secs, START.nsecs))
        numpy.testing.assert_array_equal(recording.time, numpy.arange(2000) * PERIOD)
        self.assertIs(recording.time, recording.time)
        self.assertEqual(recording.topics["gap"], "/gap")
        summary = recording.summary
        self.assertEqual((summary.blocks, summary.samples, summary.repeated, summary.restarts), (20, 2000, 0, 0))
        self.assertEqual(summary.impacts, len(recording.impacts))
        self.assertEqual(recording.starts, [(0, "first", "")])
        (model,) = recording.models
        self.assertEqual((model.version, model.configuration, model.seq, model.number), ("0.1.0", "beam: 1", 0, 0))
        self.assertEqual(list(model.free_frequencies), [1.0, 2.0])
        self.assertEqual(list(model.contact_frequencies), [3.0])
        self.assertEqual(len(model.mapping_loss), 0)

    def test_impacts(self):
        self.run_.write(self.path)
        impacts = vibro_impact.read_bag(self.path).impacts
        self.assertEqual(len(impacts), len(self.run_.onsets))
        numpy.testing.assert_allclose(impacts["onset"], numpy.array(self.run_.onsets) * PERIOD, rtol=1e-14)
        messages = [message for _, _, message in self.run_.of("impact")]
        for name in impacts.dtype.names:
            if name != "onset":
                with self.subTest(name):
                    self.assertEqual(list(impacts[name]), [getattr(message, name) for message in messages])

    def test_arrays_outlive_the_recording_and_are_not_copied(self):
        self.run_.write(self.path)
        recording = vibro_impact.read_bag(self.path)
        gap = recording.gap
        self.assertIs(gap.flags.owndata, False)
        self.assertIs(gap.dtype, numpy.dtype(float))
        del recording
        numpy.testing.assert_array_equal(gap, self.run_.gap)

    def test_middle_of_a_stream(self):
        run = SyntheticBag(first=123400)
        run.write(self.path)
        recording = vibro_impact.read_bag(self.path)
        self.assert_same(recording, run)
        self.assertEqual(recording.first, 123400)
        self.assertEqual(recording.time[0], 0.0)
        numpy.testing.assert_allclose(recording.impacts["onset"], numpy.array(run.onsets) * PERIOD, rtol=1e-14)

    def test_losses_are_nan_and_listed(self):
        self.run_.drop("base_excitation", 500, 600)
        self.run_.drop("gap", 900)
        self.run_.drop("contact_force", 1500)
        lost_impact = self.run_.of("impact")[3][2]
        self.run_.drop("impact", lost_impact.seq)
        self.run_.write(self.path)
        recording = vibro_impact.read_bag(self.path)
        self.assert_lost(recording.acceleration, self.run_.acceleration, 500, 600)
        # Nobody knows what an answer without its question answers.
        self.assert_lost(recording.gap, self.run_.gap, 500, 600, 900)
        self.assert_lost(recording.contact_force, self.run_.force, 500, 600, 1500)
        self.assertEqual([loss[:2] for loss in recording.losses if "/impact" not in loss[2]], [(500, 700), (900, 1000), (1500, 1600)])
        (impact,) = [reason for _, _, reason in recording.losses if "/impact" in reason]
        self.assertIn("number 3 to 3 (1 impact", impact)
        self.assertEqual(recording.summary.blocks, 18)

    def test_a_block_that_is_not_finite_is_lost(self):
        _, _, message = self.run_.of("base_excitation")[4]
        message.acceleration = [float("inf")] + list(message.acceleration[1:])
        _, _, message = self.run_.of("gap")[7]
        message.gap = list(message.gap[:-1]) + [float("nan")]
        _, _, message = self.run_.of("contact_force")[9]
        message.force = [-float("inf")] + list(message.force[1:])
        self.run_.write(self.path)
        recording = vibro_impact.read_bag(self.path)
        self.assert_lost(recording.acceleration, self.run_.acceleration, 400)
        self.assert_lost(recording.gap, self.run_.gap, 700)
        self.assert_lost(recording.contact_force, self.run_.force, 900)
        self.assertEqual([loss[:2] for loss in recording.losses], [(400, 500), (700, 800), (900, 1000)])
        for (_, _, reason), topic in zip(recording.losses, ("base_excitation", "gap", "contact_force")):
            self.assertIn(topic, reason)
            self.assertIn("not finite", reason)

    def test_an_answer_to_something_else_is_lost(self):
        _, _, message = self.run_.of("gap")[4]
        message.gap = message.gap[:-1]
        self.run_.write(self.path)
        recording = vibro_impact.read_bag(self.path)
        self.assert_lost(recording.gap, self.run_.gap, 400)
        self.assertIn("has 99 samples instead of 100", recording.losses[0][2])

    def test_repetitions_are_left_out(self):
        for topic in ("base_excitation", "gap", "contact_force", "impact", "stream_start", "model_info"):
            time, _, message = self.run_.of(topic)[-1]
            self.run_.add(topic, message, time + (stamp_of(10 * BLOCK) - START))
        self.run_.write(self.path)
        recording = vibro_impact.read_bag(self.path)
        self.assert_same(recording, self.run_)
        self.assertEqual(recording.summary.repeated, 1)
        self.assertEqual(recording.summary.blocks, 20)
        self.assertEqual(len(recording.impacts), len(self.run_.onsets))
        self.assertEqual((len(recording.starts), len(recording.models)), (1, 1))

    def test_another_model_with_the_same_numbers_is_no_repetition(self):
        time, _, message = self.run_.of("model_info")[0]
        other = ModelInfo(**{name: getattr(message, name) for name in message.__slots__})
        other.configuration = "beam: 2"
        self.run_.add("model_info", other, time + (stamp_of(10 * BLOCK) - START))
        self.run_.write(self.path)
        models = vibro_impact.read_bag(self.path).models
        self.assertEqual([model.configuration for model in models], ["beam: 1", "beam: 2"])

    def test_split_bag(self):
        parts = []
        for number in range(3):
            parts.append(os.path.join(self.folder, "part_%d.bag" % number))
            self.run_.write(parts[-1], share=(number / 3.0, (number + 1) / 3.0))
        self.assert_same(vibro_impact.read_bag(parts), self.run_)
        self.assert_same(vibro_impact.read_bag(tuple(reversed(parts))), self.run_)

    def test_paths_and_texts_need_not_be_utf_8(self):
        folder = os.fsencode(self.folder)
        path = os.path.join(folder, b"caf\xe9.bag")
        self.run_.of("model_info")[0][2].configuration = "caf\x01: 1"
        self.run_.write(self.path)
        with open(self.path, "rb") as file:
            raw = file.read()
        with open(path, "wb") as file:
            file.write(raw.replace(b"caf\x01", b"caf\xe9"))
        for form in (path, os.fsdecode(path), [os.fsdecode(path)]):
            recording = vibro_impact.read_bag(form)
            self.assert_same(recording, self.run_)
            self.assertEqual(recording.models[0].configuration, "caf\ufffd: 1")
        self.assert_refused(["caf\ufffd2.bag: no such file"], os.path.join(folder, b"caf\xe92.bag"))

    def test_namespaces(self):
        other = SyntheticBag(seed=2)
        self.run_.write(self.path, namespace="/rig1")
        other.write(self.path, namespace="/rig2", append=True)
        self.assert_refused(["holds 2 topics", "/rig1/base_excitation", "/rig2/base_excitation"], self.path)
        self.assert_same(vibro_impact.read_bag(self.path, namespace="/rig1"), self.run_)
        recording = vibro_impact.read_bag(self.path, namespace="rig2")
        self.assert_same(recording, other)
        self.assertEqual(recording.topics["impact"], "/rig2/impact")

    def test_excitation_is_chosen_by_its_topic(self):
        for time, _, message in self.run_.of("base_excitation"):
            self.run_.add("measured", message, time)
        self.run_.write(self.path)
        self.assert_refused(["holds 2 topics", "/measured"], self.path)
        self.assertEqual(vibro_impact.read_bag(self.path, excitation="measured").topics["base_excitation"], "/measured")
        self.assert_refused(["no topic /force of type"], self.path, excitation="/force")

    def test_streams_of_a_restarted_excitation(self):
        second = SyntheticBag(blocks=7, start=stamp_of(20 * BLOCK + 9000), seed=2)
        self.run_.write(self.path)
        second.write(self.path, append=True)
        self.assert_refused(["seq 0: the stream restarts"], self.path)
        self.assert_same(vibro_impact.read_bag(self.path, stream=0), self.run_)
        recording = vibro_impact.read_bag(self.path, stream=1)
        self.assert_same(recording, second)
        self.assertEqual(recording.start_stamp, (stamp_of(11000).secs, stamp_of(11000).nsecs))
        self.assertEqual(len(recording.impacts), len(second.onsets))
        self.assertEqual(len(recording.starts), 1)
        self.assert_refused(["stream is 2, must be less than 2"], self.path, stream=2)

    def test_a_hole_greater_than_memory_is_refused(self):
        far = SyntheticBag(blocks=2, first=1 << 40, start=stamp_of(1 << 40))
        self.run_.write(self.path)
        far.write(self.path, append=True)
        self.assert_refused(["samples are missing before it"], self.path)
        recording = vibro_impact.read_bag(self.path, stream=0)
        numpy.testing.assert_array_equal(recording.gap, self.run_.gap)
        self.assertIn("(2 blocks, answered) is missing", recording.losses[0][2])

    def test_bags_that_are_none(self):
        self.assert_refused(["nowhere.bag: no such file"], os.path.join(self.folder, "nowhere.bag"))
        self.assert_refused(["is not a file"], self.folder)
        self.assert_refused(["no bag is given"], [])
        with open(self.path, "w") as file:
            file.write("no bag\n")
        self.assert_refused([self.path, "is not a bag"], self.path)
        with self.assertRaises(TypeError):
            vibro_impact.read_bag(3)
        with self.assertRaises(TypeError):
            vibro_impact.read_bag(self.path, stream=-1)

    def test_topics_are_missing(self):
        for topic in ("base_excitation", "gap", "contact_force", "model_info"):
            run = SyntheticBag()
            run.messages = [m for m in run.messages if m[1] != topic]
            run.write(self.path)
            self.assert_refused(["holds no topic of type vibro_impact/"], self.path)

    def test_damaged_bags(self):
        self.run_.write(self.path)
        with open(self.path, "rb") as file:
            whole = file.read()
        for keep in (20, 4200, len(whole) // 2, len(whole) - 10):
            with self.subTest(keep):
                with open(self.path, "wb") as file:
                    file.write(whole[:keep])
                self.assert_refused([self.path], self.path)
        # A length in the middle of the messages.
        spoilt = bytearray(whole)
        at = spoilt.index(b"op=\x02") - 4
        spoilt[at : at + 4] = b"\xff\xff\xff\x7f"
        with open(self.path, "wb") as file:
            file.write(spoilt)
        self.assert_refused([self.path, "damaged"], self.path)

    def test_progress(self):
        self.run_.write(self.path)
        shares = []
        vibro_impact.read_bag(self.path, progress=shares.append)
        self.assertEqual(shares, sorted(shares))
        self.assertEqual(shares[-1], 1.0)

        def fail(share):
            raise KeyError(share)

        with self.assertRaises(KeyError):
            vibro_impact.read_bag(self.path, progress=fail)

    def test_interrupt(self):
        self.run_.write(self.path)

        def interrupt(_):
            os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            for _ in range(100):
                vibro_impact.read_bag(self.path, progress=interrupt)

    def test_messages_load_nothing_else(self):
        program = "import sys; from vibro_impact.msg import Gap; sys.exit('vibro_impact._recording' in sys.modules)"
        self.assertEqual(subprocess.run([sys.executable, "-c", program]).returncode, 0)


if __name__ == "__main__":
    unittest.main()
