// The scores: a row per metric, a column per controller.

// As many digits as the interval allows: the rule of the terminal's table.
function differenceText({mean, low, high}) {
  if (mean === null) return "";
  const sign = mean < 0 ? "−" : "+";
  const half = 0.5 * (high - low);
  if (low === null || half === 0) return sign + formatNumber(Math.abs(mean));
  const decimals = Math.min(Math.max(1 - Math.floor(Math.log10(half)), 0), 3);
  return `${sign}${Math.abs(mean).toFixed(decimals)} ±\u00a0${half.toFixed(decimals)}`;
}

// Where some seeds have no such score, the mean is over the others.
function seedsText(data, estimate) {
  const count = estimate[3];
  const all = data.seeds.length;
  return data.blocks || count === 0 || count === all ? "" : ` ${count} of ${all} seeds`;
}

function scoreCell(data, metric, controller) {
  const c = data.controllers[controller];
  const estimate = c.summary[metric];
  const mark = c.marks[metric].trim();
  const kind = {"*": "better", "!": "worse"}[mark] ?? null;
  const said = mark ? `${c.to_baseline[metric].verdict}, compared with ${data.baseline}` : "";
  const means = data.controllers.map((other) => other.summary[metric][0]);
  const largest = Math.max(...means.map((mean) => mean ?? 0));
  const bars = largest > 0 && means.every((mean) => mean === null || mean >= 0);
  const spread = data.comparison && c.to_baseline.length ? differenceText(c.to_baseline[metric]) : "";
  return element("td", {class: kind, title: said || null},
    element("span", {class: "value"}, formatNumber(estimate[0])),
    element("span", {class: "mark", "aria-hidden": "true"}, mark),
    said ? element("span", {class: "hidden-text"}, ` (${said})`) : null,
    data.comparison ? element("span", {class: "spread"}, spread,
      c.failed_trials ? "" : seedsText(data, estimate)) : null,
    bars && estimate[0] !== null
      ? element("span", {class: "bar", style:
          `width: calc((100% - 0.95em) * ${(estimate[0] / largest).toFixed(4)}); ` +
          `--colour: ${colourName(controller)}`})
      : null);
}

// "[0.31, 0.52] at 99.97 %: worse"
function comparisonText({low, high, level, verdict}) {
  if (low === null) return verdict;
  const percent = (100 * level).toFixed(Math.max(0, Math.ceil(-Math.log10(1 - level)) - 1));
  return `[${formatNumber(low)}, ${formatNumber(high)}] at ${percent} %: ${verdict}`;
}

// Below an opened row: how the score is defined, what difference matters, and each controller's
// paired differences with their intervals.
function definitionRow(data, metric, id) {
  const {key, definition, relevant_reason} = data.metrics[metric];
  const row = element("tr", {class: "definition", id, hidden: true},
    element("th", {scope: "row"}, definition, element("br"), element("code", {}, key),
      element("br"), `Smallest relevant difference: ${relevant_reason}.`));
  for (const controller of data.order.map((c) => data.controllers[c])) {
    const cell = element("td");
    const difference = controller.to_baseline[metric];
    if (difference && difference.mean !== null) {
      const sign = difference.mean > 0 ? "+" : "";
      cell.append(`${sign}${formatNumber(difference.mean)} to ${data.baseline}`);
      if (data.comparison && difference.verdict) {
        cell.append(element("br"), comparisonText(difference), element("br"),
          `smallest relevant difference: ${formatNumber(difference.relevant_difference)}`);
      }
    }
    const effect = controller.effect_size[metric];
    if (data.comparison && effect !== null && effect !== undefined) {
      cell.append(element("br"), `effect size ${formatNumber(effect)}`);
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
  const sort = element("button", {type: "button", class: "sort", "aria-label": `Order by ${name}`,
    title: "Order the columns by this score", onclick: () => data.orderBy(metric)}, "⇤");
  row.append(element("th", {scope: "row"}, sort, button, element("span", {class: "help"}, help)));
  data.order.forEach((c) => row.append(scoreCell(data, metric, c)));
  return [row, definitionOfRow];
}

// A table with a column per controller. A row has a label, the text and perhaps a bar of each controller, and may be a sum.
function drawPartTable(id, data, corner, rows) {
  const table = byId(id);
  table.style.setProperty("--controllers", data.controllers.length);
  table.replaceChildren(
    element("thead", {}, element("tr", {}, element("th", {scope: "col"}, element("span", {class: "hidden-text"}, corner)),
      ...data.order.map((c) => controllerHead(data, c)))),
    element("tbody", {}, ...rows.map(({label, text, bar, sum}) => element("tr", {class: sum ? "sum" : null},
      element("th", {scope: "row"}, ...label),
      ...data.order.map((c) => element("td", {}, element("span", {class: "value"}, text(c)),
        element("span", {class: "mark"}), bar?.(c)))))));
}

function controllerHead(data, c) {
  const controller = data.controllers[c];
  const tags = [controller.baseline ? "baseline" : "", controller.failed_trials ? "failed, not ranked" : ""];
  return element("th", {scope: "col"}, ...controllerLabel(data, c),
    ...tags.filter(Boolean).map((tag) => element("span", {class: "tag"}, tag)));
}

function showOtherMetrics(table, shown) {
  for (const row of table.querySelectorAll('tr[data-main="no"]')) {
    row.hidden = !shown;
    if (!shown && row.classList.contains("open")) row.querySelector("button").click();
  }
}

// The columns of all tables: as the verdict has them, or by a score.
function startOrder(data, redraw) {
  const button = byId("scores-order");
  const verdict = data.order;
  data.orderBy = (metric) => {
    const sign = data.metrics[metric].lower_is_better ? 1 : -1;
    const value = (c) => {
      const mean = data.controllers[c].summary[metric][0];
      return mean === null ? Infinity : sign * mean;
    };
    data.order = [...verdict].sort((a, b) => (value(a) < value(b) ? -1 : value(a) > value(b) ? 1 : 0));
    button.hidden = false;
    redraw();
  };
  button.addEventListener("click", () => {
    data.order = verdict;
    button.hidden = true;
    redraw();
  });
}

function scoreRows(data) {
  return [["score", ...data.order.map((c) => data.controllers[c].name)],
    ...data.metrics.map(({key}, m) => [key, ...data.order.map((c) => data.controllers[c].summary[m][0])])];
}

function drawScoreTable(data) {
  const table = byId("scores-table");
  table.style.setProperty("--controllers", data.controllers.length);
  const has_score = (m) => data.controllers.some((c) => c.summary[m][0] !== null);
  const metrics = data.metrics.map((_, m) => m).filter(has_score);
  metrics.sort((a, b) => data.metrics[b].main - data.metrics[a].main || a - b);
  table.replaceChildren(
    element("thead", {}, element("tr", {}, element("th", {scope: "col"},
      element("span", {class: "hidden-text"}, "Score")),
      ...data.order.map((c) => controllerHead(data, c)))),
    element("tbody", {}, ...metrics.flatMap((m) => metricRows(data, m))));

  const others = metrics.filter((m) => !data.metrics[m].main).length;
  const more = byId("scores-more");
  const update = () => {
    const shown = more.getAttribute("aria-expanded") === "true";
    showOtherMetrics(table, shown);
    more.textContent = shown ? "Fewer scores" : `${others} more scores`;
  };
  more.hidden = others === 0;
  more.onclick = () => {
    more.setAttribute("aria-expanded", String(more.getAttribute("aria-expanded") !== "true"));
    update();
  };
  update();

  byId("scores-note").textContent = [
    data.blocks ? `Confidence intervals from ${data.blocks} of this recording.`
      : data.comparison ? `Means over ${data.seeds.length} seeds.` : "One run.",
    "Averaged over joints, motors or cables. Each score opens its definition."].join(" ");
  byId("scores-facts").append(...data.notes.map((note) => element("li", {}, note)));
  byId("scores-legend").textContent = data.legend;
}
