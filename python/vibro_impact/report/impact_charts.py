"""Charts of all impacts of a recording."""

import numpy as np

from vibro_impact.report import chart as charts
from vibro_impact.report.packing import prefix

MOST_BINS = 80

# field of an impact, words, unit, colour
QUANTITIES = (
    ("impulse", "impulse", "N s", charts.BLUE),
    ("duration", "duration", "s", charts.VERMILION),
    ("peak_force", "peak force", "N", charts.GREEN),
    ("approach_speed", "approach speed", "m/s", charts.PURPLE),
)


def bins(values):
    """(counts, edges) of bins by the rule of Freedman and Diaconis, at least ten and at most MOST_BINS."""
    low, high = float(np.min(values)), float(np.max(values))
    if not high > low:
        margin = 0.5 * abs(low) or 0.5
        return np.histogram(values, 11, (low - margin, high + margin))
    first, third = np.percentile(values, (25, 75))
    width = 2.0 * (third - first) / len(values) ** (1.0 / 3.0)
    number = MOST_BINS if not width > 0.0 else int(np.clip(np.ceil((high - low) / width), 10, MOST_BINS))
    return np.histogram(values, number, (low, high))


def histograms(impacts):
    """One chart for each quantity."""
    made = []
    for field, words, unit, colour in QUANTITIES:
        values = np.asarray(impacts[field], dtype=float)
        counts, edges = bins(values)
        factor, scale = prefix(float(np.max(np.abs(values))))
        mean, deviation = float(np.mean(values)), float(np.std(values))
        chart = charts.Chart(
            "histogram_" + field,
            words.capitalize(),
            "%d whole impacts: mean %.4g, standard deviation %.3g, greatest %.4g %s."
            % (len(values), factor * mean, factor * deviation, factor * float(np.max(values)), scale + unit),
            300,
        )
        chart.column("from_" + unit.replace(" ", "_").replace("/", "_per_"), "from", edges[:-1])
        chart.column("to_" + unit.replace(" ", "_").replace("/", "_per_"), "to", edges[1:])
        chart.column("impacts", "counts", counts, "i4")
        chart.put("middle", 0.5 * (edges[:-1] + edges[1:]))
        chart.traces.append(
            {
                "type": "bar",
                "x": charts.ref("middle", factor),
                "y": charts.ref("counts"),
                "width": factor * float(edges[1] - edges[0]),
                "marker": {"color": colour, "line": {"color": "#ffffff", "width": 0.5}},
                "hovertemplate": "%{x:.4g} " + scale + unit + ": %{y} impacts<extra></extra>",
                "showlegend": False,
            }
        )
        chart.axes("%s (%s)" % (words, scale + unit), "impacts (1)")
        chart.logarithmic = "yaxis"
        made.append(chart)
    return made


def over_time(recording):
    """The whole recording at a glance: extremes of drive, gap and force in each of some hundred stretches."""
    columns = 1500
    samples = len(recording.gap)
    starts = np.unique(np.linspace(0, samples, min(columns, samples) + 1).astype(int)[:-1])
    chart = charts.Chart(
        "overview",
        "The whole recording",
        "Least and greatest value in each of %d equal parts of the recording, so that no peak is missed. Where nothing"
        " is drawn, samples are lost."
        % len(starts),
        560,
    )
    chart.column("from_s", "time", starts * recording.sample_period)
    rows = (
        ("acceleration", recording.acceleration, "m/s\u00b2", "m_per_s2", "base acceleration", charts.GREY, "y3"),
        ("gap", recording.gap, "m", "m", "gap", charts.BLUE, "y2"),
        ("force", recording.contact_force, "N", "N", "contact force", charts.VERMILION, "y"),
    )
    domains = {"y3": [0.71, 1.0], "y2": [0.355, 0.645], "y": [0.0, 0.29]}
    chart.layout["xaxis"] = {"title": {"text": "time since the first sample (s)"}, "anchor": "y"}
    for name, values, unit, header, words, colour, axis in rows:
        low = np.fmin.reduceat(values, starts)
        high = np.fmax.reduceat(values, starts)
        factor, scale = (
            (1.0, "")
            if name == "acceleration"
            else prefix(float(np.nanmax(np.abs((low, high))))) if np.isfinite(high).any() else (1.0, "")
        )
        chart.column("least_%s_%s" % (name, header), name + "_low", low, "f4")
        chart.column("greatest_%s_%s" % (name, header), name + "_high", high, "f4")
        outline = charts.outline(starts * recording.sample_period, low, high)
        chart.put(name + "_outline_time", outline[0])
        chart.put(name + "_outline", outline[1], "f4")
        chart.traces.append(
            charts.band(
                charts.ref(name + "_outline_time"),
                charts.ref(name + "_outline", factor),
                words,
                colour,
                colour,
                hover="%{x:.5g} s: " + words + " %{y:.4g} " + scale + unit,
                yaxis=axis,
                showlegend=False,
            )
        )
        chart.layout["yaxis" + axis[1:]] = {
            "title": {"text": "%s<br>(%s)" % (words.replace("base ", "base<br>"), scale + unit)},
            "domain": domains[axis],
        }
    return chart
