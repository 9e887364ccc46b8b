#!/usr/bin/python3
"""The model from Python: against closed forms, and bit for bit against the tools. Arguments: the tools to compare with."""

import csv
import math
import os
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy

import vibro_impact

CONFIG = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "config")
LIMITING_CASE = os.path.join(CONFIG, "limiting_case.yaml")
TOOLS = {os.path.basename(path): path for path in sys.argv[1:] if os.sep in path}

ONE_MODE = """
beam1: {modal_table: {frequency_hz: [10.0], contact_deflection: [0.5], participation: [1.2]}}
beam2: rigid
contact: {stiffness: 4.0e+4, clearance: %g}
damping: {free: 0.02, contact: 0.03}
basis: {type: conjoined, modes_free: 1, modes_contact: 1}
"""


def read_table(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


class CoreTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def run_tool(self, name, *arguments):
        if name not in TOOLS:
            self.skipTest("%s is not built" % name)
        subprocess.run([TOOLS[name], *arguments, "--out", self.folder], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def assert_same_table(self, array, name):
        """Every column of the tool's table, bit for bit."""
        table = read_table(os.path.join(self.folder, name))
        self.assertEqual(set(table), set(array.dtype.names))
        for column, values in table.items():
            with self.subTest(column):
                numpy.testing.assert_array_equal(array[column].astype(float), values)

    def assert_refused(self, words, function, *arguments, **options):
        with self.assertRaises(vibro_impact.Error) as caught:
            function(*arguments, **options)
        for word in words:
            self.assertIn(word, str(caught.exception))

    def test_configuration(self):
        model = vibro_impact.load_model(LIMITING_CASE)
        again = vibro_impact.Model(model.configuration)
        self.assertEqual(again.configuration, model.configuration)
        numpy.testing.assert_array_equal(again.contact_frequencies, model.contact_frequencies)
        self.assertEqual(len(model.mapping_loss), len(model.free_frequencies))

    def test_damping_ratios_are_those_of_the_table_or_of_the_configuration(self):
        table = ONE_MODE.replace("participation: [1.2]", "participation: [1.2], damping_ratio: [0.007]")
        for text, expected in ((ONE_MODE, 0.02), (table, 0.007)):
            model = vibro_impact.Model(text % 1.0)
            numpy.testing.assert_allclose(model.free_damping_ratios, [expected], rtol=1e-15)
        model = vibro_impact.load_model(LIMITING_CASE)
        self.assertEqual(len(model.free_damping_ratios), len(model.free_frequencies))

    def test_configurations_that_are_none(self):
        missing = os.path.join(self.folder, "nowhere.yaml")
        self.assert_refused([missing], vibro_impact.load_model, missing)
        self.assert_refused(["configuration", "beam2"], vibro_impact.Model, "beam1: rigid\n")
        self.assert_refused(["contact.stiffness"], vibro_impact.Model, ONE_MODE.replace("4.0e+4", "-1") % 1.0)
        with self.assertRaises(TypeError):
            vibro_impact.load_model(3)

    def test_natural_frequencies(self):
        model = vibro_impact.Model(ONE_MODE % 1.0)
        numpy.testing.assert_allclose(model.free_frequencies, [10.0], rtol=1e-12)
        # omega^2 + k phi^2
        expected = math.sqrt((20.0 * math.pi) ** 2 + 4.0e4 * 0.25) / (2.0 * math.pi)
        numpy.testing.assert_allclose(model.contact_frequencies, [expected], rtol=1e-9)
        self.assertEqual((model.stiffness, model.clearance), (4.0e4, 1.0))
        self.assertAlmostEqual(model.reference_frequency, 10.0, places=12)

    def test_receptance(self):
        model = vibro_impact.Model(ONE_MODE % 1.0)
        frequency = numpy.array([[0.0, 3.0], [9.0, 40.0]])
        omega, natural = 2.0 * math.pi * frequency, 20.0 * math.pi
        numpy.testing.assert_allclose(model.receptance(frequency), 0.25 / (natural**2 - omega**2), rtol=1e-9)
        numpy.testing.assert_array_equal(model.receptance(frequency, structure=2), numpy.zeros((2, 2)))
        expected = -0.5 * 1.2 / (natural**2 - omega**2 + 2j * 0.02 * natural * omega)
        numpy.testing.assert_allclose(model.gap_response(frequency), expected, rtol=1e-12)
        self.assertEqual(model.gap_response(3.0).shape, ())
        self.assert_refused(["structure is 3"], model.receptance, 1.0, structure=3)
        self.assert_refused(["frequency is -1"], model.receptance, -1.0)
        self.assert_refused(["state is 'S1'"], model.gap_response, 1.0, state="S1")

    def test_steady_response_that_never_touches_is_the_closed_form(self):
        model = vibro_impact.Model(ONE_MODE % 1.0)
        run = model.simulate_harmonic(frequency=8.0, acceleration=2.0, cycles=100, samples_per_cycle=64)
        self.assertEqual(len(run.impacts), 0)
        self.assertEqual(run.history.size, 6401)
        last = run.history[-64:]
        turn = numpy.exp(-2j * math.pi * 8.0 * last["time"])
        amplitude = 2.0 * numpy.mean(last["gap"] * turn)
        base = 2.0 * numpy.mean(last["acceleration"] * turn)
        numpy.testing.assert_allclose(abs(base), 2.0, rtol=1e-9)
        numpy.testing.assert_allclose(amplitude / base, model.gap_response(8.0), rtol=1e-5)
        self.assertLess(run.energy["closure"], 1e-9)

    def test_harmonic_run_is_the_tools(self):
        self.run_tool("simulate", LIMITING_CASE, "--omega-star", "0.8", "--acceleration", "3", "--cycles", "20")
        run = vibro_impact.load_model(LIMITING_CASE).simulate_harmonic(omega_star=0.8, acceleration=3.0, cycles=20)
        self.assertGreater(len(run.impacts), 5)
        self.assert_same_table(run.history, "history.csv")
        self.assert_same_table(run.impacts, "impacts.csv")
        quick = vibro_impact.load_model(LIMITING_CASE).simulate_harmonic(omega_star=0.8, acceleration=3.0, cycles=20, history=False)
        self.assertEqual((quick.history.size, quick.period), (0, run.period))
        numpy.testing.assert_array_equal(quick.impacts, run.impacts)

    def test_harmonic_run_from_a_motion(self):
        motion = ["--displacement1", "1e-6,2e-7", "--velocity1", "1e-5"]
        self.run_tool("simulate", LIMITING_CASE, "--frequency", "200", "--cycles", "5", *motion)
        run = vibro_impact.load_model(LIMITING_CASE).simulate_harmonic(
            frequency=200, cycles=5, displacement1=[1e-6, 2e-7], velocity1=[1e-5]
        )
        self.assert_same_table(run.history, "history.csv")

    def test_sweep_is_the_tools(self):
        for follow in (None, "down"):
            with self.subTest(follow):
                options = [] if follow is None else ["--follow", follow]
                self.run_tool(
                    "frf_sweep", LIMITING_CASE, "--from", "0.7", "--to", "1.1", "--points", "5", "--cycles", "60", *options
                )
                shares = []
                sweep = vibro_impact.load_model(LIMITING_CASE).sweep(
                    0.7, 1.1, points=5, cycles=60, follow=follow, progress=shares.append
                )
                self.assertEqual(shares[-1], 1.0)
                self.assert_same_table(sweep.responses, "frf.csv")
                self.assert_same_table(sweep.impacts, "impacts.csv")

    def test_samples_are_the_tools(self):
        period = 5.0e-5
        time = numpy.arange(4000) * period
        acceleration = 40.0 * numpy.sin(2.0 * math.pi * 230.0 * time)
        table = os.path.join(self.folder, "excitation.csv")
        with open(table, "w") as file:
            file.write("time,acceleration\n")
            for t, a in zip(time, acceleration):
                file.write("%r,%r\n" % (float(t), float(a)))
        self.run_tool("simulate", LIMITING_CASE, "--excitation", table)
        simulation = vibro_impact.load_model(LIMITING_CASE).simulation(period)
        gap, force, impacts = simulation.advance(acceleration)
        history = read_table(os.path.join(self.folder, "history.csv"))
        numpy.testing.assert_array_equal(gap, history["gap"])
        numpy.testing.assert_array_equal(force, history["force"])
        impacts = numpy.concatenate([impacts, simulation.finish()])
        written = read_table(os.path.join(self.folder, "impacts.csv"))
        numpy.testing.assert_array_equal(impacts["onset"], written["onset_s"])
        numpy.testing.assert_array_equal(impacts["impulse"], written["impulse"])
        self.assertGreater(len(impacts), 5)

    def test_samples_in_pieces(self):
        random = numpy.random.RandomState(3)
        acceleration = 30.0 * random.standard_normal(25001)
        model = vibro_impact.load_model(LIMITING_CASE)
        whole = model.simulation(2.0e-5)
        gap, force, impacts = whole.advance(acceleration)
        self.assertGreater(len(impacts), 5)
        self.assertEqual(whole.samples, 25001)
        pieces = model.simulation(2.0e-5)
        for _ in range(2):
            parts = [pieces.advance(acceleration[i : i + 700]) for i in range(0, 25001, 700)]
            numpy.testing.assert_array_equal(numpy.concatenate([part[0] for part in parts]), gap)
            numpy.testing.assert_array_equal(numpy.concatenate([part[1] for part in parts]), force)
            numpy.testing.assert_array_equal(numpy.concatenate([part[2] for part in parts]), impacts)
            self.assertEqual(pieces.in_contact, whole.in_contact)
            self.assertEqual(pieces.energy, whole.energy)
            pieces.reset()
            self.assertEqual(pieces.samples, 0)
        # Whatever is convertible: a list, every other element, single precision.
        twice = numpy.repeat(acceleration[:500], 2)[::2]
        numpy.testing.assert_array_equal(pieces.advance(list(twice))[0], gap[:500])
        pieces.reset()
        numpy.testing.assert_array_equal(pieces.advance(twice)[0], gap[:500])

    def test_simulations_side_by_side(self):
        acceleration = 30.0 * numpy.random.RandomState(3).standard_normal(20000)
        model = vibro_impact.load_model(LIMITING_CASE)
        gaps = {}

        def run(number):
            gaps[number] = model.simulation(2.0e-5).advance(acceleration)[0]

        threads = [threading.Thread(target=run, args=(number,)) for number in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for number in range(4):
            numpy.testing.assert_array_equal(gaps[number], gaps[0])

    def test_arguments_out_of_range(self):
        model = vibro_impact.Model(ONE_MODE % 1.0e-3)
        self.assert_refused(["one of frequency and omega_star"], model.simulate_harmonic)
        self.assert_refused(["one of frequency and omega_star"], model.simulate_harmonic, frequency=1.0, omega_star=1.0)
        self.assert_refused(["frequency is nan"], model.simulate_harmonic, frequency=math.nan)
        self.assert_refused(["cycles is 0", "1 to 1000000000"], model.simulate_harmonic, frequency=1.0, cycles=0)
        self.assert_refused(["history=False"], model.simulate_harmonic, frequency=1.0, cycles=100000)
        self.assert_refused(["structure"], model.simulate_harmonic, frequency=1.0, displacement1=[0.0, 1.0])
        self.assert_refused(["lowest is 2", "less than highest"], model.sweep, 2.0, 1.0, points=3)
        self.assert_refused(["points is 0"], model.sweep, 1.0, 2.0, points=0)
        self.assert_refused(["follow is 'left'"], model.sweep, 1.0, 2.0, points=3, follow="left")
        self.assert_refused(["threads is 0"], model.sweep, 1.0, 2.0, points=3, threads=0)
        self.assert_refused(["sample_period is 0"], model.simulation, 0.0)
        simulation = model.simulation(1.0e-3)
        self.assert_refused(["acceleration[1] is nan"], simulation.advance, [0.0, math.nan])
        self.assert_refused(["2 dimensions"], simulation.advance, numpy.zeros((2, 2)))
        self.assertEqual(simulation.samples, 0)
        undamped = vibro_impact.Model((ONE_MODE % 1.0e-3).replace("free: 0.02", "free: 0"))
        with self.assertRaises(vibro_impact.Error):
            undamped.simulate_harmonic(omega_star=1.0)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
