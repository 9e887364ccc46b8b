"""What the page holds of every segment, so that a reader can choose one: extremes over the whole of it, every sample of
its end, and the spectra of its second half."""

import numpy as np

from vibro_impact.report import spectra
from vibro_impact.report.packing import packed, quantised

MOST_SEGMENTS = 1500
MOST_BINS = 1200
MOST_SAMPLES = 12000
MOST_LINES = 2000
# A spectrum of a step reaches up to so many times the frequency of its drive.
HARMONICS = 20.0
# Longest stretch that a spectrum is taken of, samples.
LONGEST = 1 << 17


def sizes(segments, budget):
    """(bins, samples, lines) for each of so many segments if all together shall take no more than `budget` characters:
    4 arrays of bins and 2 of samples by four bytes, 2 of lines by two, 4/3 characters a byte. A fifth is for the bins,
    a quarter for the lines. Compression comes on top, and is not counted on."""
    share = 0.75 * budget / max(1, segments) - 300.0
    return (
        int(np.clip(0.20 * share / 16.0, 16, MOST_BINS)),
        int(np.clip(0.55 * share / 8.0, 64, MOST_SAMPLES)),
        int(np.clip(0.25 * share / 4.0, 32, MOST_LINES)),
    )


def largest_factor(number):
    """The largest prime factor of a number, of which the time of its Fourier transform depends."""
    factor, largest = 2, 1
    while factor * factor <= number:
        while number % factor == 0:
            number //= factor
            largest = factor
        factor += 1
    return max(largest, number)


def quick_length(cycles, per_cycle):
    """Samples of so many drive cycles or up to a tenth fewer: the number that is transformed fastest."""
    fewest = max(1, int(0.9 * cycles))
    return min((int(round(count * per_cycle)) for count in range(cycles, fewest - 1, -1)), key=largest_factor)


def spectrum(values, segment, sample_period, lines, top):
    """(spacing in Hz, log10 of the amplitudes, lines merged) of the second half of a segment, whole drive cycles of it
    where there is a drive; up to `top` Hz. A text that says why where there is none."""
    half = values[segment.first + (segment.last - segment.first) // 2 : segment.last][-LONGEST:]
    if segment.frequency:
        per_cycle = 1.0 / (segment.frequency * sample_period)
        cycles = int(len(half) / per_cycle - 0.5)
        if cycles >= 1:
            end = len(half) - int(per_cycle / 2.0)
            half = half[end - quick_length(cycles, per_cycle) : end]
    if len(half) < 16:
        return "too few samples"
    if not np.isfinite(half).all():
        return "samples are lost"
    if half.min() == half.max():
        return "nothing moves"
    frequency, amplitude = spectra.amplitude_spectrum(half, sample_period)
    shown = max(2, int(np.searchsorted(frequency, top, side="right")))
    merged, run = spectra.largest_of_each(amplitude[1:shown], lines)
    floor = float(merged.max()) * 1e-9
    return float(frequency[1]), np.log10(np.maximum(merged, floor)), run


def of_segment(recording, segment, size, top):
    """What the page holds of one segment; times count from the recording's first sample."""
    bins, samples, lines = size
    period = recording.sample_period
    count = segment.last - segment.first
    width = -(-count // bins)
    starts = np.arange(0, count, width)
    gap = recording.gap[segment.first : segment.last]
    force = recording.contact_force[segment.first : segment.last]
    extremes = [reduce.reduceat(values, starts) for values in (gap, force) for reduce in (np.fmin, np.fmax)]
    end = segment.last - (int(0.5 / (segment.frequency * period)) if segment.frequency else 0)
    begin = max(segment.first, end - samples)
    data = {
        "bins": len(starts),
        "width": width,
        "extremes": packed(np.concatenate(extremes)),
        "begin": begin,
        "samples": end - begin,
        "end": packed(np.concatenate((recording.gap[begin:end], recording.contact_force[begin:end]))),
    }
    reach = min(HARMONICS * segment.frequency, 0.5 / period) if segment.frequency else top
    for name, values in (("gap_spectrum", recording.gap), ("force_spectrum", recording.contact_force)):
        found = spectrum(values, segment, period, lines, reach)
        if isinstance(found, str):
            data["no_" + name] = found
        else:
            data[name] = dict(quantised(found[1]), df=found[0], run=found[2])
    return data


def embedded(segments, chosen):
    """Numbers of the segments whose data the page holds: all, or MOST_SEGMENTS evenly spread over them and the one
    chosen."""
    if len(segments) <= MOST_SEGMENTS:
        return list(range(len(segments)))
    return sorted(set(np.linspace(0, len(segments) - 1, MOST_SEGMENTS - 1).astype(int).tolist()) | {chosen})
