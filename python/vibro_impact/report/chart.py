"""What a chart of the page is made of, in the words of plotly.js: traces, axes, the table behind it."""

import numpy as np

from vibro_impact.report.packing import packed

# Okabe and Ito's colours: told apart by the colour-blind; markers and dashes differ as well, for paper.
BLUE, VERMILION, GREEN, ORANGE, SKY, PURPLE, BLACK = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#E69F00",
    "#56B4E9",
    "#CC79A7",
    "#000000",
)
GREY = "#767676"


class Chart:
    """A chart: `key` (its name in the page and in the files saved), `title`, `caption` (HTML: what is shown, how it was
    got).

    Arrays are put in once by name; traces refer to them with ref(), the table behind the CSV button by its headers. """

    def __init__(self, key, title, caption, height=420):
        self.key = key
        self.title = title
        self.caption = caption
        self.height = height
        self.arrays = {}
        self.traces = []
        self.table = []
        self.layout = {}
        self.logarithmic = ""  # the axis for which the page offers a logarithmic scale, such as yaxis
        self.extra = {}

    def put(self, name, values, kind="f8"):
        self.arrays[name] = values if isinstance(values, dict) else packed(values, kind)

    def column(self, header, name, values, kind="f8"):
        """An array that is in the table as well, under a header such as gap_m."""
        self.put(name, values, kind)
        self.table.append([header, name])

    def axes(self, x, y, **more):
        """Titles, with units, of the two axes; `more`: further settings as x_type="log", y_range=[0, 1]."""
        for name, title in (("x", x), ("y", y)):
            settings = {"title": {"text": title}}
            settings.update({key[2:]: value for key, value in more.items() if key.startswith(name + "_")})
            self.layout[name + "axis"] = settings

    def specification(self):
        return dict(
            self.extra,
            key=self.key,
            title=self.title,
            height=self.height,
            arrays=self.arrays,
            traces=self.traces,
            table=self.table,
            layout=self.layout,
            logarithmic=self.logarithmic,
        )


def outline(x, low, high):
    """(x, y) of the outlines of a band between two lines, one closed by itself for each run of points at which both are
    known: along the low line and back along the high one, with NaN behind it. For fill="toself"; that of plotly.js from
    one line to another, "tonexty", goes straight across where both are unknown."""
    known = np.isfinite(low) & np.isfinite(high)
    edges = np.flatnonzero(np.diff(np.concatenate(([False], known, [False])).astype(int)))
    pieces_x, pieces_y = [np.empty(0)], [np.empty(0)]
    for begin, end in zip(edges[::2], edges[1::2]):
        along = slice(begin, end)
        pieces_x += [x[along], x[along][::-1], x[begin : begin + 1], [np.nan]]
        pieces_y += [low[along], high[along][::-1], low[begin : begin + 1], [np.nan]]
    return np.concatenate(pieces_x), np.concatenate(pieces_y)


def ref(name, factor=1.0):
    """The array of this name, times a factor, in a trace."""
    return {"array": name, "factor": factor}


def points(x, y, name, colour, symbol, size=5.0, hover="%{x:.5g}, %{y:.4g}", **more):
    """A trace of open markers."""
    marker = {"symbol": symbol, "size": size, "color": colour, "line": {"width": 1, "color": colour}}
    return dict(
        {
            "type": "scatter",
            "mode": "markers",
            "x": x,
            "y": y,
            "name": name,
            "marker": marker,
            "hovertemplate": hover + "<extra></extra>",
        },
        **more,
    )


def band(x, y, name, colour, fill, width=0.7, **more):
    """A trace of an outline()."""
    return line(x, y, name, colour, "solid", width, fill="toself", fillcolor=fill, hoveron="points", **more)


def line(x, y, name, colour, dash="solid", width=1.5, hover="%{x:.5g}, %{y:.4g}", **more):
    """A trace of a line."""
    return dict(
        {
            "type": "scatter",
            "mode": "lines",
            "x": x,
            "y": y,
            "name": name,
            "line": {"color": colour, "dash": dash, "width": width},
            "hovertemplate": hover + "<extra></extra>",
        },
        **more,
    )
