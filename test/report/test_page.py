#!/usr/bin/python3
"""The page in a headless Chromium: no complaint, no request, every chart drawn; zoom, choice of the step, downloads."""

import csv
import io
import os
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import numpy as np

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, HERE)
import recorded  # noqa: E402
from browser import Browser, may_lack_chromium, require_chromium  # noqa: E402

import vibro_impact  # noqa: E402

SCRIPT = os.path.join(HERE, "..", "..", "scripts", "report")
STEPS = [1.2, 1.6, 2.0, 2.6]
# What a chart must have drawn, of which there is at least so many.
MARKS = (
    ".plot .scatterlayer path.js-line, .plot .scatterlayer path.point, .plot .barlayer path, .plot .heatmaplayer image"
)


class Requirement(unittest.TestCase):
    def test_a_chromium_may_be_missing_on_ubuntu_20_04_alone(self):
        self.assertTrue(may_lack_chromium('NAME="Ubuntu"\nVERSION_ID="20.04"\nID=ubuntu\nID_LIKE=debian\n'))
        self.assertFalse(may_lack_chromium('NAME="Ubuntu"\nVERSION_ID="22.04"\nID=ubuntu\n'))
        self.assertFalse(may_lack_chromium('NAME="Debian GNU/Linux"\nVERSION_ID="12"\nID=debian\n'))
        self.assertFalse(may_lack_chromium(""))


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        require_chromium()
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        path = lambda name: os.path.join(cls.folder.name, name)  # noqa: E731
        drive = recorded.stepped_sine(STEPS, 40)
        back = recorded.stepped_sine(STEPS[::-1], 40)
        cls.bag = path("up.bag")
        recorded.write_bag(cls.bag, recorded.configuration(), drive)
        recorded.write_bag(path("down.bag"), recorded.configuration(), back)
        recorded.write_bag(path("linear.bag"), recorded.configuration(clearance=1e-2), recorded.random_drive(4.0))
        recorded.write_bag(path("random.bag"), recorded.configuration(clearance=2e-6), recorded.random_drive(4.0))
        # Forty parts of 15 000 samples: of the eleventh a piece of the gap is lost, of two others all of it.
        recorded.write_bag(
            path("lossy.bag"),
            recorded.configuration(clearance=1e-2),
            recorded.random_drive(12.0),
            lost_blocks=[302, 303, *range(600, 660)],
        )
        cls.stepped, cls.linear, cls.random = path("stepped.html"), path("linear.html"), path("random.html")
        cls.lossy = path("lossy.html")
        for arguments in (
            [cls.bag, "--with", path("down.bag"), "--out", cls.stepped],
            [path("linear.bag"), "--out", cls.linear],
            [path("random.bag"), "--out", cls.random],
            [path("lossy.bag"), "--out", cls.lossy],
        ):
            subprocess.run([SCRIPT, *arguments], check=True, stderr=subprocess.DEVNULL)
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def open(self, page):
        self.browser.open(page)
        self.assert_no_complaint()

    def assert_no_complaint(self):
        said, asked = self.browser.complaints()
        self.assertEqual((said, asked), ([], []))

    def value(self, script, *arguments):
        return self.browser.value(script, *arguments)

    def plot(self, key):
        """The element that plotly.js has drawn into."""
        return "document.querySelector(\"figure[data-chart='%s'] .plot\")" % key

    def assert_all_drawn(self, *charts):
        """These charts and all others of the page, each axis with a title that ends in a unit."""
        self.value("await window.vibroImpactReport.drawAll()")
        keys = self.value("window.vibroImpactReport.charts()")
        self.assertEqual(set(charts) - set(keys), set())
        for key in keys:
            marks = self.value(
                "[...document.querySelector(\"figure[data-chart='%s']\").querySelectorAll(given[0])].length" % key,
                MARKS,
            )
            self.assertGreater(marks, 0, key)
            titles = self.value(
                "Object.entries(%s._fullLayout).filter(([key]) => /^[xy]axis\\d*$/.test(key)).map(([, axis]) =>"
                " axis.title.text)"
                % self.plot(key)
            )
            self.assertGreaterEqual(len(titles), 2)
            for title in titles:
                self.assertRegex(title, r"\(.+\)$", key)
        self.assert_no_complaint()
        return keys

    def test_everything_of_a_stepped_sine_is_drawn(self):
        self.open(self.stepped)
        histograms = ["histogram_" + name for name in ("impulse", "duration", "peak_force", "approach_speed")]
        self.assert_all_drawn(
            "overview", "impulse_response", "period_map", "stroboscopic", "waterfall_gap", "waterfall_force",
            "step_time", "step_portrait", "step_spectrum", *histograms
        )  # fmt: skip
        # Both branches, told apart by colour and by marker.
        markers = self.value(
            self.plot("impulse_response")
            + ".data.map((trace) => [trace.name, trace.marker.color, trace.marker.symbol])"
        )
        self.assertEqual([name for name, _, _ in markers], ["drive upwards, first run", "drive downwards, second run"])
        self.assertEqual([len({marker[i] for marker in markers}) for i in (1, 2)], [2, 2])

    def test_the_drive_is_seen_on_every_colour_of_a_waterfall(self):
        self.open(self.stepped)
        self.value("await window.vibroImpactReport.draw('waterfall_gap')")
        lines = self.value(
            self.plot("waterfall_gap")
            + ".data.filter((t) => t.name === 'drive').map((t) => [t.line.color, t.line.dash, t.line.width])"
        )
        self.assertEqual([line[:2] for line in lines], [["#ffffff", "solid"], ["#000000", "dash"]])
        self.assertGreater(lines[0][2], lines[1][2])

    def test_everything_of_random_runs_is_drawn(self):
        self.open(self.linear)
        self.assert_all_drawn(
            "overview", "excitation_density", "frf_gap", "waterfall_gap", "step_time", "step_portrait", "step_spectrum"
        )
        names = self.value(self.plot("frf_gap") + ".data.map((trace) => trace.name)")
        self.assertIn("closed form", names)
        self.open(self.random)
        self.assert_all_drawn("excitation_density", "frf_gap", "frf_force", "histogram_impulse", "waterfall_force")
        self.assertNotIn("closed form", self.value(self.plot("frf_gap") + ".data.map((trace) => trace.name)"))

    def fill_at(self, key, time):
        """Pixels of the upright line at this time that the band of the gap fills, and the time of its first point."""
        return self.value(
            """(() => {
              const plot = %s, layout = plot._fullLayout, path = plot.querySelector(".xy2 .scatterlayer path.js-fill");
              const point = path.ownerSVGElement.createSVGPoint();
              point.x = layout.xaxis.d2p(given[0]);
              let filled = 0;
              for (point.y = 0; point.y < layout.yaxis2._length; ++point.y) filled += path.isPointInFill(point);
              return filled;
            })()"""
            % self.plot(key),
            time,
        )

    def test_no_band_is_filled_where_samples_are_lost(self):
        self.open(self.lossy)
        self.value("await window.vibroImpactReport.draw('overview')")
        for time in (5.9, 6.7):
            self.assertGreater(self.fill_at("overview", time), 10, time)
        for time in (6.05, 6.3, 6.55):
            self.assertEqual(self.fill_at("overview", time), 0, time)
        self.value("await window.vibroImpactReport.choose(10)")
        self.value(
            "[...document.querySelectorAll(\"figure[data-chart='step_time'] button\")].find((b) => b.textContent"
            " === 'Whole part').click()"
        )
        self.value("await window.vibroImpactReport.draw('step_time')")
        for times in ((3.002, 3.007, 3.012, 3.017), (3.042, 3.047, 3.052, 3.057)):
            self.assertGreater(sum(self.fill_at("step_time", time) for time in times), 4, times)
        for time in (3.022, 3.03, 3.038):
            self.assertEqual(self.fill_at("step_time", time), 0, time)
        self.assert_no_complaint()

    def test_a_part_without_a_spectrum_says_so_and_saves_none(self):
        self.open(self.lossy)
        remarks = "%s._fullLayout.annotations.map((a) => a.text).join()"
        disabled = (
            "[...document.querySelectorAll(\"figure[data-chart='%s'] button\")].filter((b) => b.disabled).length"
        )
        for part, gap_lost in ((10, False), (20, True), (12, False), (21, True)):
            self.value("await window.vibroImpactReport.choose(%d)" % part)
            self.value("await window.vibroImpactReport.draw('step_spectrum')")
            self.value("await window.vibroImpactReport.draw('step_portrait')")
            words = self.value(remarks % self.plot("step_spectrum"))
            self.assertIn("spectrum of the contact force left out: nothing moves", words)
            self.assertEqual("spectrum of the gap left out: samples are lost" in words, gap_lost)
            words = self.value(remarks % self.plot("step_portrait"))
            self.assertEqual("samples are lost" in words, gap_lost)
            for key in ("step_spectrum", "step_portrait"):
                self.assertEqual(self.value(disabled % key), 2 if gap_lost else 0, (part, key))
                text = self.value("await window.vibroImpactReport.csv(given[0])", key)
                self.assertEqual(len(text) == 0, gap_lost, (part, key))
            if not gap_lost:  # what there is takes the whole height
                domain = self.value(self.plot("step_spectrum") + "._fullLayout.yaxis2.domain")
                self.assertEqual(domain, [0, 1])
        self.assert_no_complaint()

    def test_charts_are_drawn_when_they_come_into_view(self):
        self.open(self.stepped)
        drawn = lambda key: self.value(
            "document.querySelector(\"figure[data-chart='%s']\").dataset.drawn || ''" % key
        )  # noqa: E731
        self.assertEqual(drawn("waterfall_force"), "")
        self.value("document.querySelector(\"figure[data-chart='waterfall_force']\").scrollIntoView()")
        self.browser.wait(lambda: drawn("waterfall_force"), "the chart in view")

    def test_another_step_can_be_chosen(self):
        self.open(self.stepped)
        self.value("document.getElementById('step').scrollIntoView()")
        self.value("await window.vibroImpactReport.choose(1)")
        recording = vibro_impact.read_bag(self.bag)
        for number in range(len(STEPS)):
            self.value(
                (
                    "(() => { const choice = document.getElementById('step-choice'); choice.value = given[0];"
                    " choice.dispatchEvent(new Event('change')); })()"
                ),
                str(number),
            )
            self.value("await window.vibroImpactReport.draw('step_time')")
            data = self.value(
                "(() => { const trace = %s.data.find((t) => t.name === 'gap: every sample'); return [trace.x, trace.y];"
                " })()"
                % self.plot("step_time")
            )
            unit = self.value("JSON.parse(document.getElementById('report-data').textContent).units.gap.factor")
            time, gap = np.array(data[0]), np.array(data[1]) / unit
            first = int(round(time[0] / recorded.PERIOD))
            np.testing.assert_allclose(gap, recording.gap[first : first + len(gap)], rtol=1e-6, atol=1e-12)
            # Of that step, and of no other.
            cycles = [40.0 / (omega * recorded.FREQUENCY) for omega in STEPS]
            self.assertGreater(time[0], sum(cycles[:number]) - 1e-3)
            self.assertLess(time[-1], sum(cycles[: number + 1]) + 1e-3)
        before = self.value("document.getElementById('step-choice').value")
        self.value("document.getElementById('step-back').click()")
        self.assertEqual(int(self.value("document.getElementById('step-choice').value")), int(before) - 1)
        self.assert_no_complaint()

    def test_a_click_on_a_point_chooses_its_step(self):
        self.open(self.stepped)
        self.value("await window.vibroImpactReport.draw('impulse_response')")
        self.value("%s.emit('plotly_click', {points: [{customdata: 3}]})" % self.plot("impulse_response"))
        self.assertEqual(self.value("document.getElementById('step-choice').value"), "3")
        steps = self.value(self.plot("impulse_response") + ".data[0].customdata")
        self.assertEqual(sorted(set(steps)), [0, 1, 2, 3])

    def test_zooms_by_mouse_and_by_key(self):
        self.open(self.stepped)
        self.value("await window.vibroImpactReport.draw('step_time')")
        plot = self.plot("step_time")
        limits = lambda: self.value(plot + "._fullLayout.xaxis.range")  # noqa: E731
        self.value(plot + ".scrollIntoView({block: 'center'})")
        before = limits()
        box = self.value(
            "(() => { const r = %s.querySelector('.nsewdrag').getBoundingClientRect(); return [r.x, r.y, r.width,"
            " r.height]; })()" % plot
        )
        x, y, width, height = box
        for kind, at, buttons in (
            ("mousePressed", 0.25, 1),
            ("mouseMoved", 0.5, 1),
            ("mouseMoved", 0.75, 1),
            ("mouseReleased", 0.75, 0),
        ):
            event = {
                "type": kind,
                "x": x + at * width,
                "y": y + 0.5 * height,
                "buttons": buttons,
                "button": "left",
                "clickCount": 1,
            }
            self.browser.driver.execute_cdp_cmd("Input.dispatchMouseEvent", event)
        self.browser.wait(lambda: limits() != before, "the zoom")
        now, span = limits(), before[1] - before[0]
        self.assertAlmostEqual((now[0] - before[0]) / span, 0.25, delta=0.02)
        self.assertAlmostEqual((now[1] - before[0]) / span, 0.75, delta=0.02)
        figure = "document.querySelector(\"figure[data-chart='step_time']\")"
        self.value(figure + ".focus()")
        self.value(figure + ".dispatchEvent(new KeyboardEvent('keydown', {key: '+', bubbles: true, cancelable: true}))")
        self.browser.wait(lambda: abs((limits()[1] - limits()[0]) / (now[1] - now[0]) - 0.5) < 1e-6, "the zoom by key")
        self.value("[...%s.querySelectorAll('button')].find((b) => b.textContent === 'Whole step').click()" % figure)
        self.value("await window.vibroImpactReport.draw('step_time')")
        self.browser.wait(lambda: limits()[1] - limits()[0] > 2.0 * span, "the whole step")
        self.assert_no_complaint()

    def download(self, key, button, name):
        self.value(
            "[...document.querySelectorAll(\"figure[data-chart='%s'] button\")].find((b) => b.textContent ==="
            " given[0]).click()" % key,
            button,
        )
        return self.browser.downloaded(name).decode("utf-8")

    def test_every_chart_is_saved_as_svg_and_its_data_as_csv(self):
        self.open(self.stepped)
        # By the buttons, a chart of every kind; the others by what the buttons call.
        names = {"impulse_response": "impulse_response", "waterfall_gap": "waterfall_gap", "step_time": "step_time_2"}
        for key in self.value("window.vibroImpactReport.charts()"):
            if key in names:
                text = self.download(key, "Save as SVG", names[key] + ".svg")
                table = self.download(key, "Save data as CSV", names[key] + ".csv")
            else:
                text = self.value("await window.vibroImpactReport.svg(given[0])", key)
                table = self.value("await window.vibroImpactReport.csv(given[0])", key)
            svg = xml.etree.ElementTree.fromstring(text)
            self.assertEqual(svg.tag, "{http://www.w3.org/2000/svg}svg")
            self.assertGreater(len(list(svg.iter())), 50, key)
            rows = list(csv.reader(io.StringIO(table)))
            self.assertGreater(len(rows), 1, key)
            self.assertEqual({len(row) for row in rows}, {len(rows[0])}, key)
            for row in rows[1:]:
                for cell in row:
                    self.assertTrue(cell == "" or np.isfinite(float(cell)), (key, cell))
        self.assert_no_complaint()

    def test_the_table_of_the_impulse_response_has_every_captured_impact(self):
        self.open(self.stepped)
        rows = list(csv.DictReader(io.StringIO(self.value("await window.vibroImpactReport.csv('impulse_response')"))))
        found = vibro_impact.extract_responses(self.bag)
        first = [row for row in rows if row["run"] == "1"]
        self.assertEqual(len(first), len(found.impacts))
        np.testing.assert_array_equal([float(row["impulse_N_s"]) for row in first], found.impacts["impulse"])
        np.testing.assert_allclose([float(row["omega_star"]) for row in first], found.impacts["omega_star"], rtol=1e-12)
        self.assertEqual({row["direction"] for row in first}, {"1"})
        self.assertEqual({row["direction"] for row in rows if row["run"] == "2"}, {"-1"})

    def test_a_logarithmic_axis_can_be_had(self):
        self.open(self.stepped)
        self.value("await window.vibroImpactReport.draw('impulse_response')")
        self.value(
            "[...document.querySelectorAll(\"figure[data-chart='impulse_response'] button\")].find((b) => b.textContent"
            " === 'Logarithmic y').click()"
        )
        self.browser.wait(
            lambda: self.value(self.plot("impulse_response") + "._fullLayout.yaxis.type") == "log",
            "the logarithmic axis",
        )
        self.assert_no_complaint()

    def test_the_chooser_hides_no_heading_and_stays_with_its_charts(self):
        self.open(self.stepped)
        self.value("await window.vibroImpactReport.drawAll()")
        chooser = "document.querySelector('.chooser').getBoundingClientRect()"
        for key in self.value("window.vibroImpactReport.charts()"):
            heading = "document.querySelector(\"figure[data-chart='%s'] h3\")" % key
            self.value(heading + ".parentElement.scrollIntoView()")
            hidden = self.value(
                "(() => { const box = %s.getBoundingClientRect(), over = document.elementFromPoint(box.left + 3,"
                " box.top + box.height / 2); return over !== %s; })()" % (heading, heading)
            )
            self.assertFalse(hidden, key)
            if key.startswith("step_"):
                self.assertGreaterEqual(self.value(chooser + ".top"), 0.0, key)
        for key in ("waterfall", "frf"):
            self.value("document.getElementById(given[0]).scrollIntoView()", key)
            top = self.value("document.getElementById(given[0]).getBoundingClientRect().top", key)
            self.assertLessEqual(self.value(chooser + ".bottom"), top)

    def test_nothing_in_the_page_leads_to_a_server(self):
        self.open(self.stepped)
        self.value(
            "await window.vibroImpactReport.draw('overview'), await window.vibroImpactReport.draw('waterfall_gap')"
        )
        titles = self.value("[...document.querySelectorAll('.modebar-btn')].map((b) => b.dataset.title)")
        self.assertGreater(len(titles), 10)
        for title in titles:
            self.assertNotRegex(title, re.compile("share|cloud|server|plotly", re.IGNORECASE))
        links = self.value("[...document.querySelectorAll('a')].map((a) => a.getAttribute('href'))")
        self.assertTrue(all(link.startswith("#") for link in links if link), links)
        # Were there a request, the browser would not let it out.
        answer = self.browser.run("await fetch('http://127.0.0.1:9/')")
        self.assertIn("error", answer)
        said, asked = self.browser.complaints()
        self.assertTrue(any("Content Security Policy" in line for line in said), said)

    def test_is_wide_enough_for_a_laptop_and_prints_without_its_buttons(self):
        self.open(self.stepped)
        self.assertLessEqual(self.value("document.documentElement.scrollWidth"), self.value("window.innerWidth"))
        self.browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        hidden = self.value(
            "[...document.querySelectorAll('nav, .tools')].every((e) => getComputedStyle(e).display === 'none')"
        )
        self.browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
        self.assertTrue(hidden)


if __name__ == "__main__":
    outcome = unittest.main(argv=[a for a in sys.argv if a not in recorded.WRITE_SIGNAL], exit=False).result
    # By this code ctest shows that a test was skipped.
    sys.exit(not outcome.wasSuccessful() or (77 if outcome.skipped else 0))
