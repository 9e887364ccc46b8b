"""Reads the tables of a repetitive impact frequency response and finds the landmarks of the paper's figure in them.

A folder holds frf.csv (one row per drive frequency), impacts.csv (one row per captured impact) and, where frf_sweep wrote it,
model.csv (rows key,value with the lowest natural frequency of each state).
"""

import csv
import math
import os
from collections import namedtuple


class TableError(Exception):
    """A table that cannot be used; the message names file, column and value."""


# One drive frequency: acceleration amplitude in m/s^2; impulse in N s and dimensionless, both per impact and mean; period in
# drive cycles, 0: none found.
Row = namedtuple("Row", "omega_star acceleration period impacts impulse impulse_star")

# One captured impact: its drive frequency and its dimensionless impulse.
Impact = namedtuple("Impact", "omega_star impulse_star")

# What was measured of one landmark: the text to show, omega* to mark (None: not found), and whether it meets `allowed`.
Measured = namedtuple("Measured", "text omega_star met")

# name, the paper's value as text, omega* to mark (None: not on the frequency axis), when it counts as met
Landmark = namedtuple("Landmark", "name paper omega_star allowed")

RATIO = Landmark("in-contact over free frequency", "4.01", None, "4.00 to 4.02")
RESONANCE = Landmark("resonance", "1.60", 1.60, "1.590 to 1.605")
HARMONIC = Landmark("harmonic", "3.20, lower", 3.20, "3.185 to 3.205, period 2, 0.29 to 0.33 of the resonance")
DOUBLING = Landmark("period one to period two", "2.40", 2.40, "within 2.39 to 2.41")


def read_csv(path, columns):
    """Yields (line, {column: float}) for each row; extra columns are not looked at."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file)
            missing = [column for column in columns if column not in (reader.fieldnames or [])]
            if missing:
                raise TableError(f"{path}: no column {', '.join(missing)}")
            for cells in reader:
                values = {}
                for column in columns:
                    try:
                        values[column] = float(cells[column])
                    except (TypeError, ValueError):
                        values[column] = math.nan
                    if not math.isfinite(values[column]):
                        raise TableError(
                            f"{path}, line {reader.line_num}: {column} is '{cells[column] or ''}', not a finite number"
                        )
                yield values
    except OSError as error:
        raise TableError(f"{path}: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise TableError(f"{path}: not a CSV file ({error})") from error


def read_values(path, required):
    """The finite numbers of a table of rows key,value; those of `required` must be among them."""
    values = {}
    try:
        with open(path, newline="", encoding="utf-8") as file:
            for cells in csv.reader(file):
                if len(cells) == 2 and cells[0] != "key":
                    values[cells[0]] = float(cells[1])
    except OSError as error:
        raise TableError(f"{path}: {error.strerror}") from error
    except (ValueError, csv.Error) as error:
        raise TableError(f"{path}: {error}") from error
    for key in required:
        if not math.isfinite(values.get(key, math.nan)):
            raise TableError(f"{path}: {key} is {values.get(key, 'missing')}, not a finite number")
    return values


def read_rows(folder):
    """The rows of frf.csv by ascending frequency."""
    path = os.path.join(folder, "frf.csv")
    columns = ("omega_star", "acceleration", "period", "impacts", "impulse_mean", "impulse_star_mean")
    rows = [Row(*(values[column] for column in columns)) for values in read_csv(path, columns)]
    if not rows:
        raise TableError(f"{path}: the table is empty")
    return sorted(rows)


def read_impacts(folder, rows):
    """The impacts of impacts.csv, none where no row has one; their dimensionless impulse follows from the ratio of both
    impulses in `rows`."""
    path = os.path.join(folder, "impacts.csv")
    found = list(read_csv(path, ("omega_star", "impulse")))
    if bool(found) != any(row.impacts > 0 for row in rows):
        raise TableError(f"{path}: {'has impacts' if found else 'the table is empty'}, other than frf.csv beside it")
    greatest = max(rows, key=lambda row: abs(row.impulse))
    scale = greatest.impulse_star / greatest.impulse if greatest.impulse != 0.0 else 0.0
    return [Impact(values["omega_star"], scale * values["impulse"]) for values in found]


def read_frequency_ratio(folder):
    """The lowest in-contact over the lowest free frequency; None without a model.csv."""
    path = os.path.join(folder, "model.csv")
    if not os.path.exists(path):
        return None
    wanted = ("free_frequency_hz", "contact_frequency_hz")
    values = read_values(path, wanted)
    for key in wanted:
        if values[key] <= 0.0:
            raise TableError(f"{path}: {key} is {values[key]}, not a positive number")
    return values["contact_frequency_hz"] / values["free_frequency_hz"]


def _peak(rows, low, high):
    """The row of the greatest mean impulse within low..high; None without an impact there."""
    inside = [row for row in rows if low <= row.omega_star <= high and row.impacts > 0]
    return max(inside, key=lambda row: row.impulse_star, default=None)


def _within(value, low, high):
    """Whether value lies in low..high, to the four digits that a table shows at most."""
    return low <= round(value, 4) <= high


NOT_MEASURED = Measured("not measured", None, False)


def measure_ratio(ratio):
    """`ratio`: as read_frequency_ratio gives it."""
    if ratio is None:
        return NOT_MEASURED
    return Measured(f"{ratio:.3f}", None, _within(ratio, 4.00, 4.02))


def measure_resonance(rows):
    """The greatest mean impulse with omega* in 1 to 2."""
    peak = _peak(rows, 1.0, 2.0)
    if peak is None:
        return NOT_MEASURED
    return Measured(f"{peak.omega_star:.3f}", peak.omega_star, _within(peak.omega_star, 1.590, 1.605))


def measure_harmonic(rows):
    """The greatest mean impulse with omega* in 2.8 to 3.6, its period, and its height over that of the resonance."""
    resonance = _peak(rows, 1.0, 2.0)
    peak = _peak(rows, 2.8, 3.6)
    if peak is None or resonance is None or resonance.impulse_star == 0.0:
        return NOT_MEASURED
    height = peak.impulse_star / resonance.impulse_star
    met = _within(peak.omega_star, 3.185, 3.205) and peak.period == 2 and _within(height, 0.29, 0.33)
    return Measured(f"{peak.omega_star:.3f}, period {peak.period:.0f}, {height:.2f}", peak.omega_star, met)


def measure_doubling(rows):
    """Where, with omega* in 2.2 to 2.6, the first row of period two follows one of period one; without impacts there is none."""
    last_single = None
    for row in rows:
        if not 2.2 <= row.omega_star <= 2.6 or row.impacts == 0:
            continue
        if row.period == 1:
            last_single = row.omega_star
        elif row.period == 2 and last_single is not None:
            met = _within(last_single, 2.39, 2.41) and _within(row.omega_star, 2.39, 2.41)
            return Measured(f"{last_single:.3f} to {row.omega_star:.3f}", 0.5 * (last_single + row.omega_star), met)
    return NOT_MEASURED


def measure_figure(rows):
    """The landmarks on the frequency axis, each with what was measured of it, by ascending omega*."""
    return [
        (RESONANCE, measure_resonance(rows)),
        (DOUBLING, measure_doubling(rows)),
        (HARMONIC, measure_harmonic(rows)),
    ]
