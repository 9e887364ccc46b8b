"""Charts over the steps of the drive: the impulse response, the period map, the stroboscopic diagram."""

import numpy as np

from vibro_impact.report import chart as charts
from vibro_impact.report.packing import prefix
from vibro_impact.report.segments import stroboscopic_points

# Markers closer than this share of the axis are one to the eye.
DISTINCT = 1.0 / 1500.0
DRIVE = "drive frequency over the lowest free frequency, \u03c9* (1)"

# direction: (words, colour, marker). A cross and a circle are told apart without colour, and one on top of the other.
BRANCHES = {
    1: ("upwards", charts.BLUE, "circle-open"),
    -1: ("downwards", charts.VERMILION, "x-thin-open"),
    0: ("one frequency", charts.BLUE, "circle-open"),
}


def branches(runs):
    """(run's number, direction, label, colour, marker) of every branch there is, each told apart from all others."""
    found = []
    taken = set()
    for number, run in enumerate(runs):
        for direction in (1, -1, 0):
            if not any(segment.direction == direction for segment in run.segments):
                continue
            words, colour, marker = BRANCHES[direction]
            if colour in taken:
                colour, marker = next(
                    style
                    for style in ((charts.GREEN, "square-open"), (charts.PURPLE, "diamond-open"))
                    if style[0] not in taken
                )
            taken.add(colour)
            found.append((number, direction, "drive " + words + run.suffix, colour, marker))
    return found


def distinct(x, y):
    """Numbers of the points that are left when those that cover each other are drawn once."""
    span = np.ptp(y) if len(y) else 0.0
    height = np.rint((y - np.min(y)) / (span * DISTINCT)) if span > 0.0 else np.zeros(len(y))
    return np.sort(np.unique(np.column_stack((x, height)), axis=0, return_index=True)[1])


def scatter(chart, runs, x, y, factor, hover, size=6.0):
    """A trace for each branch of the points x[run], y[run] (lists of arrays, one a segment); the table has every
    point."""
    all_x, all_y, all_run, all_direction = [], [], [], []
    for number, direction, label, colour, marker in branches(runs):
        segments = [i for i, segment in enumerate(runs[number].segments) if segment.direction == direction]
        xs = np.concatenate([x[number][i] for i in segments])
        ys = np.concatenate([y[number][i] for i in segments])
        steps = np.concatenate([np.full(len(x[number][i]), i) for i in segments])
        all_x.append(xs)
        all_y.append(ys)
        all_run.append(np.full(len(xs), number + 1))
        all_direction.append(np.full(len(xs), direction))
        drawn = distinct(xs, ys)
        names = ["%s_%d_%d" % (axis, number, direction) for axis in "xys"]
        chart.put(names[0], xs[drawn])
        chart.put(names[1], ys[drawn])
        more = {}
        if number == 0:
            # A click on a point of the run itself chooses its step.
            chart.put(names[2], steps[drawn], "i4")
            more["customdata"] = charts.ref(names[2])
        chart.traces.append(
            charts.points(
                charts.ref(names[0]),
                charts.ref(names[1], factor),
                label,
                colour,
                marker,
                size=size,
                hover=hover,
                **more,
            )
        )
    # A single branch has its legend, too: it says the direction.
    chart.layout["showlegend"] = True
    return [np.concatenate(part) for part in (all_run, all_direction, all_x, all_y)]


def per_impact(runs, column):
    """For each run a list with the captured impacts' values of `column`, one array a step."""
    return [[impacts[column] for impacts in run.captured] for run in runs]


def impulse_response(runs):
    chart = charts.Chart(
        "impulse_response",
        "Every captured impact",
        (
            "Dimensionless impulse <i>I</i>* = <i>I</i> \u03c9<sub>11</sub>/(<i>k</i><sub>b</sub> <i>L</i><sub>1</sub>)"
            " of every captured impact: the last fifteen of each step of the drive. The direction is that in which the"
            " frequency of the drive was stepped. A click on a point chooses its step <a href='#step'>below</a>. Points"
            " that would cover each other are drawn once; the table has them all."
        ),
        480,
    )
    star = [[impacts["impulse"] * run.star for impacts in run.captured] for run in runs]
    where = [
        [np.full(len(values), segment.omega_star) for values, segment in zip(run_values, run.segments)]
        for run_values, run in zip(star, runs)
    ]
    run, direction, x, y = scatter(chart, runs, where, star, 1.0, "\u03c9* %{x:.4f}, <i>I</i>* %{y:.4g}")
    order = [(number, d) for number, d, *_ in branches(runs)]

    def collect(column):
        return np.concatenate(
            [
                values
                for number, d in order
                for values, s in zip(per_impact(runs, column)[number], runs[number].segments)
                if s.direction == d
            ]
        )

    chart.column("run", "run", run, "i4")
    chart.column("direction", "direction", direction, "i4")
    chart.column("omega_star", "omega_star", x)
    chart.column("impulse_star", "impulse_star", y)
    for header, column in (
        ("onset_s", "onset_s"),
        ("duration_s", "duration_s"),
        ("impulse_N_s", "impulse"),
        ("peak_force_N", "peak_force"),
    ):
        chart.column(header, column, collect(column))
    chart.axes(DRIVE, "dimensionless impulse <i>I</i>* (1)", y_rangemode="tozero")
    chart.logarithmic = "yaxis"
    return chart


def period_map(runs):
    chart = charts.Chart(
        "period_map",
        "Period of the response",
        (
            "Least number of drive cycles after which the impacts repeat, to 10<sup>-4</sup> of the greatest impulse"
            " and of a cycle; \u201cnone\u201d: no period up to 16 was found."
        ),
        360,
    )
    x = [[np.array([segment.omega_star]) for segment in run.segments] for run in runs]
    y = [[np.array([float(segment.period)]) for segment in run.segments] for run in runs]
    run, direction, omega, period = scatter(chart, runs, x, y, 1.0, "\u03c9* %{x:.4f}, period %{y}", size=7.0)
    chart.column("run", "run", run, "i4")
    chart.column("direction", "direction", direction, "i4")
    chart.column("omega_star", "omega_star", omega)
    chart.column("period_cycles", "period", period, "i4")
    most = int(period.max()) if len(period) else 1
    ticks = [tick for tick in (0, 1, 2, 3, 4, 6, 8, 10, 12, 14, 16) if tick <= max(most, 4)]
    chart.axes(
        DRIVE,
        "period (drive cycles)",
        y_tickvals=ticks,
        y_ticktext=["none"] + [str(tick) for tick in ticks[1:]],
        y_range=[-0.7, max(most, 4) + 0.7],
    )
    return chart


def stroboscopic(runs):
    values = [[stroboscopic_points(segment, run.recording) for segment in run.segments] for run in runs]
    largest = max((float(np.max(np.abs(part))) for run in values for part in run if len(part)), default=0.0)
    factor, unit = prefix(largest)
    chart = charts.Chart(
        "stroboscopic",
        "Gap at equal drive phase",
        (
            "The gap at equal phase of the drive: where the base acceleration rises through its mean, over the last 64"
            " drive cycles of each step (at most half of it), between samples by the cubic through four of them. A"
            " response that repeats every <i>p</i> cycles gives <i>p</i> points, one without a period a column of them."
            " Points that would cover each other are drawn once."
        ),
        480,
    )
    where = [
        [np.full(len(part), segment.omega_star) for part, segment in zip(run_values, run.segments)]
        for run_values, run in zip(values, runs)
    ]
    run, direction, x, y = scatter(
        chart, runs, where, values, factor, "\u03c9* %{x:.4f}, gap %{y:.4g} " + unit + "m", size=5.0
    )
    chart.column("run", "run", run, "i4")
    chart.column("direction", "direction", direction, "i4")
    chart.column("omega_star", "omega_star", x)
    chart.column("gap_m", "gap", y)
    chart.axes(DRIVE, "gap at equal drive phase (" + unit + "m)")
    return chart
