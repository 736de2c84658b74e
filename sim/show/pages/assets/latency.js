// Where the delay comes from: a row per stage, a column per controller.

// For a file: a row per stage, then their sum and what was measured.
function latencyRows(data) {
  const {stages, sum_ms, total_ms} = data.latency;
  const row = (name, values) => [name, ...data.order.map((c) => values[c])];
  return [["stage_ms", ...data.order.map((c) => data.controllers[c].name)],
    ...stages.map((stage) => row(stage.help, stage.ms)), row("sum", sum_ms), row("end to end", total_ms)];
}

function drawLatency(data) {
  const {stages, sum_ms, total_ms} = data.latency;
  const largest = Math.max(...stages.flatMap((stage) => stage.ms.map((value) => value ?? 0)));
  const row = (label, values, sum) => ({label: [label, " ", element("span", {class: "unit"}, "ms")], sum,
    text: (c) => formatNumber(values[c]),
    bar: (c) => (values[c] > 0 && !sum ? element("span", {class: "bar", style: `--colour: ${colourName(c)}; ` +
      `width: calc((100% - 0.95em) * ${(values[c] / largest).toFixed(4)})`}) : null)});
  drawPartTable("latency-table", data, "Stage", [
    ...stages.map((stage) => row(capital(stage.help), stage.ms, false)),
    row("Sum of the stages", sum_ms, true), row("Measured from end to end", total_ms, true)]);
  byId("latency-note").textContent =
    "Where the delay comes from: each stage measured by itself, below 6 Hz, so that it is the delay " +
    "of the motion and not of its noise; means over the channels that move" +
    (data.seeds.length > 1 ? `, seed ${data.seeds[0]}.` : ".");
}
