// Where the delay comes from: a row per stage, a column per controller.

function latencyRow(data, label, values, largest, sum) {
  return element("tr", {class: sum ? "sum" : null}, element("th", {scope: "row"}, label, " ",
      element("span", {class: "unit"}, "ms")),
    ...data.order.map((c) => [values[c], c]).map(([value, c]) => element("td", {},
      element("span", {class: "value"}, formatNumber(value)),
      element("span", {class: "mark"}),
      value > 0 && !sum ? element("span", {class: "bar", style: `--colour: ${colourName(c)}; ` +
        `width: calc((100% - 0.95em) * ${(value / largest).toFixed(4)})`}) : null)));
}

// For a file: a row per stage, then their sum and what was measured.
function latencyRows(data) {
  const {stages, sum_ms, total_ms} = data.latency;
  const row = (name, values) => [name, ...data.order.map((c) => values[c])];
  return [["stage_ms", ...data.order.map((c) => data.controllers[c].name)],
    ...stages.map((stage) => row(stage.help, stage.ms)), row("sum", sum_ms), row("end to end", total_ms)];
}

function drawLatency(data) {
  const {stages, sum_ms, total_ms} = data.latency;
  const table = byId("latency-table");
  const largest = Math.max(...stages.flatMap((stage) => stage.ms.map((value) => value ?? 0)));
  table.style.setProperty("--controllers", data.controllers.length);
  table.replaceChildren(
    element("thead", {}, element("tr", {}, element("th", {scope: "col"},
      element("span", {class: "hidden-text"}, "Stage")),
      ...data.order.map((c) => controllerHead(data, c)))),
    element("tbody", {},
      ...stages.map((stage) => latencyRow(data, capital(stage.help), stage.ms, largest, false)),
      latencyRow(data, "Sum of the stages", sum_ms, largest, true),
      latencyRow(data, "Measured from end to end", total_ms, largest, true)));
  byId("latency-note").textContent =
    "Where the delay comes from: each stage measured by itself, below 6 Hz, so that it is the delay " +
    "of the motion and not of its noise; means over the channels that move" +
    (data.seeds.length > 1 ? `, seed ${data.seeds[0]}.` : ".");
}
