// Every seed by itself: a dot per seed and controller, and a line that joins the same seed's dots, so
// that one sees whether a difference holds from seed to seed.

const SEEDS_HEIGHT = 320;

function seedsFigure(data, metric) {
  const place = byId("seeds-chart");
  const width = Math.max(300, place.clientWidth);
  const {key} = data.metrics[metric];
  const values = data.by_seed[key];  // per controller, per seed
  const shown = data.order.flatMap((c) => values[c].filter((v) => v !== null));
  const low = Math.min(0, ...shown);
  const y_axis = {label: metricLabel(key), low, high: Math.max(...shown, low + 1e-6) * 1.05};
  const svg = lineFigure({width, height: SEEDS_HEIGHT, x: {label: "", low: 0, high: 1, log: false}, y: y_axis,
    lines: [], label: `${metricName(key).name} of every seed`});
  svg.querySelectorAll('text[text-anchor="middle"]:not([transform])').forEach((text) => text.remove());
  const bottom = SEEDS_HEIGHT - FIGURE_MARGIN.bottom;
  const step = (width - FIGURE_MARGIN.left - FIGURE_MARGIN.right) / data.order.length;
  const x = (place_of) => FIGURE_MARGIN.left + (place_of + 0.5) * step;
  const y = scaleOf(y_axis, bottom, FIGURE_MARGIN.top);
  data.seeds.forEach((_, s) => {
    const points = data.order.map((c, i) => [x(i), values[c][s]]).filter((p) => p[1] !== null);
    svg.append(element("path", {class: "seed", d: points.map(([px, v], i) => `${i ? "L" : "M"}${px} ${y(v)}`).join("")}));
  });
  data.order.forEach((c, i) => {
    values[c].forEach((value, s) => {
      if (value === null) return;
      svg.append(element("circle", {cx: x(i), cy: y(value), r: 3.5, style: `fill: ${colourName(c)}`},
        element("title", {}, `${data.controllers[c].name}, seed ${data.seeds[s]}: ${formatNumber(value)}`)));
    });
    const lines = data.controllers[c].name.split(/(?<=_)/);
    const wrap = step < 8 * data.controllers[c].name.length ? lines : [data.controllers[c].name];
    wrap.forEach((text, line) => svg.append(element("text", {class: "name", x: x(i), y: bottom + 18 + 14 * line,
      "text-anchor": "middle"}, text)));
  });
  return svg;
}

function startSeeds(data) {
  const select = byId("seeds-metric");
  addScores(select, data, (key) => data.by_seed[key]);
  const metric = () => Number(select.value);
  const draw = () => byId("seeds-chart").replaceChildren(seedsFigure(data, metric()));
  select.addEventListener("change", draw);
  byId("seeds-chart").after(saveButtons(data, "seeds", () => seedsFigure(data, metric()), () => {
    const values = data.by_seed[data.metrics[metric()].key];
    return [["seed", ...data.order.map((c) => data.controllers[c].name)],
      ...data.seeds.map((seed, s) => [seed, ...data.order.map((c) => values[c][s])])];
  }));
  draw();
  return draw;
}
