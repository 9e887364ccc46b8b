#!/usr/bin/python3
"""plot_simulation, run as a user runs it on synthetic tables."""

import csv
import math
import os
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree

HERE = os.path.dirname(os.path.realpath(__file__))
SCRIPT = os.path.join(HERE, "..", "..", "scripts", "plot_simulation")

FREQUENCY = 50.0
PER_CYCLE = 40
CYCLES = 30


def write_run(folder, harmonic=True, impacts=True, step=1.0 / (FREQUENCY * PER_CYCLE), jump=0.0):
    """A gap that dips below zero once a cycle; with `jump`, time leaps by so much in the middle."""
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "history.csv"), "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time", "acceleration", "gap", "gap_velocity", "force", "in_contact"])
        for i in range(CYCLES * PER_CYCLE + 1):
            time = i * step + (jump if i > CYCLES * PER_CYCLE // 2 else 0.0)
            phase = 2.0 * math.pi * i / PER_CYCLE
            gap = 1e-6 * (0.8 + math.cos(phase))
            velocity = -1e-6 * 2.0 * math.pi * FREQUENCY * math.sin(phase)
            writer.writerow([repr(time), 1.0, repr(gap), repr(velocity), repr(max(0.0, -1e4 * gap)), int(gap < 0.0)])
    with open(os.path.join(folder, "impacts.csv"), "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["omega_star", "number", "onset_s", "duration_s"])
        for number in range(CYCLES if impacts else 0):
            writer.writerow([1.0, number, repr((number + 0.4) / FREQUENCY), 0.2 / FREQUENCY])
    with open(os.path.join(folder, "run.csv"), "w") as file:
        file.write("key,value\n")
        if harmonic:
            file.write("drive_frequency_hz,%r\nomega_star,1.5\nacceleration,10\nperiod,1\n" % FREQUENCY)
        file.write("history_step_s,%r\n" % step)


class PlotSimulation(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = os.path.join(folder.name, "run")
        self.out = os.path.join(folder.name, "out")

    def plot(self, *arguments):
        return subprocess.run([SCRIPT, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)

    def assert_drawn(self, *arguments):
        result = self.plot(self.folder, "--out", self.out, *arguments)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(sorted(os.listdir(self.out)), ["simulation.png", "simulation.svg"])
        with open(os.path.join(self.out, "simulation.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
        xml.etree.ElementTree.parse(os.path.join(self.out, "simulation.svg"))

    def assert_refused(self, result, *words):
        """One line that says all of `words`, a non-zero status, and no file."""
        self.assertNotEqual(result.returncode, 0)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)
        self.assertFalse(os.path.isdir(self.out) and os.listdir(self.out))

    def edit(self, name, change):
        path = os.path.join(self.folder, name)
        with open(path) as file:
            lines = file.read().splitlines()
        with open(path, "w") as file:
            file.write("\n".join(change(lines)) + "\n")

    def test_draws_a_harmonic_run(self):
        write_run(self.folder)
        self.assert_drawn()

    def test_draws_a_run_under_samples_without_impacts(self):
        write_run(self.folder, harmonic=False, impacts=False)
        self.assert_drawn("--from", "0.1", "--to", "0.2")

    def test_draws_a_stream_that_restarted(self):
        write_run(self.folder, harmonic=False, jump=5.0)
        self.assert_drawn()

    def test_draws_what_never_moves(self):
        write_run(self.folder, impacts=False)
        self.edit("history.csv", lambda lines: lines[:1] + [line.split(",")[0] + ",0,0,0,0,0" for line in lines[1:]])
        self.assert_drawn()

    def test_draws_two_rows(self):
        write_run(self.folder, harmonic=False)
        self.edit("history.csv", lambda lines: lines[:3])
        self.assert_drawn()

    def test_same_tables_give_the_same_bytes(self):
        write_run(self.folder)
        pictures = []
        for _ in range(2):
            self.assert_drawn()
            for name in ("simulation.png", "simulation.svg"):
                with open(os.path.join(self.out, name), "rb") as file:
                    pictures.append(file.read())
        self.assertEqual(pictures[:2], pictures[2:])

    def test_refuses_bad_tables(self):
        write_run(self.folder)
        os.remove(os.path.join(self.folder, "impacts.csv"))
        self.assert_refused(self.plot(self.folder, "--out", self.out), "impacts.csv", "No such file")
        write_run(self.folder)
        self.edit("history.csv", lambda lines: [lines[0].replace("gap_velocity", "other")] + lines[1:])
        self.assert_refused(self.plot(self.folder, "--out", self.out), "history.csv", "gap_velocity")
        write_run(self.folder)
        self.edit("history.csv", lambda lines: lines[:2])
        self.assert_refused(self.plot(self.folder, "--out", self.out), "history.csv", "has 1 rows")
        write_run(self.folder)
        self.edit("history.csv", lambda lines: lines[:5] + ["nan" + lines[5][lines[5].index(",") :]] + lines[6:])
        self.assert_refused(self.plot(self.folder, "--out", self.out), "history.csv, line 6", "time", "'nan'")
        write_run(self.folder)
        self.edit("run.csv", lambda lines: lines[:-1])
        self.assert_refused(self.plot(self.folder, "--out", self.out), "run.csv", "history_step_s is missing")

    def test_refuses_an_empty_window(self):
        write_run(self.folder)
        self.assert_refused(self.plot(self.folder, "--out", self.out, "--from", "7", "--to", "8"), "no row", "7 s and 8 s")

    def test_refuses_a_folder_that_cannot_be_written(self):
        write_run(self.folder)
        self.assert_refused(
            self.plot(self.folder, "--out", os.path.join(self.folder, "run.csv", "out")), "plot_simulation: error: cannot write to"
        )

    def test_help(self):
        result = self.plot("--help")
        self.assertEqual(result.returncode, 0)
        self.assertIn("--from", result.stdout)


if __name__ == "__main__":
    unittest.main()
