"""Charts in the frequency domain: waterfalls and, for a random drive, frequency-response functions."""

import numpy as np

from vibro_impact.report import chart as charts
from vibro_impact.report import spectra
from vibro_impact.report.packing import quantised

COLUMNS = 500
ROWS = 320
# A waterfall of steps reaches up to so many times the highest drive frequency.
HARMONICS = 10.0
DYNAMIC_RANGE = 100.0  # dB below the greatest level
MOST_LINES = 20000
SHORTEST = 64  # samples of a segment of a waterfall


def waterfall(values, sample_period, steps, quantity, words, unit):
    """(a spectrogram of `values` over the whole recording, ""), or (None, why there is none); `steps`: segments of the
    drive that have a frequency."""
    length = 4096
    while length > SHORTEST and 8 * length > len(values):
        length //= 2
    if len(values) < length:
        return None, "the recording has %d samples, a segment of a spectrum takes %d" % (len(values), length)
    if not np.isfinite(values).any():
        return None, "every sample of the %s is lost" % words
    # What does not move has no spectrum but that of rounding.
    if np.fmax.reduce(values) == np.fmin.reduce(values):
        return None, "the %s never moves" % words
    times, frequency, amplitude = spectra.spectrogram(values, sample_period, COLUMNS, length)
    if not np.nanmax(amplitude[1:], initial=0.0) > 0.0:
        return None, "there is no stretch of %d samples in which the %s is without a loss and moves" % (length, words)
    with np.errstate(divide="ignore"):
        level = 20.0 * np.log10(amplitude)
    highest = float(np.nanmax(level[1:]))
    level = np.where(np.isfinite(amplitude), np.maximum(level, highest - DYNAMIC_RANGE), np.nan)
    # Up to the frequency above which nothing is within the range that is shown.
    heard = np.flatnonzero(np.nanmax(level, axis=1) > highest - 0.7 * DYNAMIC_RANGE)
    top = min(len(frequency), max(16, int(1.1 * heard[-1]) + 1))
    if steps:
        reach = HARMONICS * max(segment.frequency for segment in steps)
        top = min(top, max(16, int(np.searchsorted(frequency, reach))))
    frequency, level = frequency[1:top], level[1:top]
    merged = -(-len(frequency) // ROWS)
    starts = np.arange(0, len(frequency), merged)
    level = np.fmax.reduceat(level, starts, axis=0)
    frequency = np.add.reduceat(frequency, starts) / np.diff(np.append(starts, len(frequency)))
    stored = quantised(level, "u1")
    chart = charts.Chart(
        "waterfall_" + quantity,
        "Waterfall of the " + words,
        "Amplitude of the %s over time and frequency, in dB re 1 %s: root mean square of the amplitude spectra of %d"
        " samples (%.4g ms, Hann window, %.4g Hz apart%s) in each column of %.4g s; levels down to %d dB below the"
        " greatest one, in steps of %.2g dB.%s"
        % (
            words,
            unit,
            length,
            1e3 * length * sample_period,
            1.0 / (length * sample_period),
            "" if merged == 1 else "; each row is the greatest of %d lines" % merged,
            times[1] - times[0] if len(times) > 1 else len(values) * sample_period,
            DYNAMIC_RANGE,
            stored["s"],
            " Dashed: frequency of the drive." if steps else "",
        ),
        440,
    )
    chart.put("time", times)
    chart.put("frequency", frequency)
    chart.put("level", stored)
    chart.traces.append(
        {
            "type": "heatmap",
            "x": charts.ref("time"),
            "y": charts.ref("frequency"),
            "z": {"array": "level", "rows": len(frequency)},
            "colorscale": "Cividis",
            "colorbar": {"title": {"text": "dB re 1 " + unit, "side": "right"}, "thickness": 14, "outlinewidth": 0},
            "hovertemplate": "%{x:.4g} s, %{y:.5g} Hz: %{z:.1f} dB<extra></extra>",
        }
    )
    if steps:
        chart.put("drive_time", np.array([time for s in steps for time in (s.first, s.last)]) * sample_period)
        chart.put("drive_frequency", np.repeat([s.frequency for s in steps], 2))
        # Black on white is seen on every colour of the scale, the bright ridge of the drive included.
        for colour, dash, width in (("#ffffff", "solid", 3.0), (charts.BLACK, "dash", 1.5)):
            chart.traces.append(
                charts.line(
                    charts.ref("drive_time"),
                    charts.ref("drive_frequency"),
                    "drive",
                    colour,
                    dash,
                    width,
                    "drive: %{y:.5g} Hz",
                    showlegend=False,
                )
            )
    chart.extra["matrix"] = ["frequency_Hz", "frequency", "time", "level"]
    chart.axes("time since the first sample (s)", "frequency (Hz)")
    chart.layout["yaxis"]["range"] = [0.0, float(frequency[-1])]
    chart.logarithmic = "yaxis"
    return chart, ""


def band(estimate):
    """The lines in which there is a drive: within 60 dB of its greatest density, at most MOST_LINES from the lowest
    on."""
    density = estimate.auto_excitation
    driven = np.flatnonzero(density > 1e-6 * density.max())
    return slice(driven[0], min(driven[-1] + 1, driven[0] + MOST_LINES))


def excitation_density(estimate):
    chart = charts.Chart(
        "excitation_density",
        "Power spectral density of the base acceleration",
        "One-sided, from the same segments as the frequency-response functions below.",
        300,
    )
    shown = band(estimate)
    chart.column("frequency_Hz", "frequency", estimate.frequency[shown])
    chart.column("density_m2_per_s4_per_Hz", "density", estimate.auto_excitation[shown])
    chart.traces.append(
        charts.line(
            charts.ref("frequency"),
            charts.ref("density"),
            "density",
            charts.BLUE,
            width=1.0,
            hover="%{x:.5g} Hz: %{y:.4g} (m/s\u00b2)\u00b2/Hz",
            showlegend=False,
        )
    )
    chart.axes("frequency (Hz)", "density ((m/s\u00b2)\u00b2/Hz)", x_type="log", y_type="log")
    return chart


def agreement(estimate, closed_form):
    """(lines, greatest deviation relative, and in degrees) of H1 from the closed form where the coherence exceeds
    0.99."""
    shown = band(estimate)
    coherent = estimate.coherence[shown] > 0.99
    ratio = estimate.h1[shown][coherent] / closed_form[shown][coherent]
    if len(ratio) == 0:
        return 0, 0.0, 0.0
    return len(ratio), float(np.max(np.abs(np.abs(ratio) - 1.0))), float(np.max(np.abs(np.degrees(np.angle(ratio)))))


def frequency_response(estimate, quantity, words, unit, closed_form=None, closed_words=""):
    """Magnitude, phase and coherence of a response per base acceleration; `closed_form`: what to draw along, at the
    lines of the estimate."""
    shown = band(estimate)
    frequency = estimate.frequency[shown]
    h1, h2, coherence = estimate.h1[shown], estimate.h2[shown], estimate.coherence[shown]
    error = spectra.random_error(coherence, estimate.averages)
    caption = (
        "H<sub>1</sub> = G<sub>xy</sub>/G<sub>xx</sub>, H<sub>2</sub> = G<sub>yy</sub>/G<sub>yx</sub> and the coherence"
        " \u03b3\u00b2 of the %s (response y) and the base acceleration (excitation x), by Welch's method: Hann window"
        " (ISO 18431-2), %d segments of %d samples overlapping by 50 %%, worth %.1f independent averages, resolution"
        " %.4g Hz, each segment without its mean. Shaded: H<sub>1</sub> \u00b1 1.96 times its random error, \u221a(1"
        " \u2212 \u03b3\u00b2)/(|\u03b3| \u221a(2 <i>n</i><sub>d</sub>)), Bendat and Piersol, table 9.6. A response"
        " that lags has a negative phase (ISO 7626-1). "
        % (words, estimate.segments, estimate.length, estimate.averages, estimate.resolution)
    )
    if frequency[-1] < estimate.frequency[-1] and len(frequency) == MOST_LINES:
        caption += "Lines above %.5g Hz are left out; a coarser --resolution shows them. " % frequency[-1]
    chart = charts.Chart("frf_" + quantity, "%s per base acceleration" % words.capitalize(), caption, 760)
    chart.column("frequency_Hz", "frequency", frequency)
    per = unit + "/(m/s\u00b2)"
    closed = None
    if closed_form is not None:
        closed = closed_form[shown]
        lines, magnitude, angle = agreement(estimate, closed_form)
        chart.caption += (
            "Dotted: the closed form of the linear run, %s, <i>H</i> = \u2212\u03a3"
            " <i>b</i><sub>n</sub>\u0393<sub>n</sub>/(\u03c9<sub>n</sub>\u00b2 \u2212 \u03c9\u00b2 +"
            " 2i\u03b6\u03c9<sub>n</sub>\u03c9), for a drive that is linear between its samples. " % closed_words
        )
        if lines:
            chart.caption += (
                "Where the coherence exceeds 0.99, at %d lines, H<sub>1</sub> is within %.2g %% and %.2g\u00b0 of it."
                % (
                    lines,
                    100.0 * magnitude,
                    angle,
                )
            )
    estimates = [
        ("h1", h1, "H<sub>1</sub>", charts.BLUE, "solid", 1.6),
        ("h2", h2, "H<sub>2</sub>", charts.VERMILION, "dash", 1.2),
    ]
    if closed is not None:
        estimates.append(("closed_form", closed, "closed form", charts.BLACK, "dot", 1.8))
    spread = 1.96 * error * np.abs(h1)
    low = np.maximum(np.abs(h1) - spread, 1e-3 * np.abs(h1))
    outline = charts.outline(frequency, low, np.abs(h1) + np.minimum(spread, 1e3 * np.abs(h1)))
    chart.put("band_frequency", outline[0])
    chart.put("band", outline[1], "f4")
    chart.traces.append(
        charts.band(
            charts.ref("band_frequency"),
            charts.ref("band"),
            "H<sub>1</sub> \u00b1 1.96 random errors",
            charts.SKY,
            "rgba(86,180,233,0.35)",
            0,
            yaxis="y3",
            hoverinfo="skip",
        )
    )
    for name, values, label, colour, dash, width in estimates:
        chart.column("%s_magnitude_%s_per_m_per_s2" % (name, unit), name + "_magnitude", np.abs(values), "f4")
        chart.column(name + "_phase_deg", name + "_phase", np.degrees(np.angle(values)), "f4")
        for axis, part, text in (("y3", "magnitude", per), ("y2", "phase", "\u00b0")):
            chart.traces.append(
                charts.line(
                    charts.ref("frequency"),
                    charts.ref(name + "_" + part),
                    label,
                    colour,
                    dash,
                    width,
                    "%{x:.5g} Hz: %{y:.4g} " + text,
                    yaxis=axis,
                    legendgroup=name,
                    showlegend=part == "magnitude",
                )
            )
    chart.column("coherence", "coherence", coherence, "f4")
    chart.column("random_error_of_h1", "random_error", error, "f4")
    chart.traces.append(
        charts.line(
            charts.ref("frequency"),
            charts.ref("coherence"),
            "coherence",
            charts.GREEN,
            "solid",
            1.2,
            "%{x:.5g} Hz: %{y:.5f}",
            showlegend=False,
        )
    )
    chart.layout["xaxis"] = {"title": {"text": "frequency (Hz)"}, "type": "log", "anchor": "y"}
    chart.layout["yaxis"] = {
        "title": {"text": "coherence \u03b3\u00b2 (1)"},
        "domain": [0.0, 0.2],
        "range": [0.0, 1.05],
    }
    chart.layout["yaxis2"] = {
        "title": {"text": "phase (\u00b0)"},
        "domain": [0.26, 0.52],
        "range": [-190, 190],
        "dtick": 90,
    }
    chart.layout["yaxis3"] = {"title": {"text": "magnitude (%s)" % per}, "domain": [0.58, 1.0], "type": "log"}
    chart.logarithmic = "xaxis"
    return chart
