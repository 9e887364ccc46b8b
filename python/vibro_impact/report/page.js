"use strict";
// Draws the charts of the page from the data in it, when they come into view; makes no request.
(() => {
  const report = JSON.parse(document.getElementById("report-data").textContent);
  const types = { f8: Float64Array, f4: Float32Array, i4: Int32Array, u2: Uint16Array, u1: Uint8Array };
  const chosenKeys = ["step_time", "step_portrait", "step_spectrum"];
  const charts = new Map();
  const unpacked = new WeakMap();
  let step = null;

  // ---- data

  // The numbers of a packed array: base64 of a deflated stream of bytes, those of equal significance side by side.
  async function inflate(packed) {
    const text = atob(packed.z);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const planes = new Uint8Array(await new Response(stream).arrayBuffer());
    const width = types[packed.t].BYTES_PER_ELEMENT;
    const ordered = new Uint8Array(planes.length);
    for (let plane = 0, at = 0; plane < width; ++plane) for (let i = 0; i < packed.n; ++i) ordered[i * width + plane] = planes[at++];
    const stored = new types[packed.t](ordered.buffer);
    if (packed.s === undefined) return stored;
    return Float64Array.from(stored, (value) => (value === packed.hole ? NaN : packed.b + packed.s * value));
  }

  function unpack(packed) {
    if (!unpacked.has(packed)) unpacked.set(packed, inflate(packed));
    return unpacked.get(packed);
  }

  function scaled(values, factor) {
    return Array.from(values, (value) => (Number.isFinite(value) ? value * factor : null));
  }

  async function filled(trace, arrays) {
    const result = {};
    for (const [key, value] of Object.entries(trace)) {
      if (value === null || typeof value !== "object" || !("array" in value)) {
        result[key] = value;
        continue;
      }
      const values = scaled(await unpack(arrays[value.array]), value.factor === undefined ? 1 : value.factor);
      result[key] = values;
      if (value.rows) {
        const columns = values.length / value.rows;
        result[key] = Array.from({ length: value.rows }, (_, row) => values.slice(row * columns, (row + 1) * columns));
      }
    }
    return result;
  }

  // ---- drawing

  const axisStyle = { showline: true, mirror: "all", linecolor: "#1a1a1a", ticks: "outside", gridcolor: "#e2e2e2", zerolinecolor: "#8c8c8c", automargin: true, exponentformat: "power", minexponent: 5, title: { standoff: 10 } };

  function laidOut(layout, traces, height) {
    const legend = layout.showlegend || traces.filter((trace) => trace.showlegend !== false).length > 1;
    const whole = {
      height: height,
      // Room for the buttons and, below them, the legend.
      margin: { l: 76, r: 24, t: legend ? 62 : 38, b: 56 },
      font: { family: '"DejaVu Sans", Verdana, Arial, sans-serif', size: 13, color: "#1a1a1a" },
      paper_bgcolor: "#fff",
      plot_bgcolor: "#fff",
      hovermode: "closest",
      dragmode: "zoom",
      legend: { orientation: "h", x: 0, xanchor: "left", y: 1.015, yanchor: "bottom", bgcolor: "rgba(0,0,0,0)", traceorder: "normal" },
      ...layout,
    };
    for (const key of Object.keys(whole)) {
      if (/^[xy]axis\d*$/.test(key)) whole[key] = { ...axisStyle, ...whole[key], title: { ...axisStyle.title, ...whole[key].title } };
    }
    return whole;
  }

  // Without the buttons that choose points, that save as PNG, and that send the chart to a server.
  const settings = { responsive: true, displaylogo: false, plotlyServerURL: "", modeBarButtonsToRemove: ["select2d", "lasso2d", "toImage", "sendChartToCloud", "sendDataToCloud"] };

  async function draw(chart) {
    const content = await chart.content();
    await Plotly.react(chart.plot, content.traces, laidOut(content.layout, content.traces, chart.height), settings);
    if (!chart.drawn) {
      chart.drawn = true;
      chart.plot.on("plotly_click", (event) => {
        const number = event.points[0].customdata;
        if (Number.isInteger(number)) choose(number, true);
      });
    }
    for (const button of chart.savers) button.disabled = content.traces.length === 0;
    chart.figure.dataset.drawn = chart.revision;
  }

  // One drawing at a time and chart, and the last one asked for comes last.
  function redraw(chart) {
    chart.revision += 1;
    chart.pending = chart.pending.then(() => draw(chart));
    return chart.pending;
  }

  function ensureDrawn(chart) {
    if (chart.revision === 0) redraw(chart);
    return chart.pending;
  }

  async function drawAll() {
    for (const chart of charts.values()) await ensureDrawn(chart);
  }

  // ---- the chosen step

  async function stepArrays(number) {
    const data = report.step_data[number];
    const extremes = await unpack(data.extremes);
    const end = await unpack(data.end);
    const bins = data.bins;
    const segment = report.segments[number];
    const period = report.sample_period;
    const wide = { time: [], gap_low: [], gap_high: [], force_low: [], force_high: [] };
    const names = ["gap_low", "gap_high", "force_low", "force_high"];
    for (let i = 0; i < bins && segment.first + i * data.width < data.begin; ++i) {
      // Constant over its part; up to where every sample is at hand.
      const stop = Math.min(data.begin, segment.first + (i + 1) * data.width);
      for (const sample of [segment.first + i * data.width, stop]) {
        wide.time.push(sample * period);
        names.forEach((name, row) => wide[name].push(extremes[row * bins + i]));
      }
    }
    const fine = { time: Array.from({ length: data.samples }, (_, i) => (data.begin + i) * period), gap: end.slice(0, data.samples), force: end.slice(data.samples) };
    return { segment, data, wide, fine };
  }

  function stepLine(x, y, name, color, extra) {
    return { type: "scatter", mode: "lines", x, y, name, line: { color, width: 1.4 }, ...extra };
  }

  // Of a band between two lines, closed by itself for each run of points at which both are known.
  function outline(x, low, high) {
    const line = [[], []];
    for (let begin = 0; begin < x.length; ++begin) {
      if (low[begin] === null || high[begin] === null) continue;
      let end = begin;
      while (end < x.length && low[end] !== null && high[end] !== null) ++end;
      line[0].push(...x.slice(begin, end), ...x.slice(begin, end).reverse(), x[begin], null);
      line[1].push(...low.slice(begin, end), ...high.slice(begin, end).reverse(), low[begin], null);
      begin = end;
    }
    return line;
  }

  async function stepTime() {
    const { wide, fine } = await stepArrays(step);
    const units = report.units;
    const traces = [];
    for (const [name, unit, color, axis, label] of [
      ["gap", units.gap, "#0072B2", "y2", "gap"],
      ["force", units.force, "#D55E00", "y", "contact force"],
    ]) {
      const shade = name === "gap" ? "rgba(86,180,233,0.45)" : "rgba(230,159,0,0.45)";
      const [x, y] = outline(wide.time, scaled(wide[name + "_low"], unit.factor), scaled(wide[name + "_high"], unit.factor));
      traces.push(stepLine(x, y, label + ": least to greatest value", color, { yaxis: axis, hoverinfo: "skip", line: { color: shade, width: 1 }, fill: "toself", fillcolor: shade }));
      traces.push(stepLine(fine.time, scaled(fine[name], unit.factor), label + ": every sample", color, { yaxis: axis, hovertemplate: "%{x:.6f} s: %{y:.4g} " + unit.text + "<extra></extra>" }));
    }
    const [from, to] = [fine.time[0], fine.time[fine.time.length - 1]];
    const range = charts.get("step_time").whole ? [report.segments[step].first * report.sample_period, to] : shown(from, to);
    const layout = {
      xaxis: { title: { text: "time since the first sample of the recording (s)" }, range, anchor: "y" },
      yaxis: { title: { text: "contact force (" + units.force.text + ")" }, domain: [0, 0.47] },
      yaxis2: { title: { text: "gap (" + units.gap.text + ")" }, domain: [0.53, 1] },
    };
    return { traces, layout, table: [["time_s", fine.time], ["gap_m", fine.gap], ["force_N", fine.force]] };
  }

  // Of the samples that are here, the last cycles that a chart shows at first.
  function shown(from, to) {
    const segment = report.segments[step];
    if (!segment.frequency) return [from, to];
    return [Math.max(from, to - 2 * Math.max(4, segment.period || 8) / segment.frequency), to];
  }

  async function stepPortrait() {
    const { fine } = await stepArrays(step);
    const units = report.units;
    const [from] = shown(fine.time[0], fine.time[fine.time.length - 1]);
    const gap = [];
    const velocity = [];
    const time = [];
    for (let i = 1; i + 1 < fine.gap.length; ++i) {
      if (fine.time[i] < from) continue;
      time.push(fine.time[i]);
      gap.push(fine.gap[i]);
      velocity.push((fine.gap[i + 1] - fine.gap[i - 1]) / (2 * report.sample_period));
    }
    if (!velocity.some(Number.isFinite)) return nothing("phase portrait left out: samples are lost");
    const [slowest, fastest] = limits(velocity);
    const speed = unitFor(Math.max(-slowest, fastest), "m/s");
    const [least, greatest] = limits(gap).map((value) => value * units.gap.factor);
    const margin = 0.04 * (greatest - least || 1);
    const trace = stepLine(scaled(gap, units.gap.factor), scaled(velocity, speed.factor), "motion", "#0072B2", { line: { color: "#0072B2", width: 1 }, hovertemplate: "gap %{x:.4g} " + units.gap.text + "<br>%{y:.4g} " + speed.text + "<extra></extra>", showlegend: false });
    const layout = {
      xaxis: { title: { text: "gap (" + units.gap.text + ")" }, range: [least - margin, greatest + margin] },
      yaxis: { title: { text: "gap velocity (" + speed.text + ")" } },
      shapes: [{ type: "line", x0: 0, x1: 0, y0: 0, y1: 1, yref: "paper", line: { color: "#D55E00", width: 1, dash: "dash" } }],
    };
    return { traces: [trace], layout, table: [["time_s", time], ["gap_m", gap], ["gap_velocity_m_per_s", velocity]] };
  }

  function limits(values) {
    let [least, greatest] = [Infinity, -Infinity];
    for (const value of values) {
      if (value < least) least = value;
      if (value > greatest) greatest = value;
    }
    return [least, greatest];
  }

  function unitFor(largest, unit) {
    const prefixes = [["G", 1e9], ["M", 1e6], ["k", 1e3], ["", 1], ["m", 1e-3], ["\u00b5", 1e-6], ["n", 1e-9]];
    const [prefix, size] = prefixes.find(([, size]) => largest >= size) || (largest > 0 ? ["p", 1e-12] : ["", 1]);
    return { factor: 1 / size, text: prefix + unit };
  }

  async function stepSpectrum() {
    const data = report.step_data[step];
    const units = report.units;
    const traces = [];
    const table = [];
    const missing = [];
    for (const [name, unit, color, dash, axis, label] of [
      ["gap", units.gap, "#0072B2", "solid", "y2", "gap"],
      ["force", units.force, "#D55E00", "solid", "y", "contact force"],
    ]) {
      const packed = data[name + "_spectrum"];
      if (!packed) {
        missing.push("spectrum of the " + label + " left out: " + data["no_" + name + "_spectrum"]);
        continue;
      }
      const level = await unpack(packed);
      const amplitude = Array.from(level, (value) => 10 ** value);
      const frequency = amplitude.map((_, i) => packed.df * (1 + i * packed.run + (packed.run - 1) / 2));
      traces.push(stepLine(frequency, scaled(amplitude, unit.factor), label, color, { yaxis: axis, line: { color, width: 1.1, dash }, hovertemplate: "%{x:.5g} Hz: %{y:.4g} " + unit.text + "<extra></extra>", showlegend: false }));
      if (table.length === 0) table.push(["frequency_Hz", frequency]);
      table.push([name === "gap" ? "gap_amplitude_m" : "force_amplitude_N", amplitude]);
    }
    if (traces.length === 0) return nothing(missing.join("<br>"));
    const both = traces.length === 2;
    const frequency = report.segments[step].frequency;
    const layout = {
      xaxis: { title: { text: "frequency (Hz)" }, anchor: data.force_spectrum ? "y" : "y2" },
      shapes: frequency ? [{ type: "line", x0: frequency, x1: frequency, y0: 0, y1: 1, yref: "paper", line: { color: "#1a1a1a", width: 1, dash: "dot" } }] : [],
      annotations: missing.map((text) => remark(text, 1, 1.01, "bottom")),
    };
    if (data.gap_spectrum) layout.yaxis2 = { title: { text: "gap (" + units.gap.text + ")" }, type: "log", domain: both ? [0.53, 1] : [0, 1] };
    if (data.force_spectrum) layout.yaxis = { title: { text: "force (" + units.force.text + ")" }, type: "log", domain: both ? [0, 0.47] : [0, 1] };
    return { traces, layout, table };
  }

  // Words in a chart, at a place in shares of its width and height.
  function remark(text, x, y, yanchor) {
    return { text, x, y, xref: "paper", yref: "paper", xanchor: x === 1 ? "right" : "center", yanchor, showarrow: false };
  }

  // A chart of which there is nothing but why.
  function nothing(text) {
    return { traces: [], layout: { xaxis: { visible: false }, yaxis: { visible: false }, annotations: [remark(text, 0.5, 0.5, "middle")] }, table: [] };
  }

  const stepContents = { step_time: stepTime, step_portrait: stepPortrait, step_spectrum: stepSpectrum };

  function choose(number, scroll) {
    if (!(number in report.step_data)) {
      const known = Object.keys(report.step_data).map(Number);
      number = known.reduce((best, other) => (Math.abs(other - number) < Math.abs(best - number) ? other : best));
    }
    step = number;
    document.getElementById("step-choice").value = String(number);
    for (const key of chosenKeys) {
      const chart = charts.get(key);
      if (chart.revision > 0 || !scroll) redraw(chart);
    }
    if (scroll) document.getElementById("step").scrollIntoView();
    return Promise.all(chosenKeys.map((key) => charts.get(key).pending));
  }

  // ---- saving

  function save(blob, name) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  }

  function fileName(chart, ending) {
    const which = chosenKeys.includes(chart.key) ? "_" + (step + 1) : "";
    return chart.key + which + ending;
  }

  async function svg(chart) {
    await ensureDrawn(chart);
    const url = await Plotly.toImage(chart.plot, { format: "svg", width: chart.plot.clientWidth, height: chart.height });
    return decodeURIComponent(url.slice(url.indexOf(",") + 1));
  }

  // The shortest text that reads back as the same number in the type of its array; twelve digits of what was computed here.
  function number(value, array) {
    if (!Number.isFinite(value)) return "";
    if (!(array instanceof Float32Array)) return String(array instanceof Array ? Number(value.toPrecision(12)) : value);
    const digits = [6, 7, 8, 9].find((count) => Math.fround(Number(value.toPrecision(count))) === value);
    return String(Number(value.toPrecision(digits)));
  }

  function written(values) {
    return Array.from(values, (value) => number(value, values));
  }

  async function csv(chart) {
    const lines = [];
    if (chart.specification && chart.specification.matrix) {
      const [header, row, column, value] = chart.specification.matrix;
      const [rows, columns, values] = await Promise.all([row, column, value].map((name) => unpack(chart.specification.arrays[name])));
      lines.push([header + "/time_s", ...written(columns)].join(","));
      for (let i = 0; i < rows.length; ++i) lines.push([number(rows[i], rows), ...written(values.subarray(i * columns.length, (i + 1) * columns.length))].join(","));
    } else {
      const { table } = await chart.content();
      if (table.length === 0) return "";
      lines.push(table.map(([header]) => header).join(","));
      for (let i = 0; i < table[0][1].length; ++i) lines.push(table.map(([, values]) => number(values[i], values)).join(","));
    }
    return lines.join("\n") + "\n";
  }

  // ---- setting up

  function button(text, action, parent) {
    const made = document.createElement("button");
    made.type = "button";
    made.textContent = text;
    made.addEventListener("click", action);
    parent.append(made);
    return made;
  }

  function zoom(chart, change) {
    const range = chart.plot._fullLayout && chart.plot._fullLayout.xaxis.range;
    if (!range) return;
    const [from, to] = change(range[0], range[1]);
    Plotly.relayout(chart.plot, { "xaxis.range": [from, to] });
  }

  const keys = {
    "+": (a, b) => [a + (b - a) / 4, b - (b - a) / 4],
    "-": (a, b) => [a - (b - a) / 2, b + (b - a) / 2],
    ArrowLeft: (a, b) => [a - (b - a) / 4, b - (b - a) / 4],
    ArrowRight: (a, b) => [a + (b - a) / 4, b + (b - a) / 4],
  };

  function setUp(figure) {
    const key = figure.dataset.chart;
    const specification = report.charts[key];
    const chart = { key, figure, specification, plot: figure.querySelector(".plot"), height: Number(figure.dataset.height), revision: 0, drawn: false, pending: Promise.resolve(), whole: false };
    chart.plot.style.minHeight = chart.height + "px";
    chart.content = stepContents[key] || (async () => ({
      traces: await Promise.all(specification.traces.map((trace) => filled(trace, specification.arrays))),
      layout: specification.layout,
      table: await Promise.all(specification.table.map(async ([header, name]) => [header, await unpack(specification.arrays[name])])),
    }));
    charts.set(key, chart);
    const tools = figure.querySelector(".tools");
    const name = figure.querySelector("h3").textContent;
    const saver = (words, make, type, ending) => {
      const made = button(words, async () => {
        await ensureDrawn(chart);
        if (!made.disabled) save(new Blob([await make(chart)], { type }), fileName(chart, ending));
      }, tools);
      made.setAttribute("aria-label", words + ": " + name);
      return made;
    };
    chart.savers = [saver("Save as SVG", svg, "image/svg+xml", ".svg"), saver("Save data as CSV", csv, "text/csv", ".csv")];
    if (specification && specification.logarithmic) {
      const axis = specification.logarithmic;
      let logarithmic = specification.layout[axis].type === "log";
      const toggle = button("Logarithmic " + axis[0], () => {
        logarithmic = !logarithmic;
        toggle.setAttribute("aria-pressed", logarithmic);
        ensureDrawn(chart).then(() => Plotly.relayout(chart.plot, { [axis + ".type"]: logarithmic ? "log" : "linear", [axis + ".autorange"]: true }));
      }, tools);
      toggle.setAttribute("aria-pressed", logarithmic);
    }
    if (key === "step_time") {
      const toggle = button("Whole " + report.part, () => {
        chart.whole = !chart.whole;
        toggle.setAttribute("aria-pressed", chart.whole);
        redraw(chart);
      }, tools);
      toggle.setAttribute("aria-pressed", false);
    }
    figure.tabIndex = 0;
    figure.setAttribute("aria-label", name + ". Keys: plus and minus zoom, arrows left and right move, 0 shows all.");
    figure.addEventListener("keydown", (event) => {
      if (event.target !== figure || !chart.drawn) return;
      if (event.key === "0") Plotly.relayout(chart.plot, { "xaxis.autorange": true });
      else if (keys[event.key]) zoom(chart, keys[event.key]);
      else return;
      event.preventDefault();
    });
    return chart;
  }

  document.querySelectorAll("figure[data-chart]").forEach(setUp);
  const watch = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      watch.unobserve(entry.target);
      ensureDrawn(charts.get(entry.target.dataset.chart));
    }
  }, { rootMargin: "300px" });
  const choice = document.getElementById("step-choice");
  if (choice) {
    for (const number of Object.keys(report.step_data).map(Number).sort((a, b) => a - b)) choice.add(new Option(report.segments[number].label, number));
    step = report.chosen;
    choice.value = String(step);
    choice.addEventListener("change", () => choose(Number(choice.value), false));
    const move = (by) => {
      const index = choice.selectedIndex + by;
      if (index >= 0 && index < choice.options.length) choose(Number(choice.options[index].value), false);
    };
    document.getElementById("step-back").addEventListener("click", () => move(-1));
    document.getElementById("step-on").addEventListener("click", () => move(1));
  }
  for (const chart of charts.values()) watch.observe(chart.figure);
  document.getElementById("draw-all").addEventListener("click", async (event) => {
    await drawAll();
    event.target.textContent = "All charts are drawn";
  });
  window.addEventListener("beforeprint", drawAll);
  // For whoever drives the page from a script.
  window.vibroImpactReport = { drawAll, draw: (key) => ensureDrawn(charts.get(key)), choose: (number) => choose(number, false), csv: (key) => csv(charts.get(key)), svg: (key) => svg(charts.get(key)), charts: () => [...charts.keys()] };
})();
