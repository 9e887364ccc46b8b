"""One frame of the live view as lines of text: the trace of the gap, the last impulses as bars, rates, diagnostics."""

import math

from live_feed import rising_crossings, steady_frequency

LEAST_WIDTH = 60
LEAST_HEIGHT = 16

# Time spans in s: 1, 2, 5 times a power of ten.
SPANS = [digit * 10.0 ** exponent for exponent in range(-6, 1) for digit in (1, 2, 5)][:-2]

# Drive cycles that the trace shows if nobody says otherwise.
CYCLES = 4.0

# Silence after which the stream is called stale, s.
STALE = 2.0

LEVELS = ["OK", "WARN", "ERROR", "STALE"]

PREFIXES = [(1.0, ""), (1e-3, "m"), (1e-6, "u"), (1e-9, "n"), (1e-12, "p")]


def prefixed(value, unit):
    """A number (SI) as text with three digits and a prefix of its unit (str)."""
    for size, prefix in PREFIXES:
        if abs(value) >= 0.9995 * size:
            return "%.3g %s%s" % (value / size, prefix, unit)
    return "0 " + unit if value == 0.0 else "%.3g %s" % (value, unit)


def nice(value):
    """The least of 1, 2, 5 times a power of ten that is not less than `value` > 0."""
    power = 10.0 ** math.floor(math.log10(value))
    for digit in (1.0, 2.0, 5.0, 10.0):
        if digit * power >= value * (1.0 - 1e-9):
            return digit * power


class Characters:
    """What lines are drawn with: UTF-8, or `ascii_only`."""

    def __init__(self, ascii_only):
        self.bars = " #" if ascii_only else " \u2581\u2582\u2583\u2584\u2585\u2586\u2587\u2588"
        # of the halves of a cell: none, lower, upper, both
        self.halves = [" ", "#", "#", "#"] if ascii_only else [" ", "\u2584", "\u2580", "\u2588"]
        self.axis = "|" if ascii_only else "\u2502"
        self.zero = "-" if ascii_only else "\u2500"


class Frame:
    """Draws frames, and remembers scales and what was shown, so that the picture stands still."""

    def __init__(self, topic, ascii_only, span=None):
        """`topic` (str): name of the gap's, for the title; `span`: of the trace, s; None: some drive cycles."""
        self.topic = topic
        self.characters = Characters(ascii_only)
        self.span = span
        self.shown_span = None
        self.range = None     # of the axis of the gap, m
        self.highest = None   # of the axis of the impulses, N s
        self.middles = None   # of the columns shown last, m

    def change_span(self, step):
        """Longer by `step` (+1) or shorter (-1) places of SPANS."""
        shown = self.span or self.shown_span or 0.01
        index = min(range(len(SPANS)), key=lambda i: abs(math.log(SPANS[i] / shown))) + step
        self.span = SPANS[max(0, min(len(SPANS) - 1, index))]
        self.middles = None

    def lines(self, feed, now, width, height, frozen=False):
        """The frame as `height` lines of at most `width` characters: of `feed` (Feed) at `now`, s."""
        if width < LEAST_WIDTH or height < LEAST_HEIGHT:
            return ["terminal too small: %d x %d, needs %d x %d" % (width, height, LEAST_WIDTH, LEAST_HEIGHT)][:height]
        state = self.state(feed, now, frozen)
        title = ("vibro_impact live  %s" % self.topic)[:width - len(state) - 2]
        lines = [title + " " * (width - len(title) - len(state)) + state]
        rows = height - 8  # of both pictures
        bars = max(3, rows // 3)
        crossings = rising_crossings(feed.drive, 24)
        frequency = steady_frequency(crossings, feed.drive.period) if crossings else None
        lines += self.trace(feed, crossings, frequency, width, rows - bars)
        lines += self.impulses(feed, width, bars)
        lines += self.rates(feed, frequency)
        lines.append(self.diagnostics(feed))
        lines.append("q quit   p freeze   + - time span   (contact below the line at 0)")
        return [line[:width] for line in lines]

    def state(self, feed, now, frozen):
        if frozen:
            return "FROZEN, p goes on"
        if feed.last_heard is None:
            return "waiting"
        if now - feed.last_heard > STALE:
            return "STALE, nothing for %.0f s" % (now - feed.last_heard)
        return "running"

    def trace(self, feed, crossings, frequency, width, rows):
        """A line of words and `rows` lines of the gap over time, the least and greatest of each column."""
        columns = width - 11
        if not feed.gap.size:
            return ["waiting for topic %s" % self.topic] + [""] * rows
        gap = feed.gap
        self.shown_span = span = self.span or (nice(0.8 * CYCLES / frequency) if frequency else 0.01)
        samples = min(span / gap.period, float(gap.size - 1))
        start, triggered = self.start(gap, crossings, samples, columns)
        lows, highs = self.columns(gap, start, samples, columns)
        self.middles = [0.5 * (low + high) for low, high in zip(lows, highs)]
        bottom, top = self.axis(min(lows), max(highs))
        words = "gap %s to %s, %s" % (
            prefixed(min(lows), "m"), prefixed(max(highs), "m"), prefixed(samples * gap.period, "s"))
        if frequency:
            words += " = %.1f drive cycles" % (samples * gap.period * frequency)
        words += ", triggered" if triggered else ", newest (no drive to trigger on)"
        return [words] + self.picture(lows, highs, bottom, top, rows)

    def start(self, gap, crossings, samples, columns):
        """The number of the sample at which the trace begins, and whether the drive gave it: of the last rises of the
        drive after which there is a whole trace, that which looks most like the one shown last. So periods of several
        cycles stand still, too."""
        starts = [rise for rise in crossings if gap.first <= rise and rise + samples <= gap.end - 1][-16:]
        if not starts:
            return max(gap.first, gap.end - 1 - samples), False
        if self.middles is None or len(self.middles) != columns:
            return starts[-1], True

        def difference(start):
            lows, highs = self.columns(gap, start, samples, columns)
            return sum((0.5 * (low + high) - old) ** 2 for low, high, old in zip(lows, highs, self.middles))
        return min(reversed(starts), key=difference), True

    @staticmethod
    def columns(gap, start, samples, columns):
        """The least and greatest gap of each column, the sample before and after it included where it has none."""
        values, first = gap.values(int(start), int(math.ceil(start + samples)) + 1)
        lows, highs = [], []
        for column in range(columns):
            begin = start - first + samples * column / columns
            end = start - first + samples * (column + 1) / columns
            piece = list(values[int(math.ceil(begin)):int(math.floor(end)) + 1])
            for at in (begin, end):  # straight lines between samples
                i = min(int(at), len(values) - 1)
                j = min(i + 1, len(values) - 1)
                piece.append(values[i] + (at - i) * (values[j] - values[i]))
            lows.append(min(piece))
            highs.append(max(piece))
        return lows, highs

    def axis(self, least, greatest):
        """Round ends of the axis of the gap, zero included, that stay while they fit."""
        least, greatest = min(0.0, least), max(0.0, greatest)
        if greatest == least:
            return self.range or (-1e-6, 1e-6)
        fits = self.range and self.range[0] <= least and greatest <= self.range[1]
        if not fits or greatest - least < 0.4 * (self.range[1] - self.range[0]):
            step = nice((greatest - least) / 8.0)
            self.range = (math.floor(1.02 * least / step) * step, math.ceil(1.02 * greatest / step) * step)
        return self.range

    def picture(self, lows, highs, bottom, top, rows):
        """The columns as lines, with the axis before them."""
        halves = 2 * rows

        def half(value):  # 0: the topmost
            return min(halves - 1, max(0, int((top - value) / (top - bottom) * halves)))
        cells = [[0] * len(lows) for _ in range(rows)]
        for column, (low, high) in enumerate(zip(lows, highs)):
            for i in range(half(high), half(low) + 1):
                cells[i // 2][column] |= 1 if i % 2 else 2
        zero = half(0.0) // 2
        lines = []
        for row in range(rows):
            label = {0: prefixed(top, "m"), rows - 1: prefixed(bottom, "m")}.get(row, "")
            label = "0" if row == zero else label
            empty = self.characters.zero if row == zero else " "
            lines.append("%9s %s" % (label, self.characters.axis) + "".join(
                self.characters.halves[cell] if cell else empty for cell in cells[row]))
        return lines

    def impulses(self, feed, width, rows):
        """A line of words and `rows` lines of bars, the last impact on the right."""
        columns = width - 11
        impacts = list(feed.impacts)[-columns:]
        if not impacts:
            return ["impulses: no impact yet"] + [""] * rows
        values = [impact.impulse for impact in impacts]
        greatest = max(max(values), 0.0)
        if not self.highest or greatest > self.highest or greatest < 0.3 * self.highest:
            self.highest = nice(greatest) if greatest > 0.0 else 1.0
        steps = len(self.characters.bars) - 1
        lines = ["last %d impulses: mean %s (%s to %s), greatest force %s" % (
            len(values), prefixed(sum(values) / len(values), "N s"),
            prefixed(min(values), "N s"), prefixed(max(values), "N s"),
            prefixed(max(impact.peak_force for impact in impacts), "N"))]
        for row in range(rows):
            below = (rows - 1 - row) * steps
            bars = [min(steps, max(0, int(math.ceil(value / self.highest * rows * steps)) - below)) for value in values]
            label = {0: prefixed(self.highest, "N s"), rows - 1: "0"}.get(row, "")
            lines.append("%9s %s" % (label, self.characters.axis) + " " * (columns - len(bars)) +
                         "".join(self.characters.bars[bar] for bar in bars))
        return lines

    def rates(self, feed, frequency):
        def number(value, text):
            return "-" if value is None else text % value
        factor = next((values["Real-time factor"] for _, _, values, _ in feed.statuses.values()
                       if "Real-time factor" in values), None)
        drive = "-" if not feed.drive.size else number(frequency, "%.2f Hz") if frequency else "no steady frequency"
        impacts = feed.impacts_per_second()
        per_cycle = " (%.2f per drive cycle)" % (impacts / frequency) if impacts and frequency else ""
        return [
            "drive %s   impacts %s%s" % (drive, number(impacts, "%.0f/s"), per_cycle),
            "samples %s   stream %s x wall time   computing %s x real time" % (
                number(feed.samples.per_second(), "%.0f/s"), number(feed.stream_time.per_second(), "%.2f"),
                factor or "-"),
            "missed here %d samples, %d impacts   new streams %d   impacts heard %d" % (
                feed.missed_samples, feed.missed_impacts, feed.restarts, feed.impact_count)]

    @staticmethod
    def diagnostics(feed):
        if not feed.statuses:
            return "diagnostics: none yet"
        name, (level, message, _, _) = max(feed.statuses.items(), key=lambda status: status[1][0])
        worst = LEVELS[min(level, len(LEVELS) - 1)]
        return "diagnostics: %s" % worst if level == 0 else "diagnostics: %s, %s: %s" % (worst, name, message)
