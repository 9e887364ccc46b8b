#!/usr/bin/python3
"""limiting_case, run as a user runs it, with few frequencies; its path is the first argument."""

import csv
import os
import subprocess
import sys
import tempfile
import unittest

SCRIPT = os.path.realpath(sys.argv.pop(1))
FILES = ["frf.csv", "frf.png", "frf.svg", "impacts.csv", "model.csv", "rigid_surface"]


class LimitingCaseTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.out = os.path.join(self.folder, "new", "out")

    def run_script(self, *arguments):
        return subprocess.run(
            [SCRIPT, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False
        )

    def rows(self, name):
        with open(os.path.join(self.out, name), newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_computes_and_draws_both(self):
        os.makedirs(os.path.join(self.out, "rigid_surface"))
        for name in ("frf.csv", "note.txt", "rigid_surface/old.csv"):
            with open(os.path.join(self.out, name), "w", encoding="utf-8"):
                pass
        result = self.run_script("--out", self.out, "--points", "8", "--cycles", "60")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(os.listdir(self.out)), sorted(FILES + ["note.txt"]))
        self.assertEqual(sorted(os.listdir(os.path.join(self.out, "rigid_surface"))), ["frf.csv", "impacts.csv", "model.csv"])
        self.assertIn("in-contact over free frequency  4.01", result.stdout)
        self.assertEqual(result.stdout.splitlines()[-1], "Results in " + self.out)
        self.assertNotIn("written to", result.stdout)
        beams, surface = self.rows("frf.csv"), self.rows("rigid_surface/frf.csv")
        self.assertEqual([float(row["omega_star"]) for row in beams], [0.5 * number for number in range(1, 9)])
        # The stiffer beam is a rigid surface almost, as far as the response has a period.
        self.assertEqual([float(row["omega_star"]) for row in beams if row["period"] != "0"], [1.0, 1.5, 2.0])
        for one, other in zip(beams[1:4], surface[1:4]):
            self.assertAlmostEqual(float(one["impulse_star_mean"]) / float(other["impulse_star_mean"]), 1.0, delta=0.05)
            self.assertNotEqual(one["impulse_star_mean"], other["impulse_star_mean"])

    def test_leaves_what_was_there_if_something_is_wrong(self):
        os.makedirs(self.out)
        with open(os.path.join(self.out, "frf.csv"), "w", encoding="utf-8") as file:
            file.write("precious")
        result = self.run_script("--out", self.out, "--points", "0")
        self.assertEqual(result.returncode, 2)
        self.assertIn('--points = "0": must be a whole number', result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertEqual(os.listdir(self.out), ["frf.csv"])
        with open(os.path.join(self.out, "frf.csv"), encoding="utf-8") as file:
            self.assertEqual(file.read(), "precious")

    def test_folder_that_cannot_be_written(self):
        blocked = os.path.join(self.folder, "file")
        with open(blocked, "w", encoding="utf-8"):
            pass
        result = self.run_script("--out", os.path.join(blocked, "out"))
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr, f"limiting_case: error: cannot write to {blocked}/out: Not a directory\n")

    def test_bad_command_line(self):
        for arguments in ((), ("--out",), ("--out", self.out, "--ponits", "3")):
            result = self.run_script(*arguments)
            self.assertEqual(result.returncode, 2)
            self.assertIn("limiting_case: error: ", result.stderr)

    def test_help(self):
        result = self.run_script("--help")
        self.assertEqual(result.returncode, 0)
        for option in ("--out", "--points", "--cycles"):
            self.assertIn(option, result.stdout)


if __name__ == "__main__":
    unittest.main()
