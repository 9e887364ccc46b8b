#!/usr/bin/python3
"""How a case is judged and written, and what counts as the same document."""

import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import document  # noqa: E402


def published(stated, ours, allowed, relative=True):
    return document.published("case", "[1]", stated, ours, "N", allowed, relative)


class Judgement(unittest.TestCase):
    def test_share_of_the_source_s_number(self):
        self.assertFalse(document.fails(published("200.0", 200.1, 1.0e-3)))
        self.assertTrue(document.fails(published("200.0", 200.3, 1.0e-3)))

    def test_quantity_in_its_unit(self):
        self.assertFalse(document.fails(published("200.0", 200.1, 0.2, relative=False)))
        self.assertTrue(document.fails(published("200.0", 200.3, 0.2, relative=False)))

    def test_what_is_no_number_fails(self):
        self.assertTrue(document.fails(published("200.0", float("nan"), 1.0)))
        self.assertTrue(document.fails(published("200.0", float("inf"), 1.0)))


class Table(unittest.TestCase):
    def row(self, case):
        return document.case_table([case]).splitlines()[-1]

    def test_as_many_digits_as_the_source(self):
        self.assertEqual(self.row(published("9950.0", 9950.3719, 1.0e-3)), "| case | [1] | 9950.0 N | 9950.37 N | 3.7e-05 | 0.001 |")
        self.assertIn("| -1.83739e-06 N |", self.row(published("-1.85334e-06", -1.837392e-06, 0.1)))

    def test_rounding_is_not_written(self):
        self.assertIn("| < 1e-09 |", self.row(published("1.0", 1.0 + 1.0e-15, 1.0e-8)))
        self.assertIn("| < 1e-12 N |", self.row(published("1.0", 1.0 + 1.0e-15, 1.0e-10, relative=False)))
        self.assertEqual(document.bound(3.0e-14), "< 1e-11")
        self.assertEqual(document.bound(3.0e-9), "< 1e-08")


class Comparison(unittest.TestCase):
    def test_last_digits_may_differ(self):
        for a, b in (("1.2345", "1.2346"), ("1.1e-04", "1.2e-04"), ("-0.99", "-1.00"), ("| < 1e-11 |", "| < 1e-10 |")):
            self.assertIsNone(document.first_difference(a, b), (a, b))

    def test_more_may_not(self):
        pairs = (("1.2345", "1.2347"), ("1.1e-04", "1.1e-05"), ("23 impacts", "24 impacts"), ("< 1e-11", "< 1e-09"), ("SDND101", "SDND102"))
        for a, b in pairs + (("a line", "a line\nand one more"), ("1.5 s", "1.5 N")):
            self.assertIsNotNone(document.first_difference(a, b), (a, b))

    def test_the_first_difference_is_told(self):
        self.assertEqual(document.first_difference("same\nx 1.5", "same\nx 1.9"), ("x 1.5", "x 1.9"))


if __name__ == "__main__":
    unittest.main()
