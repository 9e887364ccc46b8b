#!/usr/bin/python3
"""extract_responses and check_replay over a run of the model itself; against the tools. Arguments: the tools."""

import csv
import os
import subprocess
import sys
import tempfile
import unittest

import numpy
import rosbag

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import vibro_impact  # noqa: E402
from recorded_run import BLOCK, stepped_sine, write_run  # noqa: E402

LIMITING_CASE = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "config", "limiting_case.yaml")
TOOLS = {os.path.basename(path): path for path in sys.argv[1:] if os.sep in path}
class ResponsesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = vibro_impact.load_model(LIMITING_CASE)
        # Whose impacts no rounding of their dates can spoil: it has none.
        cls.apart = vibro_impact.Model(cls.model.configuration.replace("clearance: 0", "clearance: 1"))
        cls.acceleration = stepped_sine(numpy.array([0.8, 0.85, 0.9]) * cls.model.reference_frequency, 50, 10.0)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.path = os.path.join(self.folder, "run.bag")

    def assert_refused(self, words, function, *arguments, **options):
        with self.assertRaises(vibro_impact.Error) as caught:
            function(*arguments, **options)
        self.assertEqual(len(str(caught.exception).splitlines()), 1)
        for word in words:
            self.assertIn(word, str(caught.exception))

    def test_responses_are_the_tools(self):
        write_run(self.path, self.acceleration, self.model)
        shares = []
        result = vibro_impact.extract_responses(self.path, progress=shares.append)
        self.assertEqual(shares[-1], 1.0)
        self.assertEqual(len(result.responses), 3)
        numpy.testing.assert_allclose(result.responses["omega_star"], [0.8, 0.85, 0.9], rtol=1e-6)
        out = os.path.join(self.folder, "out")
        subprocess.run([TOOLS["extract_frf"], self.path, "--out", out], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for name, array in (("frf.csv", result.responses), ("impacts.csv", result.impacts)):
            with open(os.path.join(out, name), newline="") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual(list(rows[0]), list(array.dtype.names))
            for column in rows[0]:
                values = [float(row[column]) for row in rows]
                numpy.testing.assert_array_equal(array[column].astype(float), values, column)
        self.assertEqual((result.left_out, result.losses), ([], []))
        self.assertEqual(result.contacts, [(0, self.model.stiffness, self.model.clearance, 3)])
        self.assertEqual(result.summary.samples, len(self.acceleration))

    def test_losses_leave_steps_out(self):
        write_run(self.path, self.acceleration, self.model, lost=[BLOCK * 5])
        self.assert_refused(["not complete", "seq 1250 to 1499"], vibro_impact.extract_responses, self.path)
        result = vibro_impact.extract_responses(self.path, allow_gaps=True)
        self.assertEqual(result.losses[0][:2], (1250, 1500))
        self.assertGreater(len(result.left_out), 0)
        self.assertIn("seq 1250 to 1499", result.left_out[0][3])
        numpy.testing.assert_allclose(result.responses["omega_star"][-2:], [0.85, 0.9], rtol=1e-6)

    def test_replay(self):
        gap, force, impacts = write_run(self.path, self.acceleration, self.apart)
        report = vibro_impact.check_replay(self.path)
        self.assertIsNone(report.difference)
        self.assertTrue(report.complete)
        self.assertEqual((report.samples, report.starts, report.impacts), (len(self.acceleration), 1, 0))

    def test_run_is_read_as_it_was_written(self):
        gap, force, impacts = write_run(self.path, self.acceleration, self.model)
        recording = vibro_impact.read_bag(self.path)
        numpy.testing.assert_array_equal(recording.gap, gap)
        numpy.testing.assert_array_equal(recording.contact_force, force)
        self.assertGreater(len(impacts), 50)
        numpy.testing.assert_allclose(recording.impacts["onset"], impacts["onset"], rtol=1e-12)
        self.assertEqual(recording.models[0].configuration, self.model.configuration)

    def test_replay_finds_a_changed_bit(self):
        write_run(self.path, self.acceleration, self.apart)
        other = os.path.join(self.folder, "other.bag")
        with rosbag.Bag(self.path) as bag, rosbag.Bag(other, "w") as spoilt:
            for topic, message, time in bag.read_messages():
                if topic == "/gap" and message.seq == 500:
                    message.gap = list(message.gap)
                    message.gap[7] = numpy.nextafter(message.gap[7], 1.0)
                spoilt.write(topic, message, time)
        report = vibro_impact.check_replay(other)
        self.assertEqual(report.difference.topic, "/gap")
        self.assertIn("507", report.difference.place)
        self.assertEqual(report.samples, 500)
        self.assertNotEqual(report.difference.recorded, report.difference.recomputed)

    def test_arguments_out_of_range(self):
        write_run(self.path, self.acceleration[:5000], self.model)
        extract, check = vibro_impact.extract_responses, vibro_impact.check_replay
        self.assert_refused(["shortest_step is 3", "4 to 1000000"], extract, self.path, shortest_step=3)
        self.assert_refused(["acceleration_tolerance is 1"], extract, self.path, acceleration_tolerance=1)
        self.assert_refused(["lowest_frequency is 0"], extract, self.path, lowest_frequency=0)
        self.assert_refused(["lowest_frequency"], extract, self.path, lowest_frequency=20000)
        self.assert_refused(["max_bridged_gap is -1"], check, self.path, max_bridged_gap=-1)
        self.assert_refused(["nowhere.bag: no such file"], check, "nowhere.bag")
        self.assert_refused(["holds 1 topic of type"], extract, self.path, namespace="/rig1")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
