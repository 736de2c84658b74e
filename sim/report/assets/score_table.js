// The scores: a row per metric, a column per controller.

function spreadText(estimate) {
  const half = 0.5 * (estimate[2] - estimate[1]);
  return estimate[1] === null || estimate[2] === null ? "" : ` ± ${formatNumber(half)}`;
}

// Where some seeds have no such score, the mean is over the others.
function seedsText(data, estimate) {
  const count = estimate[3];
  const all = data.seeds.length;
  return count === 0 || count === all ? "" : ` ${count} of ${all} seeds`;
}

function scoreCell(data, metric, controller) {
  const c = data.controllers[controller];
  const estimate = c.summary[metric];
  const best = data.comparison && c.rank[metric] === 1 && data.controllers.length > 1;
  const worse = c.worse_than_baseline[metric] === true;
  const means = data.controllers.map((other) => other.summary[metric][0]);
  const largest = Math.max(...means.map((mean) => mean ?? 0));
  const bars = largest > 0 && means.every((mean) => mean === null || mean >= 0);
  const said = best ? "best" : worse ? `worse than ${data.baseline}` : "";
  return element("td", {class: worse ? "worse" : best ? "best" : null, title: said || null},
    element("span", {class: "value"}, formatNumber(estimate[0])),
    data.comparison ? element("span", {class: "spread"}, spreadText(estimate),
      seedsText(data, estimate)) : null,
    element("span", {class: "mark", "aria-hidden": "true"}, worse ? "▲" : best ? "★" : ""),
    said ? element("span", {class: "hidden-text"}, ` (${said})`) : null,
    bars && estimate[0] !== null
      ? element("span", {class: "bar", style:
          `width: calc((100% - 0.95em) * ${(estimate[0] / largest).toFixed(4)}); ` +
          `--colour: ${colourName(controller)}`})
      : null);
}

// Below an opened row: how the score is defined, and each controller's paired difference to the
// baseline.
function definitionRow(data, metric, id) {
  const {key, definition} = data.metrics[metric];
  const row = element("tr", {class: "definition", id, hidden: true},
    element("th", {scope: "row"}, definition, element("br"), element("code", {}, key)));
  for (const controller of data.controllers) {
    const difference = controller.difference_to_baseline[metric];
    const cell = element("td");
    if (difference && difference[0] !== null) {
      const sign = difference[0] > 0 ? "+" : "";
      cell.append(`${sign}${formatNumber(difference[0])} to ${data.baseline}`);
      if (data.comparison && difference[1] !== null) {
        cell.append(element("br"),
          `[${formatNumber(difference[1])}, ${formatNumber(difference[2])}]`);
      }
      const effect = controller.effect_size[metric];
      if (data.comparison && effect !== null && effect !== undefined) {
        cell.append(element("br"), `effect size ${formatNumber(effect)}`);
      }
    }
    row.append(cell);
  }
  return row;
}

function metricRows(data, metric) {
  const {help, definition, main} = data.metrics[metric];
  const {name, unit} = metricName(data.metrics[metric].key);
  const id = `definition-${metric}`;
  const definitionOfRow = definitionRow(data, metric, id);
  const row = element("tr", {"data-main": main ? "yes" : "no"});
  const button = element("button", {
    type: "button", class: "explain", "aria-expanded": "false", "aria-controls": id,
    title: definition,
    onclick: () => {
      definitionOfRow.hidden = !definitionOfRow.hidden;
      button.setAttribute("aria-expanded", String(!definitionOfRow.hidden));
      row.classList.toggle("open", !definitionOfRow.hidden);
    }}, name, " ", element("span", {class: "unit"}, unit));
  row.append(element("th", {scope: "row"}, button, element("span", {class: "help"}, help)));
  data.controllers.forEach((_, c) => row.append(scoreCell(data, metric, c)));
  return [row, definitionOfRow];
}

function controllerHead(data, c) {
  const controller = data.controllers[c];
  const tags = [controller.baseline ? "baseline" : "", controller.problem ? "stopped early" : ""];
  return element("th", {scope: "col"}, ...controllerLabel(data, c),
    ...tags.filter(Boolean).map((tag) => element("span", {class: "tag"}, tag)));
}

function showOtherMetrics(table, shown) {
  for (const row of table.querySelectorAll('tr[data-main="no"]')) {
    row.hidden = !shown;
    if (!shown && row.classList.contains("open")) row.querySelector("button").click();
  }
}

function drawScoreTable(data) {
  const table = byId("scores-table");
  table.style.setProperty("--controllers", data.controllers.length);
  const has_score = (m) => data.controllers.some((c) => c.summary[m][0] !== null);
  const metrics = data.metrics.map((_, m) => m).filter(has_score);
  metrics.sort((a, b) => data.metrics[b].main - data.metrics[a].main || a - b);
  table.append(
    element("thead", {}, element("tr", {}, element("th", {scope: "col"},
      element("span", {class: "hidden-text"}, "Score")),
      ...data.controllers.map((_, c) => controllerHead(data, c)))),
    element("tbody", {}, ...metrics.flatMap((m) => metricRows(data, m))));

  const others = metrics.filter((m) => !data.metrics[m].main).length;
  const more = byId("scores-more");
  let shown = false;
  const update = () => {
    showOtherMetrics(table, shown);
    more.textContent = shown ? "Fewer scores" : `${others} more scores`;
    more.setAttribute("aria-expanded", String(shown));
  };
  more.hidden = others === 0;
  more.addEventListener("click", () => { shown = !shown; update(); });
  update();

  byId("scores-note").textContent = data.comparison
    ? `Means over ${data.seeds.length} seeds, ± half of the 95 % interval; averaged over joints, ` +
      "motors or cables. Each score opens its definition" +
      (data.baseline ? ` and the paired difference to ${data.baseline}.` : ".")
    : "One run: nothing is said about chance. Averaged over joints, motors or cables. " +
      "Each score opens its definition.";
  const worse = data.controllers.some((c) => c.worse_than_baseline.includes(true));
  const stars = data.comparison && data.controllers.length > 1 ? "★ best" : "";
  byId("scores-legend").textContent = stars + (worse
    ? `\u2003▲ worse than ${data.baseline}: the whole interval of the paired difference says so`
    : "");
}
