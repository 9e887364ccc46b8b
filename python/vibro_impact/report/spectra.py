"""Spectra of recorded signals: frequency-response functions by Welch's method, amplitude spectra, spectrograms.

Fourier transforms count e^(+i omega t), so that a response that lags its excitation has a negative phase (ISO 7626-1).
"""

from collections import namedtuple

import numpy as np

# Segments that are transformed at a time: enough for speed, few enough for memory.
BATCH_SAMPLES = 1 << 21

# frequency in Hz; auto_excitation, auto_response: one-sided spectral densities; h1, h2: complex; coherence in 0 to 1;
# segments: how many were averaged; averages: how many independent ones these are worth; length in samples
FrequencyResponse = namedtuple(
    "FrequencyResponse",
    "frequency auto_excitation auto_response h1 h2 coherence segments averages length resolution sample_period",
)

# lines: how many share the power of a segment, as the median over the loud ones; duration of a segment, s; loud: share
# of the segments that are not silent
SpectralLines = namedtuple("SpectralLines", "lines duration loud")
# Lines of a band that a segment shall have, by which it is judged whether a signal is random.
BAND_LINES = 96.0
# Shortest segment that is transformed, samples.
LEAST_SEGMENT = 16
# A segment is silent below this share of the mean power of all.
LOUD = 1e-3


def hann(length):
    """The Hann window as a period of a Fourier analysis (ISO 18431-2)."""
    return 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length)


def independent_averages(segments, window):
    """What `segments` that overlap by half are worth as independent averages (P. D. Welch, IEEE Trans. Audio
    Electroacoust. 15 (1967) 70): K/(1 + 2 (K - 1)/K rho), rho the squared correlation of the window with itself, half a
    segment later; 1/36 for a Hann window."""
    half = len(window) // 2
    correlation = float(np.dot(window[:-half], window[half:]) / np.dot(window, window)) ** 2
    return segments / (1.0 + 2.0 * correlation * (segments - 1) / segments)


def whole_segments(signals, length):
    """Numbers of the first samples of the segments, overlapping by half, in which every one of `signals` is known."""
    starts = np.arange(0, len(signals[0]) - length + 1, length // 2)
    lost = np.zeros(len(signals[0]) + 1, dtype=np.int64)
    for signal in signals:
        lost[1:] += ~np.isfinite(signal)
    lost = np.cumsum(lost)
    return starts[lost[starts + length] == lost[starts]]


def frequency_response(excitation, response, sample_period, length):
    """Estimates H1 = G_xy/G_xx, H2 = G_yy/G_yx and the coherence |G_xy|^2/(G_xx G_yy) (Bendat and Piersol, Random Data,
    4th ed., ch. 6) from segments of `length` samples (even) with a Hann window, half overlapping, each without its
    mean. Segments with a lost sample (NaN) are left out. None where fewer than two are whole: the coherence of one
    alone is 1, whatever it holds."""
    window = hann(length)
    starts = whole_segments((excitation, response), length) if length <= len(response) else ()
    if len(starts) < 2:
        return None
    lines = length // 2 + 1
    auto_x = np.zeros(lines)
    auto_y = np.zeros(lines)
    cross = np.zeros(lines, dtype=complex)
    batch = max(1, BATCH_SAMPLES // length)
    for at in range(0, len(starts), batch):
        rows = starts[at : at + batch, None] + np.arange(length)
        x = excitation[rows]
        y = response[rows]
        x = np.fft.rfft((x - x.mean(axis=1, keepdims=True)) * window)
        y = np.fft.rfft((y - y.mean(axis=1, keepdims=True)) * window)
        auto_x += np.sum(np.abs(x) ** 2, axis=0)
        auto_y += np.sum(np.abs(y) ** 2, axis=0)
        cross += np.sum(np.conj(x) * y, axis=0)
    density = 2.0 * sample_period / (np.dot(window, window) * len(starts))
    with np.errstate(divide="ignore", invalid="ignore"):
        h1 = cross / auto_x
        h2 = auto_y / np.conj(cross)
        coherence = np.abs(cross) ** 2 / (auto_x * auto_y)
    # The mean of every segment has been taken off, and with it what the window has put on the first line.
    known = slice(2, lines - 1)
    frequency = np.fft.rfftfreq(length, sample_period)
    return FrequencyResponse(
        frequency[known],
        density * auto_x[known],
        density * auto_y[known],
        h1[known],
        h2[known],
        coherence[known],
        len(starts),
        independent_averages(len(starts), window),
        length,
        1.0 / (length * sample_period),
        sample_period,
    )


def random_error(coherence, averages):
    """Normalised random error (standard deviation over value) of |H1|, and by its size in rad of the phase: Bendat and
    Piersol, table 9.6: sqrt(1 - gamma^2)/(|gamma| sqrt(2 n_d))."""
    squared = np.clip(coherence, 0.0, 1.0)
    with np.errstate(divide="ignore"):
        return np.sqrt(1.0 - squared) / np.sqrt(2.0 * averages * squared)


def segment_length(samples, sample_period, bandwidth):
    """Samples of a segment, a power of two: lines at most a sixteenth of `bandwidth` (Hz, the half-power bandwidth of
    the sharpest resonance) apart, further where fewer than 32 averages would be left.

    H1 is the response averaged over |W|^2 of the window, whose second moment is sigma^2 = df^2/3 for a Hann window and
    lines df apart. Close to a resonance the response is 1/(1 + i x) of its peak, x = 2 (f - f_n)/B_r, so that H1 at the
    peak is too small by the mean of x^2, (4/3)(df/B_r)^2, and so is the coherence: 0.5 % at a sixteenth."""
    wanted = 16.0 / (bandwidth * sample_period)
    most = samples / 17.5
    return 1 << max(6, int(np.floor(np.log2(min(2.0 ** np.ceil(np.log2(wanted)), most)))))


def amplitude_spectrum(signal, sample_period):
    """(frequency in Hz, amplitude): a sine of amplitude A at the middle of a line gives A there. Hann window."""
    window = hann(len(signal))
    spectrum = np.abs(np.fft.rfft((signal - signal.mean()) * window)) * 2.0 / window.sum()
    return np.fft.rfftfreq(len(signal), sample_period), spectrum


def largest_of_each(values, groups):
    """The greatest of each of at most `groups` equally long runs of `values`, and how many values make a run."""
    run = -(-len(values) // groups)
    starts = np.arange(0, len(values), run)
    return np.maximum.reduceat(values, starts), run


def spectrogram(signal, sample_period, columns, length):
    """(time, frequency, amplitude[frequency, time]): root mean square, over each of at most `columns` stretches of the
    signal, of the amplitude spectra of its segments of `length` samples with a Hann window; NaN where a stretch has no
    whole one. """
    window = hann(length)
    count = len(signal) // length
    # Half overlapping where the signal is short.
    hop = length if count >= 2 * columns else max(1, min(length // 2, (len(signal) - length) // max(1, columns)))
    starts = np.arange(0, len(signal) - length + 1, hop)
    per_column = -(-len(starts) // columns)
    power = []
    times = []
    scale = 2.0 / window.sum()
    for at in range(0, len(starts), per_column):
        chosen = starts[at : at + per_column]
        rows = signal[chosen[:, None] + np.arange(length)]
        rows = rows[np.isfinite(rows).all(axis=1)]
        times.append((chosen[0] + chosen[-1] + length) * 0.5 * sample_period)
        if len(rows) == 0:
            power.append(np.full(length // 2 + 1, np.nan))
            continue
        lines = np.fft.rfft((rows - rows.mean(axis=1, keepdims=True)) * window)
        power.append(np.mean(np.abs(lines) ** 2, axis=0))
    return np.array(times), np.fft.rfftfreq(length, sample_period), scale * np.sqrt(np.array(power).T)


def evenly(starts, most):
    """At most so many of them, evenly spread."""
    return starts[:: -(-len(starts) // most)] if len(starts) else starts


def powers(signal, length, most):
    """|X|^2 of the lines of segments of `length` samples, one after the other, at most `most`, evenly spread over those
    without a loss; with a Hann window, each without its mean."""
    window = hann(length)
    for start in evenly(whole_segments((signal,), length), most):
        samples = signal[start : start + length]
        yield np.abs(np.fft.rfft((samples - samples.mean()) * window)) ** 2


def participation(power):
    """How many lines share the power, (sum P)^2/sum P^2; 0 where there is none."""
    squares = float(np.sum(power**2))
    return float(np.sum(power)) ** 2 / squares if squares > 0.0 else 0.0


def spectral_lines(signal, sample_period):
    """How random a signal is, whatever its sample rate: SpectralLines, or None where there is no power or no stretch
    without a loss.

    A segment lasts long enough for a stationary noise of the signal's bandwidth to have about BAND_LINES lines in it,
    half of which share its power, as they scatter like chi-square; at most a sixteenth of the whole. A sine has two, a
    sweep few, as it goes through little of its band in a segment. Of a shock, which has many, most segments are silent.
    """
    longest = min(len(signal) // 16, 1 << 21)
    length = 2 * (min(longest, 1 << 17) // 2)
    while length >= LEAST_SEGMENT and len(whole_segments((signal,), length)) == 0:
        length = 2 * (length // 4)
    if length < LEAST_SEGMENT:
        return None
    lines = participation(sum(powers(signal, length, 64)))
    if lines == 0.0:
        return None
    bandwidth = lines / (length * sample_period)
    wanted = 2 * int(min(longest, max(LEAST_SEGMENT, BAND_LINES / (bandwidth * sample_period))) / 2)
    if len(whole_segments((signal,), wanted)):
        length = wanted
    found = np.array([(power.sum(), participation(power)) for power in powers(signal, length, 400)])
    loud = found[:, 0] > LOUD * found[:, 0].mean()
    if not loud.any():
        return None
    return SpectralLines(float(np.median(found[loud, 1])), length * sample_period, float(loud.mean()))
