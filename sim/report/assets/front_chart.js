// Jitter against delay, as SVG: where each controller stands, and who is dominated.

const FRONT_HEIGHT = 380;
const FRONT_MARGIN = {left: 58, right: 18, top: 14, bottom: 46};
const BEST_CONTROLLER_DELAY_MS = [100, 125];  // Farrell and Weir 2007

function niceStep(range, wanted) {
  const rough = range / wanted;
  const power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map((digit) => digit * power).find((step) => step >= rough);
}

function ticks(low, high, wanted) {
  const step = niceStep(high - low, wanted);
  const values = [];
  for (let i = Math.ceil(low / step); i * step <= high + 1e-9 * step; ++i) values.push(i * step);
  return {values, decimals: Math.max(0, -Math.floor(Math.log10(step) + 1e-9))};
}

function frontPoints(data) {
  const jitter = data.metrics.findIndex((m) => m.key === "jitter_rms_deg");
  const delay = data.metrics.findIndex((m) => m.key === "delay_ms");
  if (jitter < 0 || delay < 0) return [];
  return data.controllers
    .map((c, index) => ({index, name: c.name, dominated: c.dominated,
      delay: c.summary[delay], jitter: c.summary[jitter]}))
    .filter((p) => p.delay[0] !== null && p.jitter[0] !== null);
}

// Places each name where it covers no other name or point; the first free of eight places.
function placeNames(points, x, y, width) {
  const taken = points.map((p) => ({left: x(p.delay[0]) - 7, right: x(p.delay[0]) + 7,
    top: y(p.jitter[0]) - 7, bottom: y(p.jitter[0]) + 7}));
  const meets = (a) => taken.some(
    (b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom);
  return points.map((p) => {
    const w = 8 * p.label.length;
    const px = x(p.delay[0]);
    const py = y(p.jitter[0]);
    const places = [[12, 4, "start"], [-12, 4, "end"], [12, -12, "start"], [-12, -12, "end"],
      [12, 20, "start"], [-12, 20, "end"], [0, -16, "middle"], [0, 26, "middle"]];
    const boxes = places.map(([dx, dy, anchor]) => {
      const left = px + dx - (anchor === "end" ? w : anchor === "middle" ? w / 2 : 0);
      return {left, right: left + w, top: py + dy - 12, bottom: py + dy + 4,
        text_x: px + dx, text_y: py + dy, anchor};
    });
    const inside = (b) => b.left >= FRONT_MARGIN.left && b.right <= width &&
      b.top >= 0 && b.bottom <= FRONT_HEIGHT - FRONT_MARGIN.bottom;
    const box = boxes.find((b) => inside(b) && !meets(b)) ?? boxes.find(inside) ?? boxes[0];
    taken.push(box);
    return box;
  });
}

function pointShapes(p, x, y) {
  const colour = colourName(p.index);
  return [element("circle", {cx: x(p.delay[0]), cy: y(p.jitter[0]), r: 6, style: p.dominated
    ? `fill: var(--ground); stroke: ${colour}; stroke-width: 2`
    : `fill: ${colour}; stroke: var(--ground); stroke-width: 1.5`})];
}

function axisShapes(x_ticks, y_ticks, x, y, width) {
  const bottom = FRONT_HEIGHT - FRONT_MARGIN.bottom;
  const shapes = [];
  for (const value of y_ticks.values) {
    shapes.push(element("line", {class: "grid", x1: FRONT_MARGIN.left, x2: width - FRONT_MARGIN.right,
        y1: y(value), y2: y(value)}),
      element("text", {x: FRONT_MARGIN.left - 10, y: y(value) + 4, "text-anchor": "end"},
        value.toFixed(y_ticks.decimals)));
  }
  for (const value of x_ticks.values) {
    shapes.push(element("text", {x: x(value), y: bottom + 20, "text-anchor": "middle"},
      value.toFixed(x_ticks.decimals).replace("-", "−")));
  }
  const middle = (FRONT_MARGIN.top + bottom) / 2;
  shapes.push(
    element("text", {x: (FRONT_MARGIN.left + width - FRONT_MARGIN.right) / 2, y: bottom + 42,
      "text-anchor": "middle"}, "delay, ms"),
    element("text", {x: 0, y: 0, "text-anchor": "middle",
      transform: `translate(13 ${middle}) rotate(-90)`}, "jitter, deg RMS"));
  return shapes;
}

function bandShapes(x, high) {
  const [from, to] = BEST_CONTROLLER_DELAY_MS;
  const bottom = FRONT_HEIGHT - FRONT_MARGIN.bottom;
  return [
    element("rect", {class: "band", x: x(from), y: FRONT_MARGIN.top,
      width: x(Math.min(to, high)) - x(from), height: bottom - FRONT_MARGIN.top}),
    element("text", {class: "band-name", x: x(from) + 7, y: FRONT_MARGIN.top + 17}, "100 to"),
    element("text", {class: "band-name", x: x(from) + 7, y: FRONT_MARGIN.top + 33}, "125 ms")];
}

function startFrontChart(data) {
  drawFrontChart(data);
  const points = frontPoints(data);
  if (points.length === 0) return;
  byId("front-chart").after(saveButtons(data, "front", () => byId("front-chart").querySelector("svg"), () => [
    ["controller", "delay_ms", "jitter_rms_deg", "dominated"],
    ...points.map((p) => [p.name, p.delay[0], p.jitter[0], p.dominated])]));
}

function drawFrontChart(data) {
  const place = byId("front-chart");
  const points = frontPoints(data);
  if (points.length === 0) {
    place.replaceChildren(element("p", {class: "note"},
      "The wearer did not move, so there is no delay to draw."));
    return;
  }
  const width = Math.max(300, place.clientWidth);
  const inner_width = width - FRONT_MARGIN.left - FRONT_MARGIN.right;
  const bottom = FRONT_HEIGHT - FRONT_MARGIN.bottom;
  const low = Math.min(0, ...points.map((p) => 1.15 * p.delay[0]));
  const high = Math.max(145, ...points.map((p) => 1.1 * p.delay[0]));
  const top = 1.15 * Math.max(1e-3, ...points.map((p) => p.jitter[0]));
  const x = (value) => FRONT_MARGIN.left + (value - low) / (high - low) * inner_width;
  const y = (value) => bottom - value / top * (bottom - FRONT_MARGIN.top);

  for (const p of points) {
    p.label = p.dominated && width >= 560 ? `${p.name} (dominated)` : p.name;
  }
  const front = points.filter((p) => !p.dominated).sort((a, b) => a.delay[0] - b.delay[0]);
  const names = placeNames(points, x, y, width);
  const said = points.map((p) => `${p.name}: ${formatNumber(p.delay[0])} ms, ` +
    `${formatNumber(p.jitter[0])} deg${p.dominated ? ", dominated" : ""}`).join("; ");
  place.replaceChildren(element("svg", {viewBox: `0 0 ${width} ${FRONT_HEIGHT}`,
      height: FRONT_HEIGHT, role: "img", "aria-label": `Jitter against delay. ${said}`},
    ...bandShapes(x, high),
    ...axisShapes(ticks(low, high, width < 500 ? 5 : 9), ticks(0, top, 5), x, y, width),
    element("path", {class: "front-line",
      d: front.map((p, i) => `${i ? "L" : "M"}${x(p.delay[0])} ${y(p.jitter[0])}`).join("")}),
    ...points.flatMap((p) => pointShapes(p, x, y)),
    ...points.map((p, i) => element("text", {class: `name${p.dominated ? " faint" : ""}`,
      x: names[i].text_x, y: names[i].text_y, "text-anchor": names[i].anchor},
      p.label))));
}
