// Curves of one channel over time: the wearer's joint, what the glove said, and per controller what
// it filtered, commanded and what the hand did.

const SIGNALS = [
  {key: "hand", label: "hand", dash: null, width: 1.7},
  {key: "filtered", label: "filtered", dash: [5, 3], width: 1.1},
  {key: "command", label: "command", dash: [1.5, 2.5], width: 1.1, step: true},
];

class CurvesView {
  constructor(data, time, onChannel) {
    this.data = data;
    this.time = time;
    this.onChannel = onChannel;
    this.store = new CurveStore(data);
    this.place = byId("curves-plot");
    this.select = byId("curves-channel");
    this.shown = {true: true, raw: true, hand: true, filtered: false, command: false};
    this.controllers = data.controllers.map(() => true);
    this.view = byId("curves-view");
    this.window = [0, this.store.duration_s];
    this.cursor = null;
    this.onView = null;  // of another channel or view: for the address
    time.listen("curves", (time_s) => this.showTime(time_s));
    data.channels.forEach((name) => this.select.append(element("option", {value: name}, name)));
    this.select.value = data.first_channel;
    if (this.select.selectedIndex < 0) this.select.selectedIndex = 0;
    this.listen();
    this.buildReadout();
    this.show();
  }

  listen() {
    const move = (by) => {
      const count = this.select.options.length;
      this.select.selectedIndex = (this.select.selectedIndex + by + count) % count;
      this.show();
    };
    this.select.addEventListener("change", () => this.show());
    this.view.addEventListener("change", () => this.show());
    byId("curves-previous").addEventListener("click", () => move(-1));
    byId("curves-next").addEventListener("click", () => move(1));
    byId("curves-in").addEventListener("click", () => this.zoom(0.5));
    byId("curves-out").addEventListener("click", () => this.zoom(2));
    byId("curves-all").addEventListener("click", () => this.look(0, this.store.duration_s));
    this.place.addEventListener("keydown", (event) => this.onKey(event));
  }

  onKey(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const width = this.window[1] - this.window[0];
    const side = event.key === "ArrowLeft" ? -1 : event.key === "ArrowRight" ? 1 : 0;
    if (side && event.shiftKey) this.look(this.window[0] + side * width / 5, this.window[1] + side * width / 5);
    else if (side) this.moveCursor(side * Math.max(width / 200, this.store.step_s));
    else if (event.key === "+" || event.key === "=") this.zoom(0.5);
    else if (event.key === "-") this.zoom(2);
    else if (event.key === "0") this.look(0, this.store.duration_s);
    else return;
    event.preventDefault();
  }

  moveCursor(by_s) {
    const from = this.cursor ?? (this.window[0] + this.window[1]) / 2;
    const to = Math.min(this.window[1], Math.max(this.window[0], from + by_s));
    this.showTime(to);
    this.time.set(to, "curves", true);
  }

  // The cursor at a time; what is shown follows it.
  showTime(time) {
    if (time === null || time < 0 || time > this.store.duration_s) return;
    const width = this.window[1] - this.window[0];
    if (time < this.window[0] || time > this.window[1]) this.look(time - width / 10, time + 0.9 * width);
    let row = this.rows.findIndex((r) => r[0] >= time);
    if (row < 0) row = this.rows.length - 1;
    this.plot.setSelection(row);
    this.readAt(time);
  }

  zoom(factor) {
    const middle = this.cursor !== null && this.cursor > this.window[0] && this.cursor < this.window[1]
      ? this.cursor : (this.window[0] + this.window[1]) / 2;
    this.look(middle - (middle - this.window[0]) * factor, middle + (this.window[1] - middle) * factor);
  }

  // Shows this stretch of time, kept inside the recording and wide enough for a few points.
  look(from_s, to_s) {
    const width = Math.min(this.store.duration_s, Math.max(8 * this.store.step_s, to_s - from_s));
    const from = Math.min(Math.max(0, from_s), this.store.duration_s - width);
    this.window = [from, from + width];
    this.refine();
  }

  selectChannel(name) {
    this.select.value = name;
    this.show();
  }

  // Angles, or how far they are from the wearer's. Of a bucket, from the middle of the wearer's.
  shownValues(values, truth) {
    if (this.view.value !== "error") return values;
    const pair = this.store.bucketed;
    return values.map((value, i) => value - (pair ? (truth[i - i % 2] + truth[i - i % 2 + 1]) / 2 : truth[i]));
  }

  // What is drawn: [{label, values, colour, dash, width, step}], from the back to the front.
  lines() {
    const channel = this.store.channel(this.select.selectedIndex);
    const lines = [];
    if (this.shown.raw) {
      lines.push({label: "glove", values: this.shownValues(channel.raw, channel.true), colour: "var(--glove)", width: 1});
    }
    [...this.data.order].reverse().forEach((i) => {  // the best on top
      const c = channel.controllers[i];
      if (!this.controllers[i]) return;
      for (const signal of [...SIGNALS].reverse()) {
        if (!this.shown[signal.key]) continue;
        lines.push({...signal, label: `${i} ${signal.key}`, colour: colourName(i),
          values: this.shownValues(c[signal.key], channel.true)});
      }
    });
    if (this.shown.true) {
      lines.push({label: "wearer", values: this.shownValues(channel.true, channel.true), colour: "var(--wearer)", width: 1.5});
    }
    return lines;
  }

  // Draws anew: another channel, other curves, another width or other colours.
  show() {
    this.current = this.lines();
    if (this.current.length === 0) {
      const none = new Float64Array(this.store.points).fill(NaN);
      this.current = [{label: "nothing", values: none, colour: "var(--ink)", width: 1}];
    }
    this.plot?.destroy();
    this.makeRows();
    this.plot = new Dygraph(this.place, this.rows, this.options());
    for (const handle of this.place.querySelectorAll("img")) handle.alt = "";  // of the range selector
    this.onChannel(this.select.value, this.select.selectedIndex);
    this.readAt(this.cursor);
    this.onView?.();
  }

  makeRows() {
    const pixels = Math.max(300, Math.min(2000, this.place.clientWidth));
    this.rows = plotRows(this.store, this.current.map((line) => line.values), ...this.window, pixels);
  }

  // The stretch of time changed: the same curves, as fine as it allows.
  refine() {
    this.makeRows();
    this.refining = true;
    this.plot.updateOptions({file: this.rows, dateWindow: this.window});
    this.refining = false;
  }

  options() {
    const colour = resolvedColour;
    const series = {};
    for (const line of this.current) {
      series[line.label] = {strokeWidth: line.width, strokePattern: line.dash ?? null,
        stepPlot: line.step === true};
    }
    return {
      labels: ["time", ...this.current.map((line) => line.label)],
      colors: this.current.map((line) => colour(line.colour)),
      series,
      dateWindow: this.window,
      legend: "never",
      xlabel: "time, s",
      ylabel: this.yLabel(),
      axes: {
        x: {drawGrid: false, axisLabelFormatter: (t) => String(Number(t.toFixed(3)))},
        y: {axisLabelWidth: 42, axisLabelFormatter: (v) => String(Number(v.toFixed(3))).replace("-", "−")},
      },
      axisLineColor: colour("var(--line)"),
      gridLineColor: colour("var(--line)"),
      axisLabelFontSize: 12,
      xLabelHeight: 20,
      yLabelWidth: 20,
      highlightCircleSize: 3.5,
      showRangeSelector: true,
      rangeSelectorHeight: 34,
      rangeSelectorPlotStrokeColor: colour("var(--muted)"),
      rangeSelectorPlotFillColor: colour("var(--line)"),
      rangeSelectorPlotFillGradientColor: colour("var(--line)"),
      rangeSelectorBackgroundStrokeColor: colour("var(--line)"),
      rangeSelectorForegroundStrokeColor: colour("var(--muted)"),
      rangeSelectorAlpha: 0.5,
      interactionModel: Dygraph.defaultInteractionModel,  // the range selector has one that cannot zoom
      clickCallback: (_, time) => this.time.set(time, "curves", true),
      highlightCallback: (_, time) => {
        this.readAt(time);
        this.time.set(time, "curves");
      },
      unhighlightCallback: () => this.readAt(null),
      underlayCallback: (canvas, area, plot) => this.shade(canvas, area, plot),
      drawCallback: (plot, first) => this.onDraw(plot, first),
    };
  }

  // Where the channel does not count in the scores: [[from, to]..], in seconds.
  uncounted() { return this.data.uncounted_s?.[this.select.selectedIndex] ?? []; }

  shade(canvas, area, plot) {
    canvas.fillStyle = resolvedColour("var(--line)");
    for (const [from, to] of this.uncounted()) {
      const left = Math.max(area.x, plot.toDomXCoord(from));
      const right = Math.min(area.x + area.w, plot.toDomXCoord(to));
      if (right > left) canvas.fillRect(left, area.y, right - left, area.h);
    }
  }

  onDraw(plot, first) {
    if (first || this.refining) return;
    const [from, to] = plot.xAxisRange();
    const {duration_s} = this.store;
    if (Math.abs(from - this.window[0]) + Math.abs(to - this.window[1]) < 1e-9) return;
    const whole = to - from > 0.99 * duration_s;  // after a double click: as far as there are points
    this.later(whole ? 0 : from, whole ? duration_s : to);
  }

  // Once per frame while the view is dragged.
  later(from, to) {
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame(() => this.look(from, to));
  }

  // --- saving ---------------------------------------------------------------------------------

  figure() {
    const inside = this.rows.filter((row) => row[0] >= this.window[0] && row[0] <= this.window[1]);
    const values = inside.flatMap((row) => row.slice(1)).filter(Number.isFinite);
    const low = Math.min(...values);
    const high = Math.max(...values, low + 0.01);
    const margin = 0.05 * (high - low);
    const svg = lineFigure({width: Math.max(300, this.place.clientWidth), height: 420,
      x: {label: "time, s", low: this.window[0], high: this.window[1]},
      y: {label: this.yLabel(), low: low - margin, high: high + margin},
      label: `Curves of ${this.select.value}`,
      bands: this.uncounted(),
      lines: this.current.map((line, i) => ({...line, points: inside.map((row) => [row[0], row[i + 1]])}))});
    this.place.after(svg);  // styles are those of a figure of the page
    setTimeout(() => svg.remove());
    return svg;
  }

  // What the page keeps of the channel, in the stretch of time that is shown.
  table() {
    const channel = this.store.channel(this.select.selectedIndex);
    const columns = [["wearer_deg", channel.true], ["glove_deg", channel.raw]];
    channel.controllers.forEach((c, i) => SIGNALS.forEach(({key}) =>
      columns.push([`${this.data.controllers[i].name}_${key}_deg`, c[key]])));
    const rows = [["time_s", ...columns.map(([name]) => name)]];
    const digits = (value) => (Number.isFinite(value) ? Number(value.toFixed(3)) : NaN);
    for (let i = this.store.pointAt(this.window[0]); i <= this.store.pointAt(this.window[1]); ++i) {
      rows.push([Number(this.store.time(i).toFixed(6)), ...columns.map(([, values]) => digits(values[i]))]);
    }
    return rows;
  }

  yLabel() { return this.view.value === "error" ? "angle less the wearer's, deg" : "joint angle, deg"; }

  // --- the table below the plot: legend, choice and values in one -----------------------------

  lineSample(colour, signal) {
    return element("svg", {width: 26, height: 10, "aria-hidden": "true"}, element("path", {
      d: "M1 5H25", style: `stroke: ${colour}; stroke-width: ${signal.width + 0.7}; fill: none;` +
        (signal.dash ? `stroke-dasharray: ${signal.dash.join(" ")}` : "")}));
  }

  choice(checked, onChange, ...content) {
    return element("label", {}, element("input", {type: "checkbox", checked,
      onchange: (event) => { onChange(event.target.checked); this.show(); }}), ...content);
  }

  buildReadout() {
    this.time_place = element("th", {scope: "col"});
    this.cells = {true: element("td"), raw: element("td"), controllers: []};
    const body = element("tbody");
    const single = (key, label, colour, width) => body.append(element("tr", {},
      element("th", {scope: "row"}, this.choice(true, (on) => { this.shown[key] = on; },
        this.lineSample(colour, {width}), label)), this.cells[key]));
    const reference = this.data.reference.startsWith("recording smoothed") ? "smoothed recording"
      : this.data.reference === "ground truth" ? "wearer (true)" : this.data.reference;
    single("true", reference, "var(--wearer)", 1.5);
    single("raw", "glove (raw)", "var(--glove)", 1);
    this.data.order.forEach((i) => {
      const controller = this.data.controllers[i];
      const cells = {};
      for (const signal of SIGNALS) cells[signal.key] = element("td");
      this.cells.controllers[i] = cells;
      body.append(element("tr", {}, element("th", {scope: "row"},
        this.choice(true, (on) => { this.controllers[i] = on; },
          this.lineSample(colourName(i), SIGNALS[0]),
          element("span", {}, ...breakable(controller.name)))),
        ...SIGNALS.map((signal) => cells[signal.key])));
    });
    const head = element("tr", {}, this.time_place, ...SIGNALS.map((signal) => element("th",
      {scope: "col"}, this.choice(this.shown[signal.key], (on) => { this.shown[signal.key] = on; },
        this.lineSample("var(--muted)", signal), signal.label))));
    byId("curves-readout").append(element("thead", {}, head), body);
  }

  // Values at a time, of all curves, drawn or not.
  readAt(time_s) {
    this.cursor = time_s;
    const none = time_s === null || time_s === undefined;
    this.time_place.textContent = none ? "deg" : `at ${time_s.toFixed(3)} s, deg`;
    const channel = this.store.channel(this.select.selectedIndex);
    const point = none ? -1 : this.store.pointAt(time_s);
    const truth = this.view.value === "error" && !none ? channel.true[point] : 0;
    const value = (values) => (none || point >= values.length ? ""
      : Number.isNaN(values[point]) ? "–" : (values[point] - truth).toFixed(2).replace("-", "−"));
    this.cells.true.textContent = value(channel.true);
    this.cells.raw.textContent = value(channel.raw);
    this.cells.controllers.forEach((cells, i) => {
      for (const signal of SIGNALS) {
        cells[signal.key].textContent = value(channel.controllers[i][signal.key]);
        cells[signal.key].classList.toggle("off", !this.shown[signal.key] || !this.controllers[i]);
      }
    });
  }
}

function curvesNote(data) {
  const {samples_per_bucket, step_deg} = data.curves;
  const seed = data.seeds.length > 1 ? `Seed ${data.seeds[0]}, the first. ` : "";
  const bucket_ms = samples_per_bucket / data.rate_hz * 1e3;
  const detail = samples_per_bucket > 1
    ? `This page keeps the smallest and the largest value of every ${formatNumber(bucket_ms)} ms, so ` +
      "that no peak is lost; trace.h5 has every sample."
    : `Every sample, rounded to ${step_deg} deg.`;
  const uncounted = data.uncounted_s?.some((stretches) => stretches.length > 0)
    ? " Grey: not scored (gaps and restarts of the recording, the time after them, and clipped samples)."
    : "";
  return seed + detail + uncounted;
}
