"""The stretches of a recording among which a reader chooses: the steps of its drive, or equal parts where it has
none."""

import math
from collections import namedtuple

import numpy as np

# first, last: samples counted from the recording's first one, the last one not included; frequency in Hz, omega_star
# and acceleration are None where there is no step; direction: 1 up, -1 down, 0 unknown; period in cycles
Segment = namedtuple("Segment", "first last frequency omega_star acceleration direction period")

# Drive cycles at the end of a step that the stroboscopic diagram shows.
STROBOSCOPIC_CYCLES = 64
EQUAL_PARTS = 40


def directions(frequencies):
    """For each step of a drive 1 where its frequency is higher than that of the step before, -1 where it is lower; what
    stays is as what came before it, and the first step is as the second; 0 where nothing ever changes."""
    signs = np.sign(np.diff(np.asarray(frequencies, dtype=float)))
    result = np.zeros(len(frequencies), dtype=int)
    known = 0
    for i, sign in enumerate(signs):
        if sign != 0:
            known = int(sign)
        result[i + 1] = known
    changed = np.flatnonzero(result)
    if len(changed):
        result[: changed[0]] = result[changed[0]]
    return result


def of_steps(steps, responses, recording):
    """A segment of each step that was evaluated; `steps`: (start, end) of each in s from sample 0 of the stream."""
    signs = directions(responses["frequency_hz"])

    def sample(time):
        return min(max(0, int(round(time / recording.sample_period)) - recording.first), len(recording.gap))

    return [
        Segment(
            sample(start),
            sample(end),
            float(row["frequency_hz"]),
            float(row["omega_star"]),
            float(row["acceleration"]),
            int(sign),
            int(row["period"]),
        )
        for (start, end), row, sign in zip(steps, responses, signs)
    ]


def equal_parts(recording):
    """Parts of equal length, at least a thousand samples each."""
    samples = len(recording.gap)
    parts = max(1, min(EQUAL_PARTS, samples // 1000))
    ends = np.linspace(0, samples, parts + 1).astype(int)
    return [Segment(int(a), int(b), None, None, None, 0, 0) for a, b in zip(ends[:-1], ends[1:])]


def drive_phase(acceleration, sample_period, frequency):
    """Phase in rad at the first sample of `acceleration`, of a sin(2 pi f t + phase) fitted to it with its mean
    (three-parameter fit of IEEE Std 1057)."""
    angle = 2.0 * math.pi * frequency * sample_period * np.arange(len(acceleration))
    columns = np.column_stack((np.sin(angle), np.cos(angle), np.ones(len(angle))))
    sine, cosine, _ = np.linalg.lstsq(columns, acceleration, rcond=None)[0]
    return math.atan2(cosine, sine)


def interpolate(samples, position):
    """`samples` at fractional numbers `position`, by the cubic through the two samples on either side."""
    whole = np.clip(np.floor(position).astype(int), 1, len(samples) - 3)
    s = position - whole
    a, b, c, d = (samples[whole + i] for i in (-1, 0, 1, 2))
    return (
        -s * (s - 1.0) * (s - 2.0) / 6.0 * a
        + (s + 1.0) * (s - 1.0) * (s - 2.0) / 2.0 * b
        - (s + 1.0) * s * (s - 2.0) / 2.0 * c
        + (s + 1.0) * s * (s - 1.0) / 6.0 * d
    )


def stroboscopic_points(segment, recording):
    """The gap, in m, at the instants at which the base acceleration rises through its mean, over the last cycles of a
    step, at most STROBOSCOPIC_CYCLES and half of the step; half a cycle at its very end is left out, where the next may
    have begun. """
    per_cycle = 1.0 / (segment.frequency * recording.sample_period)
    cycles = (segment.last - segment.first) / per_cycle
    kept = min(STROBOSCOPIC_CYCLES, int(cycles / 2.0))
    if kept < 1 or per_cycle < 4.0:
        return np.empty(0)
    last = segment.last - int(per_cycle / 2.0)
    first = max(segment.first, last - int((kept + 1) * per_cycle))
    acceleration = recording.acceleration[first:last]
    gap = recording.gap[first:last]
    if not np.isfinite(acceleration).all() or len(gap) < 8:
        return np.empty(0)
    phase = drive_phase(acceleration, recording.sample_period, segment.frequency)
    position = (np.arange(kept + 2) - phase / (2.0 * math.pi)) * per_cycle
    position = position[(position >= 1.0) & (position <= len(gap) - 3)][-kept:]
    points = interpolate(gap, position)
    return points[np.isfinite(points)]
