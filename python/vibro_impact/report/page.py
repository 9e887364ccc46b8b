"""The page: one HTML file that holds its data, its styles and its scripts, and asks for nothing else."""

import html
import json
import os
import re

FOLDER = os.path.dirname(os.path.realpath(__file__))
PLOTLY = os.path.join("assets", "plotly-cartesian.min.js")
PLOTLY_LICENCE = os.path.join("assets", "plotly.LICENSE")


def text_of(name):
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        return file.read()


def in_script(value):
    """JSON that no text in it can end the script element with; numbers that are not finite are null."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def plotly_version():
    return re.search(r"\(cartesian - minified\) v([0-9.]+)", text_of(PLOTLY)[:400]).group(1)


def plotly_licence():
    """The notice that every copy of plotly.js must have with it, as the page does."""
    notice = html.escape(text_of(PLOTLY_LICENCE))
    return "<details><summary>Licence of plotly.js</summary><pre>%s</pre></details>" % notice


def table(rows, header=()):
    """Rows of text; numbers (int, float) stand to the right."""
    lines = ["<table>"]
    if header:
        lines.append(
            "<thead><tr>%s</tr></thead>" % "".join("<th scope='col'>%s</th>" % html.escape(cell) for cell in header)
        )
    for row in rows:
        cells = []
        for number, cell in enumerate(row):
            if number == 0 and not header:
                cells.append("<th scope='row'>%s</th>" % html.escape(cell))
            elif isinstance(cell, (int, float)):
                cells.append("<td class='number'>%s</td>" % ("%d" % cell if isinstance(cell, int) else "%.6g" % cell))
            else:
                cells.append("<td>%s</td>" % html.escape(cell))
        lines.append("<tr>%s</tr>" % "".join(cells))
    return "\n".join(lines + ["</table>"])


def figure(key, title, caption, height):
    return (
        "<figure data-chart='%s' data-height='%d'><h3>%s</h3><div class='tools'></div><div class='plot'></div>"
        "<figcaption>%s</figcaption></figure>" % (key, height, title, caption)
    )


class Page:
    """Collects sections and charts."""

    def __init__(self, title):
        self.title = title
        self.contents = []
        self.body = ["<h1>%s</h1>" % html.escape(title)]
        self.charts = {}
        self.data = {}

    def lead(self, text):
        self.body.append("<p class='lead'>%s</p>" % html.escape(text))

    def section(self, key, title, absent=False):
        self.contents.append((key, title, absent))
        self.body.append("<h2 id='%s'>%s</h2>" % (key, html.escape(title)))

    def left_out(self, key, title, reason):
        """A section that says why it is not there."""
        self.section(key, title, True)
        self.body.append("<p class='left-out'>Left out: %s</p>" % html.escape(reason))

    def put(self, markup):
        self.body.append(markup)

    def chart(self, chart):
        self.charts[chart.key] = chart.specification()
        self.body.append(figure(chart.key, chart.title, chart.caption, chart.height))

    def pairs(self, charts):
        self.body.append("<div class='pair'>")
        for chart in charts:
            self.chart(chart)
        self.body.append("</div>")

    def render(self, footer):
        contents = "".join(
            "<li%s><a href='#%s'>%s</a></li>"
            % (" class='absent'" if absent else "", key, html.escape(title) + (" (left out)" if absent else ""))
            for key, title, absent in self.contents
        )
        parts = {
            "title": html.escape(self.title),
            "style": text_of("page.css"),
            "contents": contents,
            "body": "\n".join(self.body),
            "footer": footer,
            "data": in_script(dict(self.data, charts=self.charts)),
            "plotly": text_of(PLOTLY),
            "script": text_of("page.js"),
        }
        return re.sub("@([a-z]+)@", lambda found: parts[found.group(1)], text_of("page.html"))
