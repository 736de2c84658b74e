// Causes of the error. The tracking error without each of them is a table. Shares of the squared error
// are a stacked bar per controller as SVG, and the numbers as a table that is the legend, too.

function drawSwitched(data) {
  const {names, controllers, margins} = data.switched;
  const text = (c, i) => {
    const value = controllers[c][i];
    if (value === null) return "–";
    return value.toFixed(2) + (margins[c][i] === null ? "" : ` ±${margins[c][i].toFixed(2)}`);
  };
  const unit = element("span", {class: "unit"}, "deg RMS");
  drawPartTable("switched-table", data, "Cause", names.map((name, i) => (
    {label: i ? [capital(name)] : ["Tracking error ", name, " ", unit], sum: i === 0, text: (c) => text(c, i)})));
  byId("switched-note").textContent = "Tracking error in trials in which one cause alone is switched off" +
    (data.switched.part ? `, ${data.switched.part}` : "") + ". A lower error is better. An ideal servo also holds " +
    "against friction.";
}

function startSwitched(data) {
  const {names, controllers} = data.switched;
  byId("switched-table").parentElement.after(saveButtons(data, "causes", null, () => [
    ["controller", ...names.map((name) => `${name.replaceAll(/\W+/g, "_")}_deg`)],
    ...data.order.map((c) => [data.controllers[c].name, ...controllers[c]])]));
}

const SPLIT_ROW = 52;
const SPLIT_BAR = {top: 24, height: 22};

function splitColour(data, part) { return `var(--part${data.error_split.colours[part]})`; }

// Without the sign of what rounds to 0; null is a cause that could not be taken away.
function formatPercent(part, whole) {
  if (part === null) return "–";
  const share = part / whole;
  const percent = Math.round(100 * share);
  return `${percent < 0 ? "−" : ""}${Math.abs(percent)} %`;
}

function splitWhole(parts) { return parts.reduce((sum, part) => sum + part, 0); }

// A part below 0 takes no place.
function splitBar(data, controller, y, pixels_per_deg2) {
  const parts = data.error_split.controllers[controller];
  const shapes = [element("text", {class: "name", x: 0, y: y + 15}, data.controllers[controller].name)];
  if (!parts) return [...shapes, element("text", {x: 0, y: y + 40}, "no value")];
  const whole = splitWhole(parts);
  let x = 0;
  parts.forEach((part, i) => {
    const width = Math.max(0, part) * pixels_per_deg2;
    if (width === 0) return;
    shapes.push(element("rect", {x, y: y + SPLIT_BAR.top, width: Math.max(width - 1, 0.5),
      height: SPLIT_BAR.height, style: `fill: ${splitColour(data, i)}`}));
    if (width > 38) {
      shapes.push(element("text", {class: "share", x: x + width / 2, y: y + SPLIT_BAR.top + 15.5,
        "text-anchor": "middle"}, formatPercent(part, whole)));
    }
    x += width;
  });
  return shapes;
}

function drawErrorBars(data) {
  const place = byId("error-bars");
  const width = Math.max(280, place.clientWidth);
  const splits = data.error_split.controllers;
  const longest = Math.max(...splits.map((parts) => parts
    ? splitWhole(parts.map((part) => Math.max(0, part))) : 0));
  const height = SPLIT_ROW * splits.length;
  const said = data.order.filter((c) => splits[c]).map((c) => `${data.controllers[c].name}: ` +
    splits[c].map((part, i) => `${data.error_split.parts[i]} ` +
      formatPercent(part, splitWhole(splits[c]))).join(", ")).join("; ");
  place.replaceChildren(element("svg", {viewBox: `0 0 ${width} ${height}`, height, role: "img",
      "aria-label": `Causes of the squared error. ${said}`},
    ...data.order.flatMap((c, i) => splitBar(data, c, SPLIT_ROW * i, width / longest))));
}

function drawErrorTable(data) {
  const {parts, controllers} = data.error_split;
  const row = (label, text, sum) => ({label, sum, text: (c) => (controllers[c] ? text(controllers[c]) : "–")});
  drawPartTable("error-table", data, "Cause", [
    ...parts.map((part, i) => row(
      [element("span", {class: "swatch", style: `--colour: ${splitColour(data, i)}`}), capital(part)],
      (split) => formatPercent(split[i], splitWhole(split)), false)),
    row(["Squared error ", element("span", {class: "unit"}, "deg²")],
      (split) => formatNumber(splitWhole(split)), true)]);
}

function drawErrorSplit(data) {
  drawErrorTable(data);
  drawErrorBars(data);
}

function startErrorSplit(data) {
  const {parts, controllers} = data.error_split;
  byId("error-bars").after(saveButtons(data, "error", () => byId("error-bars").querySelector("svg"), () => [
    ["controller", ...parts.map((part) => `${part.replaceAll(/\W+/g, "_")}_deg2`)],
    ...data.order.map((c) => [data.controllers[c].name, ...(controllers[c] ?? parts.map(() => null))])]));
}
