"""What a case of doc/verification.md is, how it is written, and how two versions of the document are compared."""

import math
import re
from collections import namedtuple

# One number against another. `stated` is the number as its source gives it (text), `expected` the value compared with;
# `relative`: whether `allowed` is a share of `expected` or a quantity in the same unit.
Case = namedtuple("Case", "name source stated expected ours unit allowed relative")

# Below this a difference is rounding and says nothing; it would not be the same on the next machine either.
ROUNDING = 1.0e-9


def closed_form(name, source, expected, ours, unit="", allowed=1.0e-8):
    """A case whose number is computed here from the formula named in `source`."""
    return Case(name, source, number(expected, 7), expected, ours, unit, allowed, True)


def published(name, source, stated, ours, unit, allowed, relative=True):
    """A case whose number stands in the source."""
    return Case(name, source, stated, float(stated), ours, unit, allowed, relative)


def number(value, digits=6):
    """With so many significant digits, and not as -0."""
    return f"{value + 0.0:.{digits}g}"


def difference(case):
    size = abs(case.ours - case.expected)
    return size / abs(case.expected) if case.relative else size


def fails(case):
    return not difference(case) <= case.allowed


def bound(value, floor=1.0e-11):
    """The power of ten above a difference that is rounding, or the error of an integrator; not below ten times `floor`."""
    return f"< 1e-{math.floor(-math.log10(max(value, floor))):02d}"


def _unit(case):
    return f" {case.unit}" if case.unit else ""


def _difference_text(case):
    size = difference(case)
    if case.relative:
        return f"{size:.1e}" if size >= ROUNDING else "< 1e-09"
    # Far below what is allowed it is rounding, which is not the same on the next machine.
    return f"{size:.1e}{_unit(case)}" if size >= 0.01 * case.allowed else f"< {0.01 * case.allowed:.0e}{_unit(case)}"


def _allowed_text(case):
    return f"{case.allowed:g}" + ("" if case.relative else _unit(case))


def _ours_text(case):
    """As its source writes its number, in six to twelve digits."""
    if case.expected == 0.0:
        return _difference_text(case)
    mantissa, _, exponent = case.stated.partition("e")
    digits = min(12, max(6, len(mantissa.replace(".", "").lstrip("-0"))))
    text = f"{case.ours:.{digits - 1}e}" if exponent else number(case.ours, digits)
    return text + _unit(case)


def table(header, rows):
    """A table of Markdown."""
    lines = [header, ["---"] * len(header)] + rows
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def case_table(cases):
    header = ["case", "source", "its number", "ours", "difference", "allowed"]
    rows = [
        [case.name, case.source, case.stated + _unit(case), _ours_text(case), _difference_text(case), _allowed_text(case)]
        for case in cases
    ]
    return table(header, rows)


_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\w)")


def _same_number(a, b, bounded):
    """Whether two numbers differ in no more than their last digit; bounds on rounding may differ by a factor of ten."""
    if a == b:
        return True
    if bounded:
        return abs(math.log10(float(a) / float(b))) < 1.5
    if "." not in a and "e" not in a:
        return False
    mantissa, _, exponent = a.partition("e")
    unit = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
    return abs(float(a) - float(b)) <= 1.5 * unit


def first_difference(committed, written):
    """The first pair of lines that differ in more than last digits, or None."""
    ours, theirs = committed.splitlines(), written.splitlines()
    for i in range(max(len(ours), len(theirs))):
        a = ours[i] if i < len(ours) else "(nothing)"
        b = theirs[i] if i < len(theirs) else "(nothing)"
        if _NUMBER.sub("#", a) != _NUMBER.sub("#", b):
            return a, b
        for x, y in zip(_NUMBER.finditer(a), _NUMBER.finditer(b)):
            if not _same_number(x.group(), y.group(), a[: x.start()].endswith("< ")):
                return a, b
    return None
