#!/usr/bin/python3
"""Plays the cases of doc/verification.md, compares each with its source, and writes or checks the document."""

import argparse
import concurrent.futures
import math
import os
import subprocess
import sys
import tempfile

import numpy
import scipy.optimize

HERE = os.path.dirname(os.path.realpath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path[:0] = [HERE, os.path.join(ROOT, "scripts")]
import frequency_response as response  # noqa: E402
import independent_motion as independent  # noqa: E402
import other_schemes  # noqa: E402
from document import Case, bound, case_table, closed_form, difference, fails, first_difference, number, published, table  # noqa: E402


class RunError(Exception):
    """A program that did not do what it was started for."""


def say(text):
    print(text, flush=True)


def output_of(command):
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
    except OSError as error:
        raise RunError(f"{command[0]}: {error.strerror}") from error
    if done.returncode != 0:
        raise RunError(f"{' '.join(command)} ended with status {done.returncode}: {done.stderr.strip()}")
    return done.stdout


class Played(dict):
    """What verification_runs printed: {name: [values]}."""

    def __missing__(self, name):
        raise RunError(f"verification_runs printed no {name}")


def played(program):
    values = Played()
    for line in output_of([program]).splitlines():
        try:
            name, value = line.split()
            values.setdefault(name, []).append(float(value))
        except ValueError as error:
            raise RunError(f"{program} printed '{line}', not a name and a number") from error
    return values


def replace(path, text):
    """Writes the file anew, or leaves it as it is."""
    written = path + ".new"
    try:
        with open(written, "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(written, path)
    except OSError as error:
        if os.path.exists(written):
            os.remove(written)
        raise RunError(f"cannot write {path}: {error.strerror}") from error


# Closed forms -------------------------------------------------------------------------------------------------------


def symmetric_frequency(stiffness):
    """The first symmetric frequency of a pinned beam with a spring k* at midspan, over its lowest one without."""

    def equation(l):
        # Times cos(l/2), so that the pole is none.
        return 4.0 * l**3 * math.cos(l / 2) + stiffness * (math.sin(l / 2) - math.tanh(l / 2) * math.cos(l / 2))

    return (scipy.optimize.brentq(equation, math.pi, 2.5 * math.pi, xtol=1e-15) / math.pi) ** 2


def bilinear(runs):
    free = runs["bilinear.free_frequency"][0]
    contact = math.sqrt(free**2 + runs["bilinear.stiffness"][0])
    return [
        closed_form(
            "one undamped mode at zero clearance: period of free vibration",
            "pi/w0 + pi/w1, w1^2 = w0^2 + k/m",
            math.pi / free + math.pi / contact,
            runs["bilinear.period"][0],
            "s",
        )
    ]


def nearest(values, expected):
    return min(values, key=lambda value: abs(value - expected))


def contact_frequencies(runs):
    exact, reduced = [], []
    equation = "1 + k* (tan(l/2) - tanh(l/2))/(4 l^3) = 0"
    unchanged = {2: 4.0, 4: 16.0}
    for stiffness, text in STIFFNESSES:
        found = runs[f"rigid_surface.{stiffness}.conjoined"]
        expected = symmetric_frequency(stiffness)
        name = f"pinned beam on a spring at midspan, k* = {text}: first symmetric frequency"
        exact.append(closed_form(name, equation, expected, nearest(found, expected)))
        name = f"the same in the attachment basis, {ATTACHMENT_MODES} modes: k* = {text}"
        ours = nearest(runs[f"rigid_surface.{stiffness}.attachment"], expected)
        reduced.append(closed_form(name, equation, expected, ours, allowed=1.0e-5))
        for mode in unchanged:
            unchanged[mode] = max(unchanged[mode], nearest(found, mode**2), key=lambda value, m=mode: abs(value - m**2))
    infinite = scipy.optimize.brentq(lambda x: math.sin(x) - math.tanh(x) * math.cos(x), 3.0, 4.5, xtol=1e-15)
    infinite = (2.0 * infinite / math.pi) ** 2
    ours = nearest(runs[f"rigid_surface.{STIFFNESSES[-1][0]}.conjoined"], infinite)
    exact.append(closed_form(f"k* infinite, against k* = {STIFFNESSES[-1][1]}", "tan(l/2) = tanh(l/2)", infinite, ours, allowed=1.0e-6))
    for mode, ours in unchanged.items():
        name = f"antisymmetric mode {mode}: the frequency that any of these k* changes most"
        exact.append(closed_form(name, "unchanged: m^2", float(mode**2), ours))

    found = runs["identical_beams.conjoined"]
    expected = symmetric_frequency(2000)
    twice = "each beam feels twice the spring: the equation above with 2 k*"
    exact.append(closed_form("two identical beams, k* = 1000: relative mode", twice, expected, nearest(found, expected)))
    for mode in (1, 3):
        exact.append(closed_form(f"common mode {mode} of the two", "stays: m^2", float(mode**2), nearest(found, mode**2)))
    return exact + reduced


STIFFNESSES = ((10, "10"), (100, "100"), (1000, "1000"), (10000, "1e4"), (1000000000, "1e9"))
ATTACHMENT_MODES = 5


def thrown_mass(runs):
    mass, spring, stop, speed = 100.0, 1.0e4, 1.0e6, 1.0
    omega = math.sqrt((spring + stop) / mass)
    name = "100 kg on 1e4 N/m, thrown at 1 m/s at a stop of 1e6 N/m: "
    return [
        closed_form(name + "contact time", "pi/w1", math.pi / omega, runs["sdnd101.duration"][0], "s"),
        closed_form(name + "peak force", "k v/w1", stop * speed / omega, runs["sdnd101.peak_force"][0], "N"),
        closed_form(name + "impulse", "2 k v/w1^2", 2.0 * stop * speed / omega**2, runs["sdnd101.impulse"][0], "N s"),
    ]


def proportionality(runs):
    return [
        closed_form(
            f"limiting case, acceleration doubled: {text}",
            f"factor {factor}",
            float(factor),
            runs[f"proportionality.{name}"][1] / runs[f"proportionality.{name}"][0],
        )
        for name, text, factor in (("impulse", "impulse", 2), ("peak_force", "peak force", 2), ("duration", "contact time", 1))
    ]


def vanishing(name, source, ours, allowed):
    """A case whose number is zero."""
    return Case(name, source, "0", 0.0, ours, "", allowed, False)


def energy(runs):
    drift = runs["energy.greatest_change"][0]
    cases = [vanishing("two beams, undamped, no drive, 2000 switches: greatest change of the energy, as a share", "constant", drift, 1.0e-10)]
    account = "stored + dissipated + lost by the mapping - work of the base"
    for basis, closure in zip(("attachment basis", "conjoined basis of 2 and 2 modes"), runs["energy.closure"]):
        name = f"limiting case, {basis}, 400 cycles at omega* = 1.6: residual of the account, as a share of what went through"
        cases.append(vanishing(name, account, closure, 1.0e-9))
    return cases


BEAM1 = independent.Beam(1.66e9, 0.02645)
BEAM2 = independent.Beam(1.66e12, 0.02645)
LOWEST = BEAM1.modes(numpy.array([1.0]))[0][0]
STIFFNESS_UNIT = BEAM1.bending_stiffness / BEAM1.length**3


def interference_fit(runs):
    clearance = 1.0e-5
    flexibility = 1.0 / (1000.0 * STIFFNESS_UNIT)
    for beam in (BEAM1, BEAM2):
        flexibility += beam.length**3 / (48.0 * beam.bending_stiffness)
    return [
        closed_form(
            "two beams pressed together by 10 um: force at rest",
            "-c/(1/k + L^3/(48 E1 I1) + L^3/(48 E2 I2))",
            clearance / flexibility,
            runs["interference_fit.force"][0],
            "N",
        )
    ]


# Beams --------------------------------------------------------------------------------------------------------------

CLAMPED_CLAMPED = ("4.73004074", "7.85320462", "10.99560784", "14.13716549")
CLAMPED_PINNED = ("3.92660231", "7.06858275", "10.21017612", "13.35176878")
CLAMPED_FREE = ("1.87510407", "4.69409113", "7.85475744", "10.99554073")

# Ends, eigenvalues above zero and their source, rigid-body modes; and, for supported beams, the static deflection at midspan.
BEAMS = (
    ("clamped", "clamped", CLAMPED_CLAMPED, "[2]", 0, 1.0 / 192.0, "L^3/(192 E I)"),
    ("clamped", "pinned", CLAMPED_PINNED, "[2]", 0, 7.0 / 768.0, "7 L^3/(768 E I)"),
    ("clamped", "free", CLAMPED_FREE, "[2]", 0, 1.0 / 24.0, "L^3/(24 E I)"),
    ("free", "free", CLAMPED_CLAMPED, "[2], [3]", 2, None, None),
    ("pinned", "free", CLAMPED_PINNED, "[2], [3]", 1, None, None),
)


def beams_of_any_ends(runs):
    cases = []
    for m, ours in enumerate(runs["beam.pinned_pinned.eigenvalue"], 1):
        cases.append(closed_form(f"pinned-pinned, mode {m}", "m pi", m * math.pi, ours))
    cases.append(closed_form("pinned-pinned, deflection at midspan", "L^3/(48 E I)", 1.0 / 48.0, runs["beam.pinned_pinned.static_receptance"][0]))
    for first, last, stated, source, rigid, deflection, formula in BEAMS:
        name = f"{first}-{last}"
        found, turned = (runs[f"beam.{key}.eigenvalue"] for key in (f"{first}_{last}", f"{last}_{first}"))
        if rigid:
            cases.append(closed_form(f"{name}, modes of frequency zero", "[3]", float(rigid), float(sum(value == 0.0 for value in found))))
        for m, (text, ours) in enumerate(zip(stated, found[rigid:]), 1):
            elastic = ", elastic" if rigid else ""
            cases.append(published(f"{name}{elastic} mode {m}", source, text, ours, "", 3.0e-9))
        if deflection:
            cases.append(closed_form(f"{name}, deflection at midspan", formula, deflection, runs[f"beam.{first}_{last}.static_receptance"][0]))
        if first != last:
            worst = max(abs(a - b) for a, b in zip(found, turned))
            cases.append(vanishing(f"{last}-{first}, greatest difference from {name}", "the same beam", worst, 1.0e-9))
    return cases


def least_root(function, upper):
    return scipy.optimize.brentq(function, 1.0e-3, upper * (1.0 - 1.0e-12), xtol=1.0e-15)


def frequency_with_mass(mass):
    """The lowest frequency of a pinned beam with a point mass, in masses of the beam, at its middle; over that without."""
    return (least_root(lambda l: mass * l * (math.tan(l / 2) - math.tanh(l / 2)) / 4.0 - 1.0, math.pi) / math.pi) ** 2


def frequency_with_rotary_inertia(inertia):
    """The lowest antisymmetric frequency of a pinned beam with a rotary inertia J = inertia m L^3 at its middle."""
    equation = lambda l: inertia * l**3 * (1.0 / math.tanh(l / 2) - 1.0 / math.tan(l / 2)) / 4.0 - 1.0  # noqa: E731
    return (least_root(equation, 2.0 * math.pi) / math.pi) ** 2


def beams_with_body(runs):
    cases = []
    for mass, ours in zip((0.1, 1.0, 10.0, 1000.0), runs["body.mass"]):
        formula = "mu l (tan(l/2) - tanh(l/2))/4 = 1"
        cases.append(closed_form(f"point mass of mu = {mass:g} beams: lowest frequency", formula, frequency_with_mass(mass), ours))
    for inertia, ours in zip((0.001, 0.01, 0.1), runs["body.rotary_inertia"]):
        formula = "j l^3 (coth(l/2) - cot(l/2))/4 = 1"
        name = f"rotary inertia J = j m L^3, j = {inertia:g}: lowest antisymmetric frequency"
        cases.append(closed_form(name, formula, frequency_with_rotary_inertia(inertia), ours))
    rest = 0.7
    expected = frequency_with_mass(0.5 / rest) / rest**2
    name = "body of 0.3 L and half the mass m L: lowest frequency"
    cases.append(closed_form(name, "a beam of 0.7 L with the same mass", expected, runs["body.length"][0]))
    for size, ours in zip((1.0e-2, 1.0e-4, 1.0e-6), runs["body.limit"]):
        name = f"body of {size:g} L, {size:g} m L, {size:g}^3 m L^3: greatest change of the frequencies 1 to 5"
        cases.append(vanishing(name, "none in the limit", ours, 10.0 * size))
    return cases


# The paper ----------------------------------------------------------------------------------------------------------


def landmarks(frf_sweep):
    """The landmarks of the paper's figure, and what to say about the heights of the harmonics."""
    cases, heights = [], []
    with tempfile.TemporaryDirectory() as folder:
        for configuration, model in (("limiting_case", "two beams"), ("rigid_surface", "rigid surface")):
            out = os.path.join(folder, configuration)
            output_of(
                [frf_sweep, os.path.join(ROOT, "config", configuration + ".yaml"), "--from", "0.5", "--to", "4", "--points", "701"]
                + ["--out", out]
            )
            rows = response.read_rows(out)
            if model == "rigid surface":
                ratio = response.read_frequency_ratio(out)
                cases.insert(0, published("first in-contact over first free frequency, rigid surface", "[1]", "4.01", ratio, "", 0.01, False))
            for landmark, measured in response.measure_figure(rows):
                if measured.omega_star is None:
                    raise RunError(f"{configuration}: no {landmark.name} found")
                stated = landmark.paper.split(",")[0]
                cases.append(
                    published(f"{model}: {landmark.name}, omega*", "[1]", stated, measured.omega_star, "", 0.015, False)
                )
            harmonic = response.measure_harmonic(rows).text.split(", ")
            heights.append(f"{model} {harmonic[2]}, {harmonic[1]}")
    return cases, "; ".join(heights)


# Another code's published cases --------------------------------------------------------------------------------------

# Contact entered and left, s; Code_Aster, astest/sdnd121a.py, "quasi-analytical, to 1e-9 s"; the first 140 of the list, up to 4 s.
SDND121 = """
0.024867876 0.025260518 0.046328519 0.046722721 0.06625224 0.066645834 0.208191408 0.208581391 0.236839728 0.237232929
0.259783891 0.260177191 0.286713479 0.287104524 0.42742281 0.427815655 0.449609878 0.450003717 0.471718478 0.472111368
0.612466923 0.61285792 0.639551999 0.639945276 0.662568795 0.66296199 0.691075776 0.691465914 0.832814226 0.833207726
0.853067188 0.853461321 0.874755701 0.875148327 1.015647709 1.016038835 1.041155067 1.041548697 1.062676943 1.063070409
1.09156836 1.091956632 1.23546445 1.235858899 1.252221811 1.252616914 1.26994799 1.270341714 1.412419976 1.412809632
1.438986599 1.439380349 1.459519936 1.459913733 1.485137244 1.485527706 1.626799772 1.627192863 1.646257587 1.646652297
1.664182604 1.664576755 1.807394868 1.807783798 1.836503816 1.836897131 1.858743289 1.859136761 1.884829878 1.885221033
2.025555678 2.025948359 2.0476656 2.04805956 2.068868162 2.069261372 2.21006466 2.210455239 2.237990559 2.238383766
2.261112837 2.26150606 2.288766881 2.289157621 2.429775294 2.430168388 2.451333067 2.451726972 2.473532756 2.473925482
2.614226334 2.614617471 2.640590944 2.640984352 2.663107283 2.663500548 2.692128628 2.69251794 2.834892801 2.835286766
2.853479566 2.853874093 2.873690674 2.87408356 3.015083964 3.015474688 3.040498674 3.040892451 3.061206232 3.061599922
3.088431644 3.088820824 3.231382471 3.231776516 3.248447186 3.248842412 3.264988921 3.265383369 3.408817607 3.409205942
3.437311166 3.437704707 3.45852387 3.458917562 3.483880219 3.484271276 3.62488935 3.625282002 3.646240514 3.646634749
3.66601164 3.666405279 3.808045328 3.808435236 3.836757816 3.837151021 3.85966648 3.86005979 3.886525493 3.886916559
"""


def sdnd101(runs):
    rows = (
        ("time of the first peak force", "0.01563", "peak_time", 0, "s"),
        ("first peak force", "9950.0", "peak_force", 0, "N"),
        ("time of the second peak force", "0.361", "peak_time", 1, "s"),
        ("second peak force", "9950.0", "peak_force", 1, "N"),
        ("second contact time", "0.03126", "duration", 1, "s"),
        ("second impulse", "198.05", "impulse", 1, "N s"),
        ("second approach speed", "1.0", "approach_speed", 1, "m/s"),
    )
    return [published(text, "[4]", stated, runs["sdnd101." + key][i], unit, 1.0e-3) for text, stated, key, i, unit in rows]


def greatest_difference(name, source, values, expected, unit, allowed):
    """A case that stands for a list: the one of its numbers that is farthest off."""
    same_length = len(values) == len(expected)
    greatest = max(abs(a - b) for a, b in zip(values, expected)) if same_length else math.inf
    return Case(f"{name}: greatest difference", source, "0", 0.0, greatest, unit, allowed, False)


def sdnd102(runs):
    stated = ("-3.58082e-04", "-1.22321e-04", "-1.8876e-04", "-1.89772e-04", "-6.84454e-05", "-1.11982e-04", "-1.20103e-04")
    stated += ("-1.07178e-04",)
    times = (0.05, 0.156, 0.25, 0.4, 0.5, 0.8, 0.9, 1.0)
    ours = runs["sdnd102.displacement"]
    cases = [
        published(f"displacement at {time:g} s", "[5]", text, value, "m", 3.0e-6, False)
        for time, text, value in zip(times, stated, ours)
    ]
    same = other_schemes.two_masses_by_central_differences(4000, times)
    fine = other_schemes.two_masses_by_central_differences(800000, times)
    name = "the manual's scheme and step played here, against the manual's eight numbers"
    cases.append(greatest_difference(name, "[5]", same, [float(text) for text in stated], "m", 1.0e-8))
    name = "that scheme in steps of 1.25 us, against the library"
    cases.append(greatest_difference(name, "`other_schemes.py`", ours, list(fine), "m", 1.0e-8))
    return cases


def sdnd108(runs):
    rows = (
        ("touches the ground", "0.54031242374329", runs["sdnd108.onset"][0], "s"),
        ("leaves it", "0.88545615307643", runs["sdnd108.release"][0], "s"),
        ("displacement at 1 s", "-1.332162981855", runs["sdnd108.displacement"][0], "m"),
        ("displacement at 1.1 s", "-0.856394405035", runs["sdnd108.displacement"][1], "m"),
    )
    return [published(name, "[6]", stated, ours, unit, 1.0e-9) for name, stated, ours, unit in rows]


def sdnd121(runs):
    stated = SDND121.split()
    ours = runs["sdnd121.switch_time"]
    return [
        published("first contact", "[7]", stated[0], ours[0], "s", 1.0e-9, False),
        published("last release", "[7]", stated[-1], ours[-1], "s", 1.0e-9, False),
        greatest_difference(f"all {len(stated)} contacts and releases", "[7]", ours, [float(text) for text in stated], "s", 1.0e-9),
    ]


def sdnd122(runs):
    # Free vibration of energy E: a part of an ellipse in either state.
    spring, stop, clearance, energy_ = 10.0, 50.0, 0.01, 0.00650108331626
    speed = math.sqrt(2.0 * energy_ - spring * clearance**2)
    omega0, omega1 = math.sqrt(spring), math.sqrt(spring + stop)
    free = 2.0 * (math.pi - math.atan2(speed, omega0 * clearance)) / omega0
    contact = 2.0 * math.atan2(omega1 * speed, omega0**2 * clearance) / omega1
    ours = runs["sdnd122.frequency"][0]
    return [
        published("frequency", "[8]", "0.646694", ours, "Hz", 1.0e-3),
        closed_form("frequency", "1/(t0 + t1)", 1.0 / (free + contact), ours, "Hz"),
    ]


def sdnl104(runs):
    displacement, velocity = "-1.85334e-06", "-4.63284e-03"
    same = other_schemes.cantilever_by_finite_elements(10, 1.0e-4, 0.1315, 0.1566)
    replay = "the manual's mesh, scheme and step played here: "
    return [
        published("displacement of the tip at 0.1315 s", "[9]", displacement, runs["sdnl104.displacement"][0], "m", 1.0e-6, False),
        published("speed of the tip at 0.1566 s", "[9]", velocity, runs["sdnl104.velocity"][0], "m/s", 0.09),
        published(replay + "displacement", "[9]", displacement, same[0], "m", 1.0e-5),
        published(replay + "speed", "[9]", velocity, same[1], "m/s", 1.0e-5),
    ]


# Independent integrators ---------------------------------------------------------------------------------------------

INTEGRATORS_ALLOWED = 1.0e-7

# name, text, locations of the contact, modes, attachment shapes, k*, omega*, cycles
TWO_BEAMS = (
    ("soft", "k* = 1000, contact at midspan, 2 modes and an attachment shape each", (0.02645, 0.02645), 2, True, 1000.0, 1.6, 6),
    ("off_centre", "k* = 1000, contact at 20 mm and 30 mm, the same basis", (0.02, 0.03), 2, True, 1000.0, 1.6, 6),
    ("stiff", "k* = 73223, contact at midspan, 3 modes each", (0.02645, 0.02645), 3, False, 73223.0, 0.8, 5),
)


def integrate(name):
    """The onsets and impulses of these beams by LSODA and by the matrix exponential."""
    _, _, locations, modes, attachment, stiffness, omega_star, cycles = next(beams for beams in TWO_BEAMS if beams[0] == name)
    system = independent.System(
        [independent.Beam(youngs, location) for youngs, location in zip((1.66e9, 1.66e12), locations)],
        modes,
        attachment,
        stiffness * STIFFNESS_UNIT,
        0.3 / LOWEST**2,
        (0.01, 0.05),
        omega_star * LOWEST,
    )
    return independent.by_lsoda(system, cycles), independent.by_matrix_exponential(system, cycles)


def integrators(runs):
    """Cases, one for each integrator and quantity, and the rows of the table."""
    cases, rows = [], []
    with concurrent.futures.ProcessPoolExecutor() as pool:
        integrated = pool.map(integrate, [beams[0] for beams in TWO_BEAMS])
        for (name, text, _, _, _, _, omega_star, cycles), (lsoda, exponential) in zip(TWO_BEAMS, integrated):
            ours = [numpy.array(runs[f"two_beams.{name}.library.{quantity}"]) for quantity in ("onset", "impulse")]
            fehlberg = [runs[f"two_beams.{name}.fehlberg.{quantity}"] for quantity in ("onset", "impulse")]
            others = (("Fehlberg 7(8) [10]", fehlberg), ("LSODA [11]", lsoda), ("matrix exponential [12]", exponential))
            for integrator, theirs in others:
                if len(theirs[0]) != len(ours[0]):
                    raise RunError(f"two beams, {text}: {integrator} has {len(theirs[0])} impacts, the library {len(ours[0])}")
                onset, impulse = (float(numpy.max(numpy.abs(a - b))) for a, b in zip(ours, theirs))
                impulse /= float(numpy.max(ours[1]))
                case = f"two beams, {text}: {integrator}"
                cases.append(Case(case + ", impact times", "", "0", 0.0, onset, "", INTEGRATORS_ALLOWED, False))
                cases.append(Case(case + ", impulses", "", "0", 0.0, impulse, "", INTEGRATORS_ALLOWED, False))
                rows.append([text, f"{omega_star:g}", str(cycles), str(len(ours[0])), integrator, bound(onset), bound(impulse)])
            say(f"      two beams, {text}: {len(ours[0])} impacts")
    return cases, rows


# The document --------------------------------------------------------------------------------------------------------

ASTER = "Code_Aster"
ASTER_WEB = "https://docaster-en-codeaster-doc-4113bb35b8213385c636b94f1536856d7f617.gitlab.io/manuals/man_v/v5"
ASTER_FILES = "the repository at version 15.2.17 (commit 34161d7 of 9 November 2020)"

# Heading, what it is about, and the cases.
ASTER_CASES = (
    (
        "SDND101: a mass thrown at a stop",
        """100 kg on 1e4 N/m touch a stop of 1e6 N/m and are thrown at it with 1 m/s. The manual's numbers are closed forms, rounded;
those of the first contact stand above to more digits.""",
        sdnd101,
    ),
    (
        "SDND102: two masses whose anchors move against each other",
        """25 kg on 98 696 N/m each, 1 mm apart, 2.88e7 N/m between them, damping 7 %, anchors at 10 Hz (the resonance) with 1 m/s^2
against each other. The manual's numbers are those of its own integration, central differences in steps of 0.25 ms, a
sixteenth of the contact's period. The same scheme and step give the manual's numbers, shorter steps the library's.""",
        sdnd102,
    ),
    (
        "SDND108: a mass falls on elastic ground",
        """1 kg without a spring, thrown down at 1 m/s, 2 m above a ground of 100 N/m, under 10 m/s^2. The manual's numbers are closed
forms.""",
        sdnd108,
    ),
    (
        "SDND121: a forced mass against a stiff stop",
        """156 kg on 2e6 N/m, under 3 kN at 5 Hz, against a stop of 1e10 N/m, 1 mm away: 70 impacts in 4 s. The manual's times were
calculated from the closed forms of both states, to 1e-9 s.""",
        sdnd121,
    ),
    (
        "SDND122: free vibration against a stop",
        """1 kg on 10 N/m, 10 mm from a stop of 50 N/m, with an energy of 6.50108 mJ. The manual's number belongs to a contact law whose
corner is rounded off. With the corner, and v the speed at the stop, t0 = 2 (pi - atan(v/(w0 c)))/w0 apart and
t1 = 2 atan(w1 v/(w0^2 c))/w1 in contact.""",
        sdnd122,
    ),
    (
        "SDNL104: a cantilever falling on a stop",
        """E I = 785.4 kN m^2, 31 416 kg/m, 1 m long; from t = 0 on a force of 1000 N presses the tip down, 0.1 mm below which is a stop
of 1e8 N/m. At the first time the tip is where it came from; allowed is 1 % of the 0.1 mm. The manual's numbers are those of
ten finite elements by Newmark's method in steps of 0.1 ms, and what is played here by these is the same to the last digit;
its reductions to a few modes may differ from them by 9 %. Ours has 80 exact modes of the cantilever.""",
        sdnl104,
    ),
)

DOCUMENT = """# Verification

What the package computes, against numbers from elsewhere. This page is written by `scripts/verify` from runs of the library
and of its tools; nobody edits it. `scripts/verify` plays every case anew, ends with an error that names each case beyond what
is allowed, and writes the page; `scripts/verify --check`, a stage of `scripts/test`, compares it with what is committed.

All {count} comparisons are within what is allowed. A difference is a share of the source's number unless it has a unit or
that number is zero; `< 1e-09` is rounding. What the symbols mean: [model.md](model.md).

## Closed forms

Each number is computed from the formula beside it. Frequencies are over the lowest one of the beam alone.

{closed_forms}
The attachment basis is an approximation, of {attachment_modes} modes and one static shape of the beam; the others are the
equations of the continuous beam.

## Beams

Eigenvalues l of w_m = (l_m/L)^2 sqrt(E I/m).

{beams}
The beam of Ervin and Wickert, pinned at both ends, with a rigid body at its middle; frequencies over those of the beam alone.

{bodies}
## The paper's figure

The limiting case as [1] computes it, conjoined basis of 2 and 2 modes, damping 1 % and 5 %, k* = 1000, each frequency from
rest: `config/limiting_case.yaml` and `config/rigid_surface.yaml` through `frf_sweep`, 701 frequencies of 400 cycles. Allowed
is what can be read off the figure.

{landmarks}
The harmonic is lower, as in the paper. Its height over that of the resonance, and its period: {heights}.

## Published cases of another code

{aster}'s validation manual and its test files, [4] to [9]. `SwitchedModel` is built from a list of modes; where a force
acts, its modal forces stand for those of the base's acceleration.

{aster_sections}
## Independent integrators

The paper's two beams, 1 m/s^2 on the base, clearance 0.3 a/omega_11^2, damping 1 % apart and 5 % in contact, from rest: the
first impacts by the library (`HarmonicSimulation`) and by three methods that locate the switches by themselves. Largest
differences, of impact times in drive cycles, of impulses in shares of the greatest one. Allowed is {allowed:.0e}.

{integrators}
- Fehlberg 7(8) integrates the equations of both states as the library has them, with the library's mapping.
- LSODA and the matrix exponential share nothing with the library: modes from the formulas of the pinned beam, the attachment
  shape as a sum of 100 000 modes, the states in contact from the eigenvectors of the stiffness matrix.

## Sources

1. E. K. Ervin: the paper that the package follows, [model.md](model.md#references).
2. R. D. Blevins, *Formulas for Natural Frequency and Mode Shape*, table 8-1, as public test suites quote it.
3. W. T. Thomson, *Theory of Vibration with Applications*, table 9.5-1 and appendix D: a free-free beam has the eigenvalues of
   the clamped-clamped one, a hinged-free one those of the clamped-hinged one, besides those at zero.
4. {aster}, V5.01.101, SDND101 *Release of a spring mass system with shock*; `astest/sdnd101a.comm`, values marked
   `ANALYTIQUE`.
5. {aster}, V5.01.102, SDND102, results of modelling A; `astest/sdnd102a.comm`.
6. {aster}, V5.01.108, SDND108, modelling A; `astest/sdnd108a.comm`, values marked `ANALYTIQUE`.
7. {aster}, V5.01.121, SDND121 *Spring mass system with shocks under forced excitation*; `astest/sdnd121a.py`.
8. {aster}, V5.01.122, SDND122; `astest/sdnd122a.comm`, `VALE_CALC`.
9. {aster}, V5.02.104, SDNL104 *Non-linear transient substructuration: impact of a beam on 1 support*, benchmark
   results; `astest/sdnl104a.comm` to `sdnl104d.comm`.
10. Boost.Odeint, `runge_kutta_fehlberg78` with step control; `test/core/independent_integrator.h`.
11. ODEPACK's LSODA with the events of SciPy's `solve_ivp`; `test/verification/independent_motion.py`.
12. SciPy's `expm`, roots by `brentq`; the same file.

{aster}'s documents V5... were read at <{aster_web}>, its test files in {aster_files}.
"""


def collect(arguments):
    """Every case, by section, and the document."""
    say("[1/3] the library's runs")
    runs = played(arguments.runs)
    closed = bilinear(runs) + contact_frequencies(runs) + thrown_mass(runs) + proportionality(runs) + energy(runs)
    closed += interference_fit(runs)
    aster = [(heading, about, play(runs)) for heading, about, play in ASTER_CASES]
    beams, bodies = beams_of_any_ends(runs), beams_with_body(runs)
    say("[2/3] the paper's figure, swept")
    figure, heights = landmarks(arguments.frf_sweep)
    say("[3/3] independent integrators (the longest part: a minute)")
    integrated, rows = integrators(runs)
    header = ["beams", "omega*", "cycles", "impacts", "integrator", "impact times", "impulses"]
    named = [case._replace(name=f"{heading}: {case.name}") for heading, _, compared in aster for case in compared]
    cases = closed + beams + bodies + figure + named + integrated
    text = DOCUMENT.format(
        count=len(cases),
        closed_forms=case_table(closed),
        attachment_modes=ATTACHMENT_MODES,
        beams=case_table(beams),
        bodies=case_table(bodies),
        landmarks=case_table(figure),
        heights=heights,
        aster_sections="\n".join(f"### {heading}\n\n{about}\n\n{case_table(compared)}" for heading, about, compared in aster),
        allowed=INTEGRATORS_ALLOWED,
        integrators=table(header, rows),
        aster=ASTER,
        aster_web=ASTER_WEB,
        aster_files=ASTER_FILES,
    )
    return cases, text


def verify(arguments):
    cases, text = collect(arguments)
    failed = [case for case in cases if fails(case)]
    say(f"{len(cases) - len(failed)} cases within what is allowed, {len(failed)} beyond")
    for case in failed:
        unit = f" {case.unit}" if case.unit else ""
        shared = "" if case.relative else unit
        say(
            f"FAILED: {case.name}: {number(case.ours, 12)}{unit} against {case.stated}{unit}: difference {difference(case):.3g}{shared}, "
            f"allowed {case.allowed:g}{shared}"
        )
    if failed:
        raise RunError(f"{len(failed)} of {len(cases)} cases beyond what is allowed; {arguments.document} is as it was")
    if not arguments.check:
        replace(arguments.document, text)
        say(f"written: {arguments.document}")
        return
    try:
        with open(arguments.document, encoding="utf-8") as file:
            found = first_difference(file.read(), text)
    except OSError as error:
        raise RunError(f"{arguments.document}: {error.strerror}") from error
    if found:
        raise RunError(
            f"{arguments.document} is not what the runs give; run scripts/verify and commit it. First difference:\n"
            f"  committed: {found[0]}\n  now:       {found[1]}"
        )
    say(f"{arguments.document} is up to date")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", required=True, metavar="PROGRAM", help="verification_runs")
    parser.add_argument("--frf-sweep", required=True, metavar="PROGRAM", help="frf_sweep")
    parser.add_argument("--document", required=True, metavar="FILE", help="doc/verification.md")
    parser.add_argument("--check", action="store_true", help="compare with the document instead of writing it")
    arguments = parser.parse_args()

    try:
        verify(arguments)
    except (RunError, response.TableError) as error:
        sys.exit(f"verify: error: {error}")


if __name__ == "__main__":
    main()
