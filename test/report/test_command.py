#!/usr/bin/python3
"""scripts/report, run as a user runs it."""

import html
import json
import os
import re
import stat
import subprocess
import sys
import tempfile
import unittest

import numpy as np

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, HERE)
import recorded  # noqa: E402

import vibro_impact  # noqa: E402

SCRIPT = os.path.join(HERE, "..", "..", "scripts", "report")


class Command(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.stepped = os.path.join(cls.folder.name, "stepped.bag")
        drive = recorded.stepped_sine([1.2, 1.6, 2.0], 40)
        recorded.write_bag(cls.stepped, recorded.configuration(), drive)
        cls.linear = os.path.join(cls.folder.name, "linear.bag")
        recorded.write_bag(cls.linear, recorded.configuration(clearance=1e-2), recorded.random_drive(4.0))
        cls.lossy = os.path.join(cls.folder.name, "lossy.bag")
        recorded.write_bag(cls.lossy, recorded.configuration(), drive, lost_blocks=(2,))
        cls.quiet = os.path.join(cls.folder.name, "quiet.bag")
        recorded.write_bag(cls.quiet, recorded.configuration(clearance=1e-3), np.zeros(5000))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def setUp(self):
        out = tempfile.TemporaryDirectory()
        self.addCleanup(out.cleanup)
        self.folder_out = out.name
        self.out = os.path.join(out.name, "page.html")

    def folder_in(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        return folder.name

    def report(self, *arguments):
        return subprocess.run(
            [SCRIPT, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True
        )

    def page(self, *arguments):
        """(text of the page, its data)."""
        result = self.report(*arguments, "--out", self.out)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(os.listdir(self.folder_out), ["page.html"])
        with open(self.out, encoding="utf-8") as file:
            text = file.read()
        return text, json.loads(
            re.search(r'<script type="application/json" id="report-data">(.*?)</script>', text).group(1)
        )

    def assert_says(self, text, words):
        # Without the page itself in the message.
        self.assertTrue(words in text, words)

    def assert_refused(self, result, status, *words):
        self.assertEqual(result.returncode, status, result.stderr)
        self.assertNotIn("Traceback", result.stderr)
        last = result.stderr.splitlines()[-1]
        self.assertTrue(last.startswith("report: error: "), last)
        for word in words:
            self.assertIn(word, last)
        self.assertEqual(os.listdir(self.folder_out), [])

    def test_says_how_it_is_used(self):
        result = self.report("--help")
        self.assertEqual(result.returncode, 0)
        for option in (
            "--out",
            "--with",
            "--namespace",
            "--excitation",
            "--step",
            "--resolution",
            "--drive",
            "--no-replay",
        ):
            self.assertIn(option, result.stdout)

    def test_a_stepped_sine_gives_responses_and_no_frequency_response_function(self):
        text, data = self.page(self.stepped)
        for key in (
            "overview",
            "impulse_response",
            "period_map",
            "stroboscopic",
            "histogram_impulse",
            "waterfall_gap",
            "waterfall_force",
        ):
            self.assertIn(key, data["charts"])
        self.assertNotIn("frf_gap", data["charts"])
        self.assert_says(text, "Left out: the drive is not random (3 steps of constant frequency, 325.7 to 542.9 Hz).")
        self.assertEqual([len(data["segments"]), len(data["step_data"])], [3, 3])
        self.assertRegex(text, r"levels down to 100 dB below the greatest one, in steps of 0\.3\d* dB\.")
        self.assert_says(text, "to the seven digits of single precision")
        # The step with the greatest impulse comes first: that at the resonance.
        self.assertIn("\u03c9* 1.6000", data["segments"][data["chosen"]]["label"])
        self.assertIn(", up, ", data["segments"][0]["label"])
        self.assert_says(text, "youngs_modulus")

    def test_the_licence_of_plotly_is_in_the_page(self):
        text, _ = self.page(self.quiet, "--no-replay")
        assets = os.path.join(HERE, "..", "..", "python", "vibro_impact", "report", "assets")
        with open(os.path.join(assets, "plotly.LICENSE"), encoding="utf-8") as file:
            licence = file.read()
        self.assertIn("The above copyright notice and this permission notice shall be included in", licence)
        self.assert_says(text, html.escape(licence))

    def test_many_changes_of_the_contact_are_a_table(self):
        bag = os.path.join(self.folder_in(), "run.bag")
        changes = {sample: 1e-6 * sample for sample in range(500, 20000, 500)}
        recorded.write_bag(bag, recorded.configuration(), recorded.random_drive(0.4), contacts=changes)
        text, _ = self.page(bag, "--no-replay")
        self.assertEqual(text.count("youngs_modulus"), 2)  # of each beam, once
        table = text[text.index("<h3>Changes of the contact alone</h3>") :]
        table = table[: table.index("more.</p>")]
        self.assertEqual(table.count("<tr>"), 21)
        self.assertIn("<td class='number'>1500</td><td>24309.426302924</td><td>0.0015</td>", table)
        self.assertTrue(table.endswith("<p>And %d " % (len(changes) - 20)))
        # More than the contact is another.
        recorded.write_bag(
            bag, recorded.configuration(), recorded.random_drive(0.4), contacts={500: 0.0, 1000: 1e-3}, damping=0.02
        )
        text, _ = self.page(bag, "--no-replay")
        self.assertEqual(text.count("youngs_modulus"), 4)
        self.assert_says(text, "<h3>From sample 500 on</h3>")
        self.assertNotIn("<h3>From sample 1000 on</h3>", text)

    def test_the_step_shown_first_can_be_chosen(self):
        self.assertEqual(self.page(self.stepped, "--step", "3")[1]["chosen"], 2)
        self.assertEqual(self.page(self.stepped, "--step", "1.21", "--no-replay")[1]["chosen"], 0)

    def test_a_random_drive_gives_frequency_response_functions_and_the_replay_is_identical(self):
        text, data = self.page(self.linear)
        self.assertIn("frf_gap", data["charts"])
        self.assertNotIn("impulse_response", data["charts"])
        self.assert_says(text, "no steps of constant frequency found")
        self.assert_says(text, "Identical: 200000 samples of gap and contact force and 0 impacts")
        self.assert_says(
            text,
            "Computed with the simulator&#x27;s default limits: max_acceleration 100000 m/s\u00b2, max_bridged_gap"
            " 0.02 s, max_step_back 0.1 s, max_stamp_jitter 0.05 s",
        )
        self.assert_says(text, "Left out: there are no whole impacts in the recording.")
        self.assert_says(text, "the contact is never reached")
        found = re.search(r"at (\d+) lines, H<sub>1</sub> is within", text)
        self.assertGreater(int(found.group(1)), 100)

    def test_the_packages_own_noise_is_random_though_it_holds_what_looks_like_steps(self):
        bag = os.path.join(self.folder_in(), "random.bag")
        with open(os.path.join(recorded.CONFIG, "ship_tube.yaml"), encoding="utf-8") as file:
            configuration = file.read()
        acceleration, period = recorded.shipped_signal("iec_60068_2_64_random", 60.0)
        recorded.write_bag(bag, configuration, acceleration, period=period)
        found = vibro_impact.extract_responses(bag)
        self.assertGreater(len(found.responses), 3)
        self.assertGreater(found.covered, 0.0)
        self.assertLess(found.covered, 0.1)
        self.assertAlmostEqual(
            found.covered,
            (
                sum((end - start) / period for start, end in found.steps)
                + sum(last - first for _, first, last, _ in found.left_out)
            )
            / len(acceleration),
            places=6,
        )
        text, data = self.page(bag, "--no-replay")
        self.assert_says(text, "period map, stroboscopic diagram")
        self.assert_says(text, "Left out: steps cover only %.2g %% of the samples." % (100.0 * found.covered))
        self.assert_says(text, "random: about 5")
        self.assertIn("frf_gap", data["charts"])
        self.assertIn("frf_force", data["charts"])
        # What the user says is what is done.
        text, data = self.page(bag, "--no-replay", "--drive", "steps")
        self.assertEqual(len(data["segments"]), len(found.responses))
        self.assertNotIn("frf_gap", data["charts"])
        self.assert_says(text, "steps of constant frequency")
        text, data = self.page(bag, "--no-replay", "--drive", "other")
        self.assert_says(text, "the drive is not random (other, as --drive says)")
        self.assert_says(text, "Left out: the drive was said to be other (--drive).")
        self.assertNotIn("frf_gap", data["charts"])

    def test_the_kind_of_the_drive_can_be_given(self):
        text, data = self.page(self.stepped, "--drive", "random", "--no-replay")
        self.assertIn("frf_gap", data["charts"])
        self.assertNotIn("impulse_response", data["charts"])
        self.assert_says(text, "random, as --drive says")
        text, data = self.page(self.quiet, "--drive", "random", "--no-replay")
        self.assert_says(text, "Left out: the base does not move.")
        self.assertNotIn("frf_gap", data["charts"])
        os.unlink(self.out)
        self.assert_refused(self.report(self.linear, "--out", self.out, "--drive", "steps"), 1, "--drive", "no steps")
        result = self.report(self.linear, "--out", self.out, "--drive", "sine")
        self.assert_refused(result, 2, "--drive", "sine", "random")

    def test_the_resolution_can_be_given(self):
        text, _ = self.page(self.linear, "--resolution", "50")
        self.assert_says(text, "segments of 1000 samples overlapping by 50 %")
        self.assert_says(text, "resolution 50 Hz")

    def test_a_resolution_that_leaves_few_averages_is_said_to(self):
        text, _ = self.page(self.linear, "--resolution", "1", "--no-replay")
        self.assert_says(text, "Few averages: 7 segments are worth 6.7 independent ones. Of fewer than 8")
        text, _ = self.page(self.linear, "--resolution", "2", "--no-replay")
        self.assertNotIn("Few averages", text)
        text, data = self.page(self.linear, "--resolution", "0.26", "--no-replay")
        self.assertNotIn("frf_gap", data["charts"])
        self.assert_says(text, "Left out: only one stretch as long as a segment of 192308 samples (3.846 s) is without")
        text, data = self.page(self.linear, "--resolution", "0.2", "--no-replay")
        self.assert_says(
            text, "Left out: the recording, 200000 samples, is shorter than a segment of 250000 samples (5 s)."
        )

    def test_a_force_that_is_lost_in_every_segment_is_left_out(self):
        bag = os.path.join(self.folder_in(), "run.bag")
        drive = recorded.random_drive(4.0)
        recorded.write_bag(bag, recorded.configuration(clearance=2e-6), drive, lost_forces=range(0, 400, 2))
        text, data = self.page(bag, "--no-replay")
        self.assertIn("frf_gap", data["charts"])
        self.assertNotIn("frf_force", data["charts"])
        self.assert_says(
            text, "That of the contact force is left out: there is a loss in every stretch as long as a segment of "
        )
        self.assert_says(text, "there is no stretch of 4096 samples in which the contact force is without a loss")

    def test_a_configuration_that_cannot_be_used_is_shown_and_nothing_computed_from_it(self):
        bag = os.path.join(self.folder_in(), "run.bag")
        with open(self.linear, "rb") as file:
            raw = file.read()
        self.assertIn(b"clearance: 0.01", raw)
        with open(bag, "wb") as file:
            file.write(raw.replace(b"clearance: 0.01", b"cl\xe9arance: 0.01"))
        text, data = self.page(bag)
        self.assertIn("frf_gap", data["charts"])
        self.assert_says(text, "No closed form is drawn along: the recorded configuration cannot be used: ")
        self.assert_says(text, "The resolution is that for a damping ratio of 0.01.")
        self.assert_says(text, "cl\ufffdarance: 0.01")
        self.assert_says(text, "Not compared. ")

    def test_a_recording_of_a_few_samples_gives_a_page(self):
        bag = os.path.join(self.folder_in(), "run.bag")
        for samples in (1, 2, 3, 15, 63, 64, 200):
            with self.subTest(samples):
                recorded.write_bag(bag, recorded.configuration(clearance=1e-2), recorded.random_drive(4.0)[:samples])
                for drive in ((), ("--drive", "random"), ("--drive", "random", "--resolution", "1000")):
                    text, data = self.page(bag, *drive)
                    self.assertIn("overview", data["charts"])
                    self.assertEqual("waterfall_gap" in data["charts"], samples >= 64)
                self.assertEqual(any(key == "frf_gap" for key in data["charts"]), samples > 96)
                if samples < 64:
                    self.assert_says(text, "the recording has %d samples, a segment of a spectrum takes 64" % samples)

    def test_a_bag_need_not_have_a_name_in_utf_8(self):
        folder = os.fsencode(self.folder_in())
        bag = os.path.join(folder, b"caf\xe9.bag")
        with open(self.linear, "rb") as file, open(bag, "wb") as copy:
            copy.write(file.read())
        text, _ = self.page(bag)
        self.assert_says(text, "<title>Vibro-impact run: caf\ufffd.bag</title>")
        self.assert_says(text, "Identical: ")
        out = os.path.join(os.fsencode(self.folder_out), b"\xe9.html")
        self.assertEqual(self.report(self.quiet, "--out", out, "--no-replay").returncode, 0)
        self.assertTrue(os.path.exists(out))
        os.unlink(out)
        os.unlink(self.out)
        self.assert_refused(self.report(os.path.join(folder, b"\xe9.bag"), "--out", self.out), 1, "no such file")
        self.assert_refused(self.report(bag, "--out", self.out, "--namespace", b"/\xe9"), 1, "/\ufffd")

    def test_losses_are_listed_and_their_steps_left_out(self):
        text, data = self.page(self.lossy)
        self.assertEqual(len(data["segments"]), 2)
        self.assert_says(text, "<h3>Losses</h3>")
        self.assert_says(text, "<h3>Steps left out</h3>")
        self.assertNotIn("more.</p>", text)

    def test_long_lists_are_cut_and_say_so(self):
        bag = os.path.join(self.folder_in(), "run.bag")
        drive = recorded.stepped_sine(np.linspace(1.2, 3.0, 25), 10)
        blocks = -(-len(drive) // recorded.BLOCK)
        recorded.write_bag(
            bag, recorded.configuration(), drive, lost_blocks=range(6, blocks, 2), restarts=range(1, 24)
        )
        text, _ = self.page(bag, "--no-replay")
        recording = vibro_impact.read_bag(bag)
        left_out = vibro_impact.extract_responses(bag, allow_gaps=True).left_out
        for title, rows in (
            ("Losses", recording.losses),
            ("Steps left out", left_out),
            ("Starts from rest", recording.starts),
        ):
            self.assertGreater(len(rows), 20, title)
            part = text[text.index("<h3>%s</h3>" % title) :]
            part = part[: part.index("more.</p>")]
            self.assertEqual(part.count("<tr>"), 21, title)
            self.assertTrue(part.endswith("</table>\n<p>And %d " % (len(rows) - 20)), title)

    def test_a_run_without_any_motion_gives_a_page(self):
        text, data = self.page(self.quiet)
        self.assert_says(text, "Left out: the gap never moves.")
        self.assertEqual(sorted(data["charts"]), ["overview"])

    def test_another_run_is_drawn_along(self):
        _, data = self.page(self.stepped, "--with", self.stepped, "--no-replay")
        self.assertEqual(
            [trace["name"] for trace in data["charts"]["impulse_response"]["traces"]],
            ["drive upwards, first run", "drive upwards, second run"],
        )

    def test_makes_the_same_page_again(self):
        first, _ = self.page(self.stepped)
        self.assertEqual(first, self.page(self.stepped)[0])

    def test_refuses_what_is_not_there(self):
        self.assert_refused(self.report("/nowhere/x.bag", "--out", self.out), 1, "/nowhere/x.bag")
        self.assert_refused(self.report(__file__, "--out", self.out), 1, os.path.basename(__file__))
        self.assert_refused(self.report(self.stepped, "--out", "/nowhere/page.html"), 1, "--out", "/nowhere/page.html")
        self.assert_refused(self.report(self.stepped, "--out", "/proc/page.html"), 1, "--out", "/proc/page.html")
        self.assert_refused(self.report(self.stepped, "--out", self.folder_out), 1, "--out", "is a folder")
        self.assert_refused(
            self.report(self.stepped, "--out", self.out, "--step", "4", "--no-replay"), 1, "--step", "4", "1 to 3"
        )
        self.assert_refused(
            self.report(self.stepped, "--out", self.out, "--step", "3.9", "--no-replay"), 1, "--step", "3.9", "1.2 to 2"
        )
        self.assert_refused(self.report(self.stepped, "--out", self.out, "--step", "nan.", "--no-replay"), 1, "--step")
        self.assert_refused(
            self.report(self.linear, "--out", self.out, "--step", "1.5", "--no-replay"), 1, "--step", "no steps"
        )
        self.assert_refused(self.report(self.stepped, "--out", self.out, "--resolution", "-1"), 1, "--resolution", "-1")
        self.assert_refused(
            self.report(self.stepped, "--out", self.out, "--resolution", "nan"), 1, "--resolution", "nan"
        )
        self.assert_refused(self.report(self.stepped, "--out", self.out, "--namespace", "/nobody"), 1, "/nobody")

    def test_writes_over_no_bag_and_no_device(self):
        before = os.path.getsize(self.stepped), os.path.getmtime(self.stepped)
        for bags, out in (
            ([self.stepped], self.stepped),
            ([self.linear, "--with", self.linear, self.stepped], self.stepped),
            ([self.stepped], os.path.join(os.path.dirname(self.stepped), ".", os.path.basename(self.stepped))),
        ):
            result = self.report(*bags, "--out", out)
            self.assert_refused(result, 1, "--out", out, "is a bag")
            self.assertNotIn("reading", result.stderr)
        self.assertEqual((os.path.getsize(self.stepped), os.path.getmtime(self.stepped)), before)
        folder = self.folder_in()
        link, pipe = os.path.join(folder, "link.html"), os.path.join(folder, "pipe")
        os.symlink(self.stepped, link)
        os.mkfifo(pipe)
        self.assert_refused(self.report(self.stepped, "--out", link), 1, "--out", link, "is a bag")
        for path in (pipe, "/dev/null"):
            result = self.report(self.stepped, "--out", path)
            self.assert_refused(result, 1, "--out", path, "is a device or a pipe")
            self.assertNotIn("reading", result.stderr)
        self.assertTrue(stat.S_ISFIFO(os.stat(pipe).st_mode))
        # A page that is there is replaced.
        page, _ = self.page(self.quiet, "--no-replay")
        self.assertEqual(self.page(self.quiet, "--no-replay")[0], page)

    def test_refuses_a_step_that_is_none_before_it_reads(self):
        for step in ("first", "0", "-2", "nan", "0.0", "-1.5", "nan.", ".inf", "", "1.2.3"):
            result = self.report(self.stepped, "--out", self.out, "--step=" + step)
            self.assert_refused(result, 1, "--step", "'%s'" % step, "from 1 on", "omega*")
            self.assertNotIn("reading", result.stderr)

    def test_refuses_a_wrong_command_line(self):
        self.assert_refused(self.report("--out", self.out), 2, "BAG")
        self.assert_refused(self.report(self.stepped), 2, "--out")
        self.assert_refused(
            self.report(self.stepped, "--out", self.out, "--resolution", "much"), 2, "--resolution", "much"
        )


if __name__ == "__main__":
    unittest.main(argv=[a for a in sys.argv if a not in recorded.WRITE_SIGNAL])
