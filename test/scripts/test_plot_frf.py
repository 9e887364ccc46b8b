#!/usr/bin/python3
"""plot_frf and landmarks, run as a user runs them on synthetic tables; what demo refuses before it does anything."""

import os
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

HERE = os.path.dirname(os.path.realpath(__file__))
SCRIPTS = os.path.join(HERE, "..", "..", "scripts")
sys.path[:0] = [HERE, SCRIPTS]
import frequency_response  # noqa: E402
from synthetic_tables import IMPULSE_STAR_PER_IMPULSE, synthetic_response, write_tables  # noqa: E402


class ScriptTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.beams = os.path.join(self.folder, "beams")
        self.rigid = os.path.join(self.folder, "rigid")
        self.out = os.path.join(self.folder, "out")
        write_tables(self.beams, synthetic_response())
        write_tables(self.rigid, synthetic_response(scale=1.1), frequencies_hz=(271.5, 1087.4))

    def run_script(self, name, *arguments):
        return subprocess.run(
            [os.path.join(SCRIPTS, name), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True
        )

    def assert_refused(self, result, *words):
        """One line that says all of `words`, a non-zero status, and no file."""
        self.assertNotEqual(result.returncode, 0)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)
        if os.path.isdir(self.out):
            self.assertEqual(os.listdir(self.out), [])

    def edit(self, folder, name, change):
        path = os.path.join(folder, name)
        with open(path, encoding="utf-8") as file:
            lines = file.read().splitlines()
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(change(lines)) + "\n")


class PlotTest(ScriptTest):
    def test_draws_both_files_and_nothing_else(self):
        result = self.run_script("plot_frf", self.beams, "--compare", self.rigid, "--out", self.out)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(os.listdir(self.out)), ["frf.png", "frf.svg"])
        with open(os.path.join(self.out, "frf.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
        svg = xml.etree.ElementTree.parse(os.path.join(self.out, "frf.svg")).getroot()
        self.assertTrue(svg.tag.endswith("svg"))

    def test_same_tables_give_the_same_bytes(self):
        pictures = []
        for out in ("first", "second"):
            out = os.path.join(self.folder, out)
            self.assertEqual(self.run_script("plot_frf", self.beams, "--out", out).returncode, 0)
            for name in ("frf.png", "frf.svg"):
                with open(os.path.join(out, name), "rb") as file:
                    pictures.append(file.read())
        self.assertEqual(pictures[:2], pictures[2:])

    def test_default_folder_is_that_of_the_tables(self):
        self.assertEqual(self.run_script("plot_frf", self.beams).returncode, 0)
        self.assertEqual(sorted(os.listdir(self.beams)), ["frf.csv", "frf.png", "frf.svg", "impacts.csv"])

    def test_help(self):
        result = self.run_script("plot_frf", "--help")
        self.assertEqual(result.returncode, 0)
        self.assertIn("--compare", result.stdout)

    def test_missing_file(self):
        os.remove(os.path.join(self.beams, "impacts.csv"))
        self.assert_refused(self.run_script("plot_frf", self.beams, "--out", self.out), "impacts.csv", "No such file")

    def test_missing_column_is_named(self):
        self.edit(self.beams, "frf.csv", lambda lines: [lines[0].replace("impulse_star_mean", "other")] + lines[1:])
        self.assert_refused(self.run_script("plot_frf", self.beams, "--out", self.out), "frf.csv", "impulse_star_mean")

    def test_file_without_columns(self):
        self.edit(self.beams, "impacts.csv", lambda lines: [])
        self.assert_refused(self.run_script("plot_frf", self.beams, "--out", self.out), "impacts.csv", "omega_star, impulse")

    def test_empty_tables(self):
        for name in ("impacts.csv", "frf.csv"):
            self.edit(self.beams, name, lambda lines: lines[:1])
            self.assert_refused(self.run_script("plot_frf", self.beams, "--out", self.out), name, "empty")

    def labels(self, *arguments):
        """What stands in the picture of these tables, as the comments of the SVG file say."""
        result = self.run_script("plot_frf", *arguments, "--out", self.out)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(sorted(os.listdir(self.out)), ["frf.png", "frf.svg"])
        with open(os.path.join(self.out, "frf.svg"), encoding="utf-8") as file:
            return re.findall("<!-- (.*?) -->", file.read())

    def test_no_impact_anywhere_is_drawn(self):
        write_tables(self.beams, [(1.0, 1, []), (2.0, 1, [])])
        labels = self.labels(self.beams)
        self.assertIn("no impacts at 2 drive frequencies, base acceleration 10 m/s$^2$", labels)
        self.assertEqual(labels.count("no impacts"), 2)  # in both panels
        self.assertIn("two beams: no impacts", labels)

    def test_compares_with_a_table_without_impacts(self):
        write_tables(self.rigid, [(1.0, 1, []), (2.0, 1, [])])
        labels = self.labels(self.beams, "--compare", self.rigid)
        self.assertIn("two beams: every captured impact", labels)
        self.assertIn("single beam on a rigid surface: no impacts", labels)
        self.assertNotIn("two beams: no impacts", labels)

    def test_no_positive_impulse_anywhere_is_drawn(self):
        write_tables(self.beams, [(1.0, 1, [-0.1]), (2.0, 1, [-0.2])])
        self.assertIn("no positive impulses", self.labels(self.beams))

    def test_tables_that_do_not_belong_together(self):
        write_tables(os.path.join(self.folder, "none"), [(1.0, 1, []), (2.0, 1, [])])
        os.replace(os.path.join(self.folder, "none", "frf.csv"), os.path.join(self.beams, "frf.csv"))
        self.assert_refused(self.run_script("plot_frf", self.beams, "--out", self.out), "impacts.csv: has impacts, other than frf.csv")

    def test_cell_that_is_no_number(self):
        for bad in ("wide", "nan", ""):
            write_tables(self.beams, synthetic_response())
            self.edit(self.beams, "frf.csv", lambda lines: lines[:2] + [bad + lines[2][lines[2].index(",") :]] + lines[3:])
            result = self.run_script("plot_frf", self.beams, "--out", self.out)
            self.assert_refused(result, "frf.csv, line 3", "omega_star", f"'{bad}'")

    def test_short_row(self):
        self.edit(self.beams, "frf.csv", lambda lines: lines + ["4.1,1000"])
        self.assert_refused(self.run_script("plot_frf", self.beams, "--out", self.out), "frf.csv", "acceleration")

    def test_binary_file(self):
        with open(os.path.join(self.beams, "frf.csv"), "wb") as file:
            file.write(b"\xff\xfe\x00\x01" * 100)
        self.assert_refused(self.run_script("plot_frf", self.beams, "--out", self.out), "frf.csv", "not a CSV file")

    def test_folder_that_cannot_be_written(self):
        blocked = os.path.join(self.folder, "file")
        with open(blocked, "w"):
            pass
        self.assert_refused(self.run_script("plot_frf", self.beams, "--out", os.path.join(blocked, "out")), "cannot write to", blocked)

    def test_impulses_that_are_not_positive_are_left_out_of_the_logarithm(self):
        write_tables(self.beams, [(1.0, 1, [0.5, -0.1, 0.0]), (1.6, 1, [1.0])])
        result = self.run_script("plot_frf", self.beams, "--out", self.out)
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_rows_without_impacts_are_marked(self):
        response = [(w, p, impulses if w > 1.4 else []) for w, p, impulses in synthetic_response(step=0.05)]
        write_tables(self.beams, response)
        self.assertIn("two beams: no impacts", self.labels(self.beams))


class LandmarksTest(ScriptTest):
    def lines(self, *arguments):
        result = self.run_script("landmarks", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        table = result.stdout.split("\n\n")[0]
        return {line.split("  ")[0]: line for line in table.splitlines()[2:]}

    def test_all_are_found_and_met(self):
        lines = self.lines(self.beams, "--compare", self.rigid)
        self.assertEqual(len(lines), 4)
        self.assertIn("4.005  ", lines["in-contact over free frequency"])
        self.assertIn(" 1.600 ", lines["resonance"])
        self.assertIn(" 2.400 to 2.410 ", lines["period one to period two"])
        self.assertIn(" 3.200, period 2, 0.30 ", lines["harmonic"])
        for name, line in lines.items():
            self.assertRegex(line, r" met$")
            self.assertNotIn("NOT MET", line)

    def test_rows_without_impacts_have_no_period(self):
        response = [(w, p, impulses if not 2.2 <= w <= 2.4055 else []) for w, p, impulses in synthetic_response()]
        write_tables(self.beams, response)
        lines = self.lines(self.beams)
        self.assertIn(" not measured", lines["period one to period two"])
        self.assertIn(" 1.600 ", lines["resonance"])

    def test_no_impact_anywhere_is_not_measured(self):
        write_tables(self.beams, [(w, 1, []) for w, _, _ in synthetic_response()])
        for line in self.lines(self.beams).values():
            self.assertIn("not measured", line)

    def test_moved_landmarks_are_not_met(self):
        write_tables(self.beams, [(omega_star + 0.03, p, impulses) for omega_star, p, impulses in synthetic_response()])
        lines = self.lines(self.beams)
        for name in ("resonance", "period one to period two", "harmonic"):
            self.assertIn("NOT MET", lines[name])

    def test_harmonic_of_another_period_is_not_met(self):
        write_tables(self.beams, [(omega_star, 1, impulses) for omega_star, _, impulses in synthetic_response()])
        lines = self.lines(self.beams)
        self.assertIn("3.200, period 1", lines["harmonic"])
        self.assertIn("NOT MET", lines["harmonic"])
        self.assertIn("not measured", lines["period one to period two"])

    def test_unsettled_rows_widen_the_doubling(self):
        rows = frequency_response.read_rows(self.beams)
        rows = [row._replace(period=0) if 2.375 < row.omega_star < 2.425 else row for row in rows]
        self.assertEqual(frequency_response.measure_doubling(rows).text, "2.370 to 2.430")

    def test_what_was_not_swept_is_not_measured(self):
        write_tables(self.beams, [row for row in synthetic_response() if row[0] < 1.9])
        lines = self.lines(self.beams)
        self.assertIn(" met", lines["resonance"])
        for name in ("in-contact over free frequency", "period one to period two", "harmonic"):
            self.assertIn("not measured", lines[name])

    def test_impulse_star_of_an_impact_follows_from_the_table(self):
        rows = frequency_response.read_rows(self.beams)
        impact = frequency_response.read_impacts(self.beams, rows)[0]
        self.assertAlmostEqual(impact.impulse_star, synthetic_response()[0][2][0], places=12)
        self.assertNotEqual(IMPULSE_STAR_PER_IMPULSE, 1.0)

    def test_model_without_a_frequency(self):
        self.edit(self.rigid, "model.csv", lambda lines: lines[:2])
        result = self.run_script("landmarks", self.beams, "--compare", self.rigid)
        self.assert_refused(result, "model.csv", "contact_frequency_hz", "missing")

    def test_missing_folder(self):
        self.assert_refused(self.run_script("landmarks", os.path.join(self.folder, "nowhere")), "nowhere", "No such file")

    def test_every_verdict_has_a_head(self):
        result = self.run_script("landmarks", self.beams, "--compare", self.rigid)
        self.assertEqual(result.stdout.splitlines()[0].split()[:2], ["landmark", "paper"])
        self.assertEqual(result.stdout.splitlines()[0].count("met?"), 2)


class DemoTest(ScriptTest):
    def test_folder_that_cannot_be_written(self):
        blocked = os.path.join(self.folder, "file")
        with open(blocked, "w"):
            pass
        result = self.run_script("demo", "--out", os.path.join(blocked, "out"))
        self.assert_refused(result, "cannot create", blocked)
        self.assertEqual(result.stdout, "")

    def test_unknown_option(self):
        self.assert_refused(self.run_script("demo", "--output", self.out), "unknown option '--output'", "--out DIR")


if __name__ == "__main__":
    unittest.main()
