"""The frame of the live view, from samples made here: what is drawn of them, and that it stands still."""

import math
import os
import struct
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "scripts"))
from live_feed import KEPT_IMPACTS, KEPT_SAMPLES, Block, Feed, Impact, rising_crossings, steady_frequency  # noqa: E402
from live_frame import Frame, nice, prefixed  # noqa: E402

PERIOD = 1e-4
SIZE = 100


def block(seq, value, period=PERIOD, size=SIZE):
    """A block as it comes: value(number of the sample) at every sample."""
    values = [value(seq + i) for i in range(size)]
    frame = b"base_frame"
    return Block.parse(struct.pack("<IIII", 1, 2, 3, len(frame)) + frame + struct.pack("<QdI", seq, period, size) +
                       struct.pack("<%dd" % size, *values))


def sine(frequency, amplitude=1.0, offset=0.0, phase=0.0):
    return lambda i: offset + amplitude * math.sin(2.0 * math.pi * (frequency * i * PERIOD + phase))


def feed(gap, drive, blocks, start=0):
    result = Feed()
    for n in range(start, start + blocks):
        result.add_drive(block(n * SIZE, drive))
        result.add_gap(block(n * SIZE, gap), 0.01 * n)
    return result


class FeedTest(unittest.TestCase):
    def test_a_block_is_what_was_sent(self):
        parsed = block(1 << 40, float, 2e-5, 3)
        self.assertEqual((parsed.seq, parsed.period, parsed.size), (1 << 40, 2e-5, 3))
        self.assertEqual(struct.unpack("<3d", parsed.data), (2.0 ** 40, 2.0 ** 40 + 1, 2.0 ** 40 + 2))
        for bad in (b"", b"1234567890123456789012345678901234567890", struct.pack("<IIIIQdI", 0, 0, 0, 0, 0, 0.0, 0)):
            self.assertRaises(ValueError, Block.parse, bad)

    def test_holes_and_restarts_are_counted_and_leave_none_in_the_samples(self):
        heard = Feed()
        for seq in (0, 100, 300, 400):
            heard.add_gap(block(seq, float), 0.0)
        self.assertEqual((heard.missed_samples, heard.restarts, heard.sample_count), (100, 0, 500))
        self.assertEqual((heard.gap.first, heard.gap.end), (300, 500))
        self.assertEqual(list(heard.gap.values(398, 403)[0]), [398.0, 399.0, 400.0, 401.0, 402.0])
        heard.add_impact(Impact(7, 310, 0.0, 1.0, 1.0))
        heard.add_impact(Impact(9, 320, 0.0, 1.0, 1.0))
        self.assertEqual(heard.missed_impacts, 1)
        heard.add_gap(block(0, float), 1.0)
        self.assertEqual((heard.missed_samples, heard.restarts, len(heard.impacts)), (100, 1, 0))
        heard.add_impact(Impact(0, 5, 0.0, 1.0, 1.0))
        self.assertEqual(heard.missed_impacts, 1)

    def test_keeps_no_more_than_it_shows(self):
        heard = Feed()
        data = bytes(8 * 20000)
        for n in range(100):
            heard.add_gap(Block(n * 20000, 1e-7, data), 0.0)
            heard.add_impact(Impact(n, n, 0.0, 1.0, 1.0))
        self.assertLess(heard.gap.size, KEPT_SAMPLES + 20000)
        for n in range(100, 2000):
            heard.add_impact(Impact(n, n, 0.0, 1.0, 1.0))
        self.assertEqual(len(heard.impacts), KEPT_IMPACTS)

    def test_finds_the_frequency_of_the_drive(self):
        for frequency in (3.0, 43.21, 434.3, 2000.0):
            heard = feed(sine(frequency), sine(frequency, 10.0, 3.0), 400)
            crossings = rising_crossings(heard.drive, 24)
            self.assertAlmostEqual(steady_frequency(crossings, PERIOD) / frequency, 1.0, delta=2e-3)
        noise = feed(sine(1.0), lambda i: math.sin(0.37 * i * i), 100)
        self.assertIsNone(steady_frequency(rising_crossings(noise.drive, 24), PERIOD))
        silence = feed(sine(1.0), lambda i: 0.0, 100)
        self.assertEqual(rising_crossings(silence.drive, 24), [])

    def test_counts_impacts_in_the_time_of_the_stream(self):
        heard = feed(sine(1.0), sine(1.0), 300)
        self.assertEqual(heard.impacts_per_second(), 0.0)
        for n in range(150):
            heard.add_impact(Impact(n, 200 * n, 0.0, 1.0, 1.0))
        self.assertAlmostEqual(heard.impacts_per_second(), 50.0, delta=1.0)
        self.assertIsNone(Feed().impacts_per_second())


class FrameTest(unittest.TestCase):
    def lines(self, frame, heard, width=80, height=24, **options):
        lines = frame.lines(heard, 3.0, width, height, **options)
        self.assertEqual(len(lines), height)
        self.assertLessEqual(max(map(len, lines)), width)
        return lines

    def trace(self, lines):
        return [line[11:] for line in lines[2:13]]

    def test_the_trace_is_the_gap_over_the_span(self):
        # 4 cycles of 50 Hz in 80 ms: it begins where the drive rises, with the gap's lead of a quarter.
        heard = feed(sine(50.0, 1e-5, 0.5e-5, 0.25), sine(50.0), 300)
        frame = Frame("/gap", True, 0.05)
        lines = self.lines(frame, heard)
        self.assertIn("gap -5 um to 15 um, 50 ms = 2.5 drive cycles, triggered", lines[1])
        trace = self.trace(lines)
        top = next(row for row in trace if "#" in row)
        bottom = next(row for row in reversed(trace) if "#" in row)
        width = 69
        for crest in (0.0, 0.4, 0.8):
            self.assertIn("#", top[max(0, int(crest * width) - 3):int(crest * width) + 4])
            self.assertNotIn("#", top[int((crest + 0.1) * width):int((crest + 0.15) * width)])
        for trough in (0.2, 0.6):
            self.assertIn("#", bottom[int(trough * width) - 3:int(trough * width) + 4])
        zero = next(line for line in lines[2:13] if line.startswith("        0 |"))
        self.assertIn("-----", zero)
        for column in range(width):
            self.assertTrue(any(row.ljust(width)[column] == "#" for row in trace), column)

    def test_no_peak_is_lost_between_columns(self):
        spike = 300 * SIZE - 417
        heard = feed(lambda i: 5e-6 if i == spike else 1e-6, sine(50.0), 300)
        lines = self.lines(Frame("/gap", True, 0.2), heard)
        self.assertIn("gap 1 um to 5 um", lines[1])

    def test_it_stands_still_under_periods_of_several_cycles(self):
        def gap(i):
            return sine(50.0, 1e-5)(i) + sine(25.0, 0.5e-5)(i)
        frame = Frame("/gap", False, 0.05)
        first = self.trace(self.lines(frame, feed(gap, sine(50.0), 300)))
        for start in range(1, 8):
            self.assertEqual(self.trace(self.lines(frame, feed(gap, sine(50.0), 300, start))), first, start)

    def test_without_a_drive_the_newest_is_shown(self):
        heard = feed(sine(50.0, 1e-5), sine(50.0), 300)
        heard.drive = Feed().drive
        lines = self.lines(Frame("/gap", True, 0.05), heard)
        self.assertIn("newest (no drive to trigger on)", lines[1])
        self.assertIn("drive -", "\n".join(lines))

    def test_the_axis_stays_while_it_fits(self):
        frame = Frame("/gap", True)
        self.assertEqual(frame.axis(-1.0, 3.9), frame.axis(-0.9, 2.5))
        self.assertNotEqual(frame.axis(-0.9, 3.5), frame.axis(-0.1, 0.5))

    def test_bars_are_impulses(self):
        heard = feed(sine(50.0, 1e-5), sine(50.0), 10)
        for n in range(200):
            heard.add_impact(Impact(n, 4 * n, 0.0, 8e-6 if n % 2 else 4e-6, 0.2))
        lines = self.lines(Frame("/gap", True), heard)
        self.assertIn("last 69 impulses: mean 6.03 uN s (4 uN s to 8 uN s), greatest force 200 mN", lines[13])
        bars = [line[11:] for line in lines[14:19]]
        heights = [sum(row[column] == "#" for row in bars) for column in range(69)]
        self.assertEqual(heights, [4 if n % 2 else 2 for n in range(131, 200)])

    def test_says_what_is_missing(self):
        lines = self.lines(Frame("/rig1/gap", False), Feed())
        self.assertIn("waiting for topic /rig1/gap", lines[1])
        self.assertIn("waiting", lines[0])
        heard = feed(sine(50.0), sine(50.0), 10)
        self.assertIn("STALE, nothing for 3 s", self.lines(Frame("/gap", False), heard)[0])
        self.assertIn("FROZEN", self.lines(Frame("/gap", False), heard, frozen=True)[0])
        heard.add_status("simulator: Input", 1, "input is stale", {}, 0.0)
        heard.add_status("simulator: Model", 0, "ok", {"Real-time factor": "31.2"}, 0.0)
        text = "\n".join(self.lines(Frame("/gap", False), heard, 120))
        self.assertIn("diagnostics: WARN, simulator: Input: input is stale", text)
        self.assertIn("computing 31.2 x real time", text)
        self.assertEqual(Frame("/gap", False).lines(heard, 0.0, 59, 24), ["terminal too small: 59 x 24, needs 60 x 16"])
        self.assertEqual(len(self.lines(Frame("/gap", False), heard, 60, 16)), 16)

    def test_the_span_changes_in_steps_of_1_2_5(self):
        frame = Frame("/gap", False)
        self.lines(frame, feed(sine(50.0), sine(50.0), 300))
        self.assertAlmostEqual(frame.shown_span, 0.1)
        spans = []
        for step in (1, 1, 1, 1, 1, -1, -1):
            frame.change_span(step)
            spans.append(round(frame.span, 9))
        self.assertEqual(spans, [0.2, 0.5, 1.0, 1.0, 1.0, 0.5, 0.2])

    def test_numbers_have_three_digits_and_a_prefix(self):
        self.assertEqual([prefixed(value, "m") for value in (0.0, 1.5, 0.0123456, -3.21e-6, 9.9996e-4, 5e-13)],
                         ["0 m", "1.5 m", "12.3 mm", "-3.21 um", "1 mm", "5e-13 m"])
        self.assertEqual([round(nice(value), 9) for value in (0.9, 1.0, 1.1, 2.1, 5.1, 0.03)],
                         [1.0, 1.0, 2.0, 5.0, 10.0, 0.05])


if __name__ == "__main__":
    unittest.main()
