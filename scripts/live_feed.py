"""What a live view has heard of a simulator: the last samples of gap and drive, the last impacts, counts and rates.

Nothing here knows of ROS: messages come in as bytes or numbers, times as seconds of a clock of the caller's."""

import array
import collections
import struct

# Of the stream's time and of samples, whichever is less, that are kept.
KEPT_SECONDS = 4.0
KEPT_SAMPLES = 1 << 20

KEPT_IMPACTS = 1000

# Wall time over which rates are taken, s.
RATE_WINDOW = 3.0


class Block:
    """A block of equally spaced samples: `seq` of the first, `period` in s, `data`: the samples as bytes."""

    def __init__(self, seq, period, data):
        self.seq = seq
        self.period = period
        self.data = data
        self.size = len(data) // 8

    @staticmethod
    def parse(buffer):
        """From a serialised BaseExcitation, Gap or ContactForce (bytes), all laid out alike. Raises ValueError."""
        try:
            frame_length, = struct.unpack_from("<I", buffer, 12)
            seq, period, size = struct.unpack_from("<QdI", buffer, 16 + frame_length)
        except struct.error:
            raise ValueError("%d bytes are no block of samples" % len(buffer))
        data = buffer[16 + frame_length + 20:]
        if len(data) != 8 * size or not period > 0.0:
            raise ValueError("%d bytes are no block of samples" % len(buffer))
        return Block(seq, period, data)


class Samples:
    """The newest samples of a stream, without a hole between them: blocks (Block) in the order of the samples."""

    def __init__(self, blocks=()):
        self.blocks = collections.deque(blocks)
        self.size = sum(block.size for block in self.blocks)

    def add(self, block):
        """Takes a block; returns how many samples are missing before it, or -1 if the stream has begun anew."""
        missing = 0
        if self.blocks:
            missing = block.seq - self.end if block.period == self.period and block.seq >= self.end else -1
        if missing != 0:
            self.blocks.clear()
            self.size = 0
        self.blocks.append(block)
        self.size += block.size
        most = min(KEPT_SAMPLES, int(KEPT_SECONDS / block.period) + 1)
        while len(self.blocks) > 1 and self.size - self.blocks[0].size >= most:
            self.size -= self.blocks.popleft().size
        return missing

    @property
    def period(self):
        return self.blocks[-1].period

    @property
    def first(self):
        return self.blocks[0].seq

    @property
    def end(self):
        return self.blocks[-1].seq + self.blocks[-1].size

    def values(self, first, end):
        """The samples with the numbers first ... end - 1, as far as they are here, and the number of the first."""
        first = max(first, self.first)
        values = array.array("d")
        for block in self.blocks:
            if block.seq + block.size > first and block.seq < end:
                low = max(0, first - block.seq)
                high = min(block.size, end - block.seq)
                values.frombytes(block.data[8 * low:8 * high])
        return values, first


class Rate:
    """How fast a count grows, over the last seconds of the caller's clock."""

    def __init__(self, points=()):
        self.points = collections.deque(points)  # (time, count)

    def add(self, time, count):
        """The count (a number) has become `count` at `time`, s."""
        self.points.append((time, count))
        while len(self.points) > 2 and self.points[1][0] < time - RATE_WINDOW:
            self.points.popleft()

    def per_second(self):
        """None while too little is known."""
        if len(self.points) < 2 or self.points[-1][0] - self.points[0][0] < 0.2:
            return None
        return (self.points[-1][1] - self.points[0][1]) / (self.points[-1][0] - self.points[0][0])


# number: running; seq, offset: the onset, as the number of a sample and s after it; impulse in N s; peak_force in N
Impact = collections.namedtuple("Impact", "number seq offset impulse peak_force")


class Feed:
    """All that has come. What is drawn is drawn of a snapshot(), so that it can be frozen."""

    def __init__(self):
        self.gap = Samples()
        self.drive = Samples()
        self.impacts = collections.deque(maxlen=KEPT_IMPACTS)
        self.last_heard = None      # time of the last block of the gap, s; None: none yet
        self.samples = Rate()       # of the stream, by wall time
        self.stream_time = Rate()
        self.stream_seconds = 0.0   # since the beginning, restarts included
        self.sample_count = 0
        self.impact_count = 0
        self.missed_samples = 0     # holes in the numbers of what has come here
        self.missed_impacts = 0
        self.restarts = 0
        self.next_impact = None     # number of the next impact
        self.statuses = {}          # name -> (level, message, values by key, time)

    def add_gap(self, block, time):
        missing = self.gap.add(block)
        if missing < 0:
            self.restarts += 1
            self.impacts.clear()
        self.missed_samples += max(0, missing)
        samples = block.size + max(0, missing)
        self.sample_count += samples
        self.stream_seconds += samples * block.period
        self.samples.add(time, self.sample_count)
        self.stream_time.add(time, self.stream_seconds)
        self.last_heard = time

    def add_drive(self, block):
        self.drive.add(block)

    def add_impact(self, impact):
        """Takes an Impact."""
        # A stream that begins anew counts from 0.
        if self.next_impact is not None and impact.number > self.next_impact:
            self.missed_impacts += impact.number - self.next_impact
        self.next_impact = impact.number + 1
        self.impacts.append(impact)
        self.impact_count += 1

    def add_status(self, name, level, message, values, time):
        """One status (name, level 0 to 3, text, {key: value as text}) of the diagnostics, heard at `time`, s."""
        self.statuses[name] = (level, message, values, time)

    def impacts_per_second(self):
        """Of the stream's time, over its last second; None before the first sample."""
        if not self.stream_seconds:
            return None
        ages = [(self.gap.end - impact.seq) * self.gap.period - impact.offset for impact in self.impacts]
        window = min(1.0, self.stream_seconds)
        if len(ages) == KEPT_IMPACTS:
            window = min(window, max(ages[0], 1e-9))
        return sum(1 for age in ages if age <= window) / window

    def snapshot(self):
        """A copy that what comes later does not change."""
        copy = Feed()
        copy.__dict__.update(self.__dict__)
        copy.gap = Samples(self.gap.blocks)
        copy.drive = Samples(self.drive.blocks)
        copy.impacts = collections.deque(self.impacts, maxlen=KEPT_IMPACTS)
        copy.samples = Rate(self.samples.points)
        copy.stream_time = Rate(self.stream_time.points)
        copy.statuses = dict(self.statuses)
        return copy


def rising_crossings(samples, wanted):
    """Where the newest samples (Samples) last rose through the middle of their range: the numbers of the samples, with
    their fraction, in ascending order, about `wanted` of them if there are so many; noise of a tenth of the range makes
    none."""
    if not samples.size:
        return []
    length = 2048
    while True:
        values, first = samples.values(samples.end - length, samples.end)
        low, high = min(values), max(values)
        middle = 0.5 * (low + high)
        below, above = middle - 0.1 * (high - low), middle + 0.1 * (high - low)
        crossings = []
        armed = False
        last = None  # the last rise through the middle
        for i, value in enumerate(values):
            if value < below:
                armed = True
                last = None
            elif armed and value >= middle:
                if last is None:
                    before = values[i - 1]
                    last = first + i - 1 + ((middle - before) / (value - before) if value > before else 1.0)
                if value > above:
                    crossings.append(last)
                    armed = False
        if len(crossings) > wanted or length >= samples.size:
            return crossings if high > low else []
        length *= 2


def steady_frequency(crossings, period):
    """The frequency in Hz of a motion that rises through its middle at these numbers of samples of `period` s; None if
    there are fewer than three, or they are not evenly spaced."""
    if len(crossings) < 3:
        return None
    intervals = [b - a for a, b in zip(crossings, crossings[1:])]
    mean = (crossings[-1] - crossings[0]) / len(intervals)
    if max(abs(interval - mean) for interval in intervals) > 0.05 * mean + 0.1:
        return None
    return 1.0 / (mean * period)
