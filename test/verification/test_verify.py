#!/usr/bin/python3
"""What verify.py does where a program or a case fails, and when it leaves the document as it is."""

import argparse
import contextlib
import importlib.util
import io
import os
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, HERE)
if importlib.util.find_spec("scipy") is None:
    print("left out: SciPy, which only scripts/verify needs, is not installed")
    sys.exit(0)
import document  # noqa: E402
import verify  # noqa: E402


class Programs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.program = os.path.join(folder.name, "program")

    def played(self, script):
        with open(self.program, "w", encoding="utf-8") as file:
            file.write("#!/bin/sh\n" + script)
        os.chmod(self.program, 0o755)
        return verify.played(self.program)

    def test_a_name_that_comes_several_times_is_a_list(self):
        self.assertEqual(self.played("echo a 1; echo b 2.5; echo a nan")["b"], [2.5])
        self.assertEqual(len(self.played("echo a 1; echo b 2.5; echo a nan")["a"]), 2)

    def test_failures_are_told_with_their_reason(self):
        with self.assertRaisesRegex(verify.RunError, "no number here"):
            self.played("echo no number here")
        with self.assertRaisesRegex(verify.RunError, "status 3: reason"):
            self.played("echo reason >&2; exit 3")
        with self.assertRaisesRegex(verify.RunError, "printed no b"):
            self.played("echo a 1")["b"]  # pylint: disable=expression-not-assigned
        with self.assertRaisesRegex(verify.RunError, "No such file"):
            verify.played(self.program + ".not")


class Document(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "verification.md")
        collect = verify.collect
        self.addCleanup(setattr, verify, "collect", collect)

    def run_with(self, ours, text, check=False):
        cases = [document.published("case", "[1]", "2.0", ours, "N", 1.0e-3)]
        verify.collect = lambda _: (cases, text)
        with contextlib.redirect_stdout(io.StringIO()) as said:
            verify.verify(argparse.Namespace(document=self.path, check=check))
        return said.getvalue()

    def content(self):
        with open(self.path, encoding="utf-8") as file:
            return file.read()

    def test_is_written_where_all_is_well(self):
        self.assertIn("written", self.run_with(2.0, "first\n"))
        self.run_with(2.001, "second\n")
        self.assertEqual(self.content(), "second\n")
        self.assertEqual(os.listdir(os.path.dirname(self.path)), ["verification.md"])

    def test_stays_where_a_case_is_beyond(self):
        self.run_with(2.0, "first\n")
        for ours in (2.1, float("nan")):
            with self.assertRaisesRegex(verify.RunError, "1 of 1 cases beyond"):
                self.run_with(ours, "second\n")
            self.assertEqual(self.content(), "first\n")

    def test_check_compares_and_writes_nothing(self):
        with self.assertRaisesRegex(verify.RunError, "No such file"):
            self.run_with(2.0, "value 1.50\n", check=True)
        self.run_with(2.0, "value 1.50\n")
        self.assertIn("up to date", self.run_with(2.0, "value 1.51\n", check=True))
        with self.assertRaisesRegex(verify.RunError, "committed: value 1.50\n  now:       value 1.60"):
            self.run_with(2.0, "value 1.60\n", check=True)
        self.assertEqual(self.content(), "value 1.50\n")

    def test_a_folder_that_is_not_there(self):
        self.path = os.path.join(os.path.dirname(self.path), "not", "there.md")
        with self.assertRaisesRegex(verify.RunError, "cannot write"):
            self.run_with(2.0, "first\n")


if __name__ == "__main__":
    unittest.main()
