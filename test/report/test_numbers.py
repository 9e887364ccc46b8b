#!/usr/bin/python3
"""What the report computes, against SciPy, closed forms and known answers."""

import math
import os
import sys
import types
import unittest
import warnings

import numpy as np
import scipy.signal

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import recorded  # noqa: E402

import vibro_impact  # noqa: E402
from vibro_impact.report import (
    chart,
    impact_charts,
    model,
    packing,
    response_charts,
    segments,
    spectra,
    spectral_charts,
    step_data,
)  # noqa: E402
from vibro_impact.report import run as runs  # noqa: E402

PERIOD = 1.0e-3


def unpacked(packed):
    """What page.js reads from a packed array."""
    import base64
    import zlib

    kind = np.dtype(packed["t"]).newbyteorder("<")
    planes = np.frombuffer(zlib.decompress(base64.b64decode(packed["z"])), dtype=np.uint8).reshape(
        kind.itemsize, packed["n"]
    )
    return np.frombuffer(planes.T.tobytes(), dtype=kind)


def recording_of(acceleration, gap, force=None, period=PERIOD):
    force = np.zeros(len(gap)) if force is None else force
    return types.SimpleNamespace(acceleration=acceleration, gap=gap, contact_force=force, sample_period=period, first=0)


def step(first, last, frequency):
    return segments.Segment(first, last, frequency, 1.0, 1.0, 0, 1)


class FrequencyResponse(unittest.TestCase):
    def setUp(self):
        random = np.random.RandomState(3)
        self.x = random.standard_normal(40000)
        self.y = scipy.signal.lfilter([0.3, 0.1], [1.0, -0.8, 0.4], self.x) + 0.5 * random.standard_normal(40000)

    def test_equals_scipys_estimates(self):
        found = spectra.frequency_response(self.x, self.y, PERIOD, 1024)
        options = dict(fs=1.0 / PERIOD, nperseg=1024, noverlap=512, detrend="constant")
        frequency, cross = scipy.signal.csd(self.x, self.y, **options)
        _, auto_x = scipy.signal.welch(self.x, **options)
        _, auto_y = scipy.signal.welch(self.y, **options)
        _, coherence = scipy.signal.coherence(self.x, self.y, **options)
        known = slice(2, 512)
        np.testing.assert_allclose(found.frequency, frequency[known])
        np.testing.assert_allclose(found.auto_excitation, auto_x[known], rtol=1e-10)
        np.testing.assert_allclose(found.auto_response, auto_y[known], rtol=1e-10)
        np.testing.assert_allclose(found.h1, (cross / auto_x)[known], rtol=1e-9)
        np.testing.assert_allclose(found.h2, (auto_y / np.conj(cross))[known], rtol=1e-9)
        np.testing.assert_allclose(found.coherence, coherence[known], rtol=1e-9)
        self.assertEqual((found.segments, found.resolution), (77, 1.0 / 1.024))

    def test_leaves_out_segments_with_a_loss(self):
        lost = self.y.copy()
        lost[20000:20010] = np.nan
        found = spectra.frequency_response(self.x, lost, PERIOD, 1024)
        self.assertEqual(found.segments, 75)
        self.assertTrue(np.isfinite(found.h1).all())
        self.assertIsNone(spectra.frequency_response(self.x, np.full(40000, np.nan), PERIOD, 1024))

    def test_one_segment_alone_is_no_estimate(self):
        self.assertIsNone(spectra.frequency_response(self.x, self.y, PERIOD, 40000))
        self.assertIsNone(spectra.frequency_response(self.x, self.y, PERIOD, 40002))
        self.assertEqual(spectra.frequency_response(self.x, self.y, PERIOD, 20000).segments, 3)

    def test_random_error_is_the_scatter_of_many_estimates(self):
        # 400 runs of their own noise; Bendat and Piersol's formula at their mean coherence.
        random = np.random.RandomState(5)
        magnitudes, coherences = [], []
        for _ in range(400):
            x = random.standard_normal(64 * 33)
            found = spectra.frequency_response(x, x + random.standard_normal(len(x)), PERIOD, 128)
            magnitudes.append(np.abs(found.h1[5:50]))
            coherences.append(found.coherence[5:50])
        scatter = np.std(magnitudes, axis=0).mean() / np.mean(magnitudes)
        self.assertAlmostEqual(np.mean(coherences), 0.5, delta=0.03)
        self.assertAlmostEqual(scatter / float(spectra.random_error(0.5, found.averages)), 1.0, delta=0.06)

    def test_overlapping_segments_are_worth_less_than_their_number(self):
        self.assertAlmostEqual(spectra.independent_averages(1, spectra.hann(64)), 1.0)
        self.assertAlmostEqual(
            spectra.independent_averages(1000, spectra.hann(4096)), 1000.0 / (1.0 + 2.0 / 36.0), delta=0.2
        )

    def test_resolution_follows_the_damping_or_leaves_enough_averages(self):
        self.assertEqual(spectra.segment_length(10**9, 2e-5, 5.4), 1 << 18)
        self.assertEqual(spectra.segment_length(50000, 2e-5, 5.4), 1 << 11)
        for samples in (50000, 1 << 20, 10**7):
            length = spectra.segment_length(samples, 2e-5, 1e-3)
            self.assertGreaterEqual(spectra.independent_averages(2 * samples // length - 1, spectra.hann(64)), 32.0)


class LinearRun(unittest.TestCase):
    """The bar: H1 equals the closed form within 2 % and 2 degrees where the coherence exceeds 0.99."""

    @staticmethod
    def closed_form(frequency, damping=0.01):
        """Gap per base acceleration of the two beams, mode by mode (doc/model.md, sections 1 and 3); 2 kHz and
        below."""
        omega = 2.0 * np.pi * frequency
        total = np.zeros(len(frequency), dtype=complex)
        length, height, width, density = 0.0529, 0.00127, 0.0127, 954.0
        mass = density * height * width
        for sign, modulus in ((1.0, 1.66e9), (-1.0, 1.66e12)):
            for m in range(1, 200, 2):
                natural = (m * np.pi / length) ** 2 * math.sqrt(modulus * height**2 / (12.0 * density))
                shape = math.sqrt(2.0 / (mass * length)) * math.sin(m * np.pi / 2.0)
                participation = math.sqrt(2.0 * mass * length) * 2.0 / (m * np.pi)
                total -= sign * shape * participation / (natural**2 - omega**2 + 2j * damping * natural * omega)
        return total

    def run_of(self, clearance, duration, skipped=0.0, damping=0.01):
        text = recorded.configuration(clearance=clearance, damping=damping)
        core = vibro_impact.Model(text)
        acceleration = recorded.random_drive(duration)
        gap, force, impacts = core.simulation(recorded.PERIOD).advance(acceleration)
        first = int(skipped / recorded.PERIOD)
        recording = recording_of(acceleration[first:], gap[first:], force[first:], recorded.PERIOD)
        recording.models = [
            types.SimpleNamespace(configuration=core.configuration, free_frequencies=core.free_frequencies)
        ]
        return recording, impacts

    @staticmethod
    def bandwidth(recording):
        return model.bandwidth(recording, model.of_recording(recording)[0])

    @staticmethod
    def drawn(recording, state, frequency):
        return model.receptance(model.of_recording(recording)[0], recorded.PERIOD, state, frequency)

    def estimate(self, recording):
        length = spectra.segment_length(len(recording.gap), recorded.PERIOD, self.bandwidth(recording))
        return spectra.frequency_response(recording.acceleration, recording.gap, recorded.PERIOD, length)

    def test_h1_is_the_closed_form(self):
        recording, impacts = self.run_of(1e-2, 60.0)
        self.assertEqual((len(impacts), recording.contact_force.max()), (0, 0.0))
        found = self.estimate(recording)
        shown = (found.coherence > 0.99) & (found.frequency < 2000.0)
        self.assertGreater(np.count_nonzero(shown), 5000)
        ratio = found.h1[shown] / self.closed_form(found.frequency[shown])
        self.assertLess(np.max(np.abs(np.abs(ratio) - 1.0)), 0.02)
        self.assertLess(np.max(np.abs(np.degrees(np.angle(ratio)))), 2.0)
        # The page's own closed form is that of the model, and accounts for the straight lines between samples up to
        # Nyquist.
        drawn = self.drawn(recording, model.linear_state(recording, False, False), found.frequency)
        wanted = self.closed_form(found.frequency[shown]) * np.sinc(found.frequency[shown] * recorded.PERIOD) ** 2
        np.testing.assert_allclose(drawn[shown], wanted, rtol=1e-3)
        lines, magnitude, angle = spectral_charts.agreement(found, drawn)
        self.assertGreater(lines, 15000)
        self.assertLess(magnitude, 0.02)
        self.assertLess(angle, 2.0)

    def test_h1_is_the_closed_form_at_the_resonance_itself(self):
        # The lines are as far apart as they may be: a sixteenth of the bandwidth.
        damping = 0.0113
        recording, _ = self.run_of(1e-2, 120.0, damping=damping)
        found = self.estimate(recording)
        spacing = found.resolution / (2.0 * damping * recorded.FREQUENCY)
        self.assertLess(spacing, 1.0 / 16.0)
        self.assertGreater(spacing, 0.98 / 16.0)
        peak = np.argmin(np.abs(found.frequency - recorded.FREQUENCY))
        near = slice(peak - 3, peak + 4)
        self.assertGreater(found.coherence[near].min(), 0.99)
        ratio = found.h1[near] / self.closed_form(found.frequency[near], damping)
        self.assertLess(np.max(np.abs(np.abs(ratio) - 1.0)), 0.02)
        self.assertLess(np.max(np.abs(np.degrees(np.angle(ratio)))), 2.0)
        # The bias that doc/report.md derives, and no more than the scatter beside it.
        bias = 4.0 / 3.0 * spacing**2
        self.assertAlmostEqual(1.0 - found.coherence[peak], bias, delta=0.6 * bias)

    def test_a_run_that_never_separates_has_the_closed_form_of_the_other_state(self):
        recording, _ = self.run_of(-1e-3, 20.0, skipped=2.0)
        self.assertGreater(recording.contact_force.min(), 0.0)
        found = self.estimate(recording)
        drawn = self.drawn(recording, model.linear_state(recording, True, True), found.frequency)
        lines, magnitude, angle = spectral_charts.agreement(found, drawn)
        self.assertGreater(lines, 1000)
        self.assertLess(magnitude, 0.03)
        self.assertLess(angle, 2.0)

    def test_the_resolution_is_that_of_the_least_damped_mode(self):
        text = (
            "beam1: {modal_table: {frequency_hz: [10.0, 40.0, 90.0], contact_deflection: [0.5, 0.4, 0.3],"
            " participation: [1.2, 0.3, 0.1], damping_ratio: [0.05, 0.004, 0.02]}}\nbeam2: rigid\ncontact: {stiffness:"
            " 4.0e+4, clearance: 0.01}\ndamping: {free: 0.03, contact: 0.05}\nbasis: {type: conjoined, modes_free: 3,"
            " modes_contact: 3}\n"
        )
        recording = types.SimpleNamespace(models=[types.SimpleNamespace(configuration=text)])
        self.assertAlmostEqual(self.bandwidth(recording), 2.0 * 0.004 * 40.0, places=12)

    def test_the_resolution_without_a_model_is_that_for_a_usual_damping(self):
        for text, frequencies, wanted in (
            ("beam1: {", [0.0, 25.0, 12.0], 2.0 * 0.01 * 12.0),
            ("", [], 1.0),
        ):
            info = types.SimpleNamespace(configuration=text, free_frequencies=np.array(frequencies))
            recording = types.SimpleNamespace(models=[info])
            found, reason = model.of_recording(recording)
            self.assertIsNone(found)
            self.assertIn("the recorded configuration cannot be used: ", reason)
            self.assertNotIn("\n", reason)
            self.assertAlmostEqual(model.bandwidth(recording, found), wanted)
        recording = types.SimpleNamespace(models=[])
        self.assertEqual(model.of_recording(recording), (None, "the recording holds no model_info"))
        self.assertEqual(model.bandwidth(recording, None), 1.0)

    def test_no_closed_form_where_the_contact_opens_and_closes(self):
        recording = types.SimpleNamespace(models=[None])
        self.assertEqual(model.linear_state(recording, True, False), "")
        self.assertEqual(model.linear_state(types.SimpleNamespace(models=[None, None]), False, False), "")


class Spectra(unittest.TestCase):
    def test_a_sine_has_its_amplitude(self):
        time = PERIOD * np.arange(1000)
        frequency, amplitude = spectra.amplitude_spectrum(3.0 + 0.25 * np.sin(2.0 * np.pi * 50.0 * time), PERIOD)
        self.assertEqual(frequency[np.argmax(amplitude)], 50.0)
        self.assertAlmostEqual(amplitude.max(), 0.25, places=9)

    def test_the_spectrogram_follows_a_step_of_the_frequency_and_marks_a_loss(self):
        time = PERIOD * np.arange(20480)
        signal = np.where(time < 10.24, np.sin(2 * np.pi * 62.5 * time), 0.1 * np.sin(2 * np.pi * 125.0 * time))
        signal[1024:1100] = np.nan
        times, frequency, amplitude = spectra.spectrogram(signal, PERIOD, 20, 512)
        self.assertEqual(len(times), 20)
        self.assertTrue((np.diff(times) > 0.0).all())
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            self.assertTrue(np.isfinite(amplitude[:, 1]).all())
        early, late = (int(np.searchsorted(times, at)) for at in (5.0, 15.0))
        self.assertEqual(frequency[np.argmax(amplitude[:, early])], 62.5)
        self.assertAlmostEqual(amplitude[:, early].max(), 1.0, places=6)
        self.assertEqual(frequency[np.argmax(amplitude[:, late])], 125.0)
        self.assertAlmostEqual(amplitude[:, late].max(), 0.1, places=6)
        signal[1024:2048] = np.nan
        self.assertTrue(np.isnan(spectra.spectrogram(signal, PERIOD, 20, 512)[2][:, 1]).all())

    def assert_random(self, wanted, signal, period=PERIOD):
        found = spectra.spectral_lines(signal, period)
        self.assertEqual(runs.is_random(found), wanted, found)
        return found

    def test_tells_a_random_drive_from_a_sine_and_a_sweep(self):
        time = PERIOD * np.arange(200000)
        noise = np.random.RandomState(1).standard_normal(200000)
        self.assertLess(self.assert_random(False, np.sin(2 * np.pi * 41.3 * time)).lines, 4.0)
        chirp = scipy.signal.chirp(time, 5.0, 200.0, 100.0, "logarithmic")
        self.assertLess(self.assert_random(False, chirp).lines, 6.0)
        for length in (1000, 5000, 20000):
            fast = scipy.signal.chirp(time[:length], 5.0, time[length - 1], 200.0)
            self.assertLess(self.assert_random(False, fast).lines, 6.0)
        # Half of the lines of a segment share the power, whatever the band.
        self.assertAlmostEqual(self.assert_random(True, noise).lines / spectra.BAND_LINES, 0.5, delta=0.1)
        band = scipy.signal.butter(4, (10.0, 40.0), "bandpass", fs=1.0 / PERIOD, output="sos")
        found = self.assert_random(True, scipy.signal.sosfilt(band, noise))
        self.assertAlmostEqual(found.lines / spectra.BAND_LINES, 0.5, delta=0.1)
        self.assertIsNone(spectra.spectral_lines(np.zeros(1000), PERIOD))
        self.assertIsNone(spectra.spectral_lines(np.full(100000, np.nan), PERIOD))
        for length in (1, 2, 64, 255):
            self.assertIsNone(spectra.spectral_lines(noise[:length], PERIOD))

    def test_a_random_drive_is_random_at_any_sample_rate_and_with_losses(self):
        random = np.random.RandomState(1)
        for rate in (500.0, 5000.0, 50000.0):
            band = scipy.signal.butter(6, (2.0, 100.0), "bandpass", fs=rate, output="sos")
            noise = scipy.signal.sosfilt(band, random.standard_normal(int(30.0 * rate)))
            found = self.assert_random(True, noise, 1.0 / rate)
            self.assertAlmostEqual(found.lines / spectra.BAND_LINES, 0.5, delta=0.1)
        noise[:: int(0.5 * rate)] = np.nan
        self.assert_random(True, noise, 1.0 / rate)

    @unittest.skipUnless(recorded.WRITE_SIGNAL, "the tool write_signal is not given")
    def test_judges_the_signals_of_the_package(self):
        for name, wanted in (
            ("iec_60068_2_64_random", True),
            ("half_sine_shock", False),
            ("terminal_peak_shock", False),
        ):
            found = self.assert_random(wanted, *recorded.shipped_signal(name))
            if not wanted:  # for a shock has as many lines, but is silent most of the time
                self.assertLess(found.loud, 0.3)
        self.assert_random(True, *recorded.shipped_signal("iec_60068_2_64_random", 20.0))

    def test_merging_lines_keeps_the_greatest(self):
        merged, run = spectra.largest_of_each(np.array([1.0, 5.0, 2.0, 3.0, 4.0]), 2)
        self.assertEqual((merged.tolist(), run), ([5.0, 4.0], 3))


class Segments(unittest.TestCase):
    def test_directions_of_a_sweep_up_and_down(self):
        self.assertEqual(segments.directions([1.0, 2.0, 2.0, 3.0, 2.5, 1.0]).tolist(), [1, 1, 1, 1, -1, -1])
        self.assertEqual(segments.directions([2.0, 2.0, 1.0]).tolist(), [-1, -1, -1])
        self.assertEqual(segments.directions([2.0]).tolist(), [0])
        self.assertEqual(segments.directions([2.0, 2.0]).tolist(), [0, 0])

    def test_stroboscopic_points_are_the_gap_where_the_drive_rises_through_its_mean(self):
        frequency, lag = 21.7, 0.4
        angle = 2.0 * np.pi * frequency * PERIOD * np.arange(6000)
        # Period two: the subharmonic shows as two points.
        gap = np.sin(angle + 1.1 - lag) + 0.2 * np.cos(0.5 * (angle + 1.1))
        recording = recording_of(0.7 + 2.0 * np.sin(angle + 1.1), gap)
        points = segments.stroboscopic_points(step(1000, 6000, frequency), recording)
        self.assertEqual(len(points), 54)
        wanted = sorted((math.sin(-lag) + 0.2, math.sin(-lag) - 0.2))
        np.testing.assert_allclose(np.sort(points)[:27], wanted[0], atol=2e-4)
        np.testing.assert_allclose(np.sort(points)[27:], wanted[1], atol=2e-4)
        recording.acceleration[5900] = np.nan
        self.assertEqual(len(segments.stroboscopic_points(step(1000, 6000, frequency), recording)), 0)

    def test_the_cubic_between_samples_is_exact_for_cubics(self):
        x = np.arange(12.0)
        at = np.array([1.0, 1.25, 5.5, 8.999])
        np.testing.assert_allclose(segments.interpolate(x**3 - x, at), at**3 - at, rtol=1e-12)

    def test_equal_parts_cover_the_recording(self):
        parts = segments.equal_parts(recording_of(np.zeros(12345), np.zeros(12345)))
        self.assertEqual((parts[0].first, parts[-1].last, len(parts)), (0, 12345, 12))
        self.assertTrue(all(a.last == b.first for a, b in zip(parts, parts[1:])))


class Packing(unittest.TestCase):
    def test_numbers_come_back(self):
        values = np.random.RandomState(1).standard_normal(1001)
        np.testing.assert_array_equal(unpacked(packing.packed(values, "f8")), values)
        np.testing.assert_array_equal(unpacked(packing.packed(values, "f4")), values.astype("f4"))
        np.testing.assert_array_equal(unpacked(packing.packed(np.arange(5), "i4")), np.arange(5))
        self.assertEqual(len(unpacked(packing.packed([], "f8"))), 0)

    def test_quantised_numbers_come_back_to_half_a_step_and_holes_as_holes(self):
        values = np.random.RandomState(1).standard_normal(1001)
        values[7] = np.nan
        for kind, steps in (("u2", 65534), ("u1", 254)):
            stored = packing.quantised(values, kind)
            back = np.where(unpacked(stored) == stored["hole"], np.nan, stored["b"] + stored["s"] * unpacked(stored))
            np.testing.assert_allclose(back, values, atol=0.501 * (np.nanmax(values) - np.nanmin(values)) / steps)
        np.testing.assert_array_equal(unpacked(packing.quantised(np.full(3, 2.5))), 0)

    def test_units_for_reading(self):
        self.assertEqual(
            [packing.prefix(v)[1] for v in (0.0, 2e-6, 0.999, 1.0, 4e4, 1e-15, math.inf)],
            ["", "\u00b5", "m", "", "k", "p", ""],
        )
        self.assertAlmostEqual(packing.prefix(2e-6)[0] * 2e-6, 2.0)


class StepData(unittest.TestCase):
    def test_extremes_miss_no_peak_and_the_end_has_every_sample(self):
        random = np.random.RandomState(2)
        gap = random.standard_normal(20000)
        gap[4321] = 50.0
        recording = recording_of(random.standard_normal(20000), gap, np.maximum(0.0, -gap))
        segment = step(1000, 15000, 20.0)
        data = step_data.of_segment(recording, segment, (100, 500, 64), 500.0)
        low, high, _, force_high = unpacked(data["extremes"]).reshape(4, data["bins"])
        self.assertEqual((high.max(), low.min()), (50.0, np.float32(gap[1000:15000].min())))
        self.assertEqual(force_high.max(), np.float32(np.max(-gap[1000:15000])))
        end = unpacked(data["end"]).reshape(2, data["samples"])
        self.assertEqual(data["begin"] + data["samples"], 15000 - 25)
        np.testing.assert_array_equal(end[0], gap[data["begin"] : 14975].astype("f4"))

    def test_says_why_there_is_no_spectrum(self):
        random = np.random.RandomState(2)
        gap, force = random.standard_normal(8000), random.standard_normal(8000)
        force[4000:] = 0.0  # which is not in contact, after a contact in the half before
        gap[3000] = np.nan
        recording = recording_of(random.standard_normal(8000), gap, force)
        part = segments.Segment(0, 8000, None, None, None, 0, 0)
        data = step_data.of_segment(recording, part, (100, 500, 64), 500.0)
        self.assertIn("gap_spectrum", data)
        self.assertEqual(data["no_force_spectrum"], "nothing moves")
        self.assertNotIn("force_spectrum", data)
        gap[5000] = np.nan
        data = step_data.of_segment(recording, part, (100, 500, 64), 500.0)
        self.assertEqual(data["no_gap_spectrum"], "samples are lost")
        part = segments.Segment(0, 20, None, None, None, 0, 0)
        self.assertEqual(step_data.spectrum(gap, part, PERIOD, 64, 500.0), "too few samples")

    def test_takes_a_length_that_is_transformed_fast(self):
        self.assertEqual([step_data.largest_factor(n) for n in (1, 2, 97, 1024, 2 * 3 * 49)], [1, 2, 97, 2, 7])
        length = step_data.quick_length(100, 115.12)
        self.assertLess(step_data.largest_factor(length), 100)
        self.assertLess(abs(length / 115.12 - round(length / 115.12)), 0.01)
        self.assertEqual(step_data.quick_length(1, 7.0), 7)

    def test_stays_within_its_budget(self):
        for number in (1, 40, 701, 1500):
            bins, samples, lines = step_data.sizes(number, 9.0e6)
            self.assertLess(number * 4.0 / 3.0 * (16 * bins + 8 * samples + 4 * lines), 9.0e6)
        self.assertEqual(step_data.embedded(list(range(10)), 3), list(range(10)))
        chosen = step_data.embedded(list(range(9999)), 4444)
        self.assertIn(4444, chosen)
        self.assertLessEqual(len(chosen), step_data.MOST_SEGMENTS)


class Charts(unittest.TestCase):
    def test_bins_hold_every_impact(self):
        for values in (
            np.random.RandomState(1).gamma(2.0, 1e-3, 5000),
            np.full(7, 3.0),
            np.zeros(3),
            np.array([1.0, 2.0]),
        ):
            counts, edges = impact_charts.bins(values)
            self.assertEqual(counts.sum(), len(values))
            self.assertLessEqual(len(counts), impact_charts.MOST_BINS)
            self.assertTrue((np.diff(edges) > 0.0).all())

    def test_a_band_is_closed_by_itself_before_and_behind_a_hole(self):
        x = np.arange(7.0)
        low = np.array([np.nan, 1.0, 2.0, np.nan, 4.0, np.nan, np.nan])
        across, up = chart.outline(x, low, low + 0.5)
        np.testing.assert_array_equal(across, [1.0, 2.0, 2.0, 1.0, 1.0, np.nan, 4.0, 4.0, 4.0, np.nan])
        np.testing.assert_array_equal(up, [1.0, 2.0, 2.5, 1.5, 1.0, np.nan, 4.0, 4.5, 4.0, np.nan])
        for known in (np.full(3, np.nan), np.empty(0)):
            self.assertEqual(len(chart.outline(known, known, known)[0]), 0)

    def test_points_that_cover_each_other_are_drawn_once(self):
        x = np.array([1.0, 1.0, 1.0, 2.0])
        y = np.array([0.5, 0.5 + 1e-9, 1.0, 0.5])
        self.assertEqual(response_charts.distinct(x, y).tolist(), [0, 2, 3])
        self.assertEqual(len(response_charts.distinct(x[:2], np.zeros(2))), 1)


if __name__ == "__main__":
    unittest.main(argv=[a for a in sys.argv if a not in recorded.WRITE_SIGNAL])
