// Joints, motors or cables x controllers for one score. The worst cell of the map is the warmest.

const HEAT_MOST_PERCENT = 80;  // the text stays readable on the warmest cell

function heatCell(value, low, high, lower_is_better) {
  let share = 0;
  if (value !== null && high > low) {
    share = lower_is_better ? (value - low) / (high - low) : (high - value) / (high - low);
  }
  return element("td", {style: `--share: ${(share * HEAT_MOST_PERCENT).toFixed(1)}%`},
    formatNumber(value));
}

function drawHeatMap(data, metric, onChannel) {
  const values = data.controllers.flatMap((c) => c.rows.map((row) => row[metric]))
    .filter((value) => value !== null);
  // Only what has this score: cables have no tracking error.
  const rows = data.rows.map((_, row) => row)
    .filter((row) => data.controllers.some((c) => c.rows[row][metric] !== null));
  const low = Math.min(...values);
  const high = Math.max(...values);
  const {lower_is_better} = data.metrics[metric];
  byId("heat-scale").replaceChildren(
    lower_is_better ? formatNumber(low) : formatNumber(high), element("i"),
    `${formatNumber(lower_is_better ? high : low)} ${metricName(data.metrics[metric].key).unit}`);
  const map = byId("heat-map");
  map.style.setProperty("--controllers", data.controllers.length);
  map.replaceChildren(
    element("thead", {}, element("tr", {}, element("td"),
      ...data.order.map((c) => element("th", {scope: "col"}, ...controllerLabel(data, c))))),
    element("tbody", {}, ...rows.map((row) => element("tr", {"data-channel": data.rows[row]},
      element("th", {scope: "row"}, heatName(data, data.rows[row], onChannel)),
      ...data.order.map((c) =>
        heatCell(data.controllers[c].rows[row][metric], low, high, lower_is_better))))));
}

// A joint leads to its curves; motors and cables have none.
function heatName(data, name, onChannel) {
  if (!data.channels.includes(name)) return name;
  return element("button", {type: "button", title: `Show the curves of ${name}`,
    onclick: () => onChannel(name)}, name);
}

function markChannel(name) {
  for (const row of byId("heat-map").querySelectorAll("tbody tr")) {
    row.classList.toggle("chosen", row.dataset.channel === name);
  }
}

function startHeatMap(data, onChannel) {
  const select = byId("heat-metric");
  addScores(select, data, (_, m) => data.controllers.some((c) => c.rows.some((row) => row[m] !== null)));
  const tracking = data.metrics.findIndex((m) => m.key === "tracking_rmse_deg");
  if (select.options.length === 0) {
    hidePart("channels");
    return () => {};
  }
  select.value = String(tracking);
  if (select.selectedIndex < 0) select.selectedIndex = 0;
  const draw = () => {
    drawHeatMap(data, Number(select.value), onChannel);
    markChannel(byId("curves-channel").value);
  };
  select.addEventListener("change", draw);
  byId("heat-map").parentElement.after(saveButtons(data, "channels", null, () => {
    const metric = Number(select.value);
    return [[data.metrics[metric].key, ...data.order.map((c) => data.controllers[c].name)],
      ...data.rows.map((name, row) => [name, ...data.order.map((c) => data.controllers[c].rows[row][metric])])];
  }));
  draw();
  return draw;
}
