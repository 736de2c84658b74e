// Figures of lines as SVG, and saving of any figure: as it stands, and what it is made of as CSV.

const FIGURE_MARGIN = {left: 62, right: 16, top: 12, bottom: 46};

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

function logTicks(low, high) {
  const values = [];
  for (let power = Math.floor(Math.log10(low)); 10 ** power <= high; ++power) {
    for (const digit of [1, 2, 5]) {
      const value = digit * 10 ** power;
      if (value >= low * 0.999 && value <= high * 1.001) values.push(value);
    }
  }
  return values;
}

// An axis {label, low, high, log} that runs from `begin` to `end` in pixels.
function scaleOf({low, high, log}, begin, end) {
  const f = log ? Math.log10 : (v) => v;
  return (value) => begin + (f(value) - f(low)) / (f(high) - f(low)) * (end - begin);
}

function axisTicks(axis, wanted) {
  if (axis.log) return logTicks(axis.low, axis.high).map((value) => [value, String(Number(value.toPrecision(3)))]);
  const {values, decimals} = ticks(axis.low, axis.high, wanted);
  return values.map((value) => [value, value.toFixed(decimals).replace("-", "−")]);
}

// Lines over one another: {points: [[x, y]..], colour, dash, width, name}. A gap is a point without y.
// Behind them bands [[from, to]..] of x.
function lineFigure({width, height, x: x_axis, y: y_axis, lines, label, bands = []}) {
  const right = width - FIGURE_MARGIN.right;
  const bottom = height - FIGURE_MARGIN.bottom;
  const x = scaleOf(x_axis, FIGURE_MARGIN.left, right);
  const y = scaleOf(y_axis, bottom, FIGURE_MARGIN.top);
  const inside = (px) => Math.min(bottom, Math.max(FIGURE_MARGIN.top, px)).toFixed(1);
  const shapes = [];
  for (const [from, to] of bands) {
    const [left, end] = [Math.max(from, x_axis.low), Math.min(to, x_axis.high)];
    if (end <= left) continue;
    shapes.push(element("rect", {class: "band", x: x(left), width: x(end) - x(left), y: FIGURE_MARGIN.top,
      height: bottom - FIGURE_MARGIN.top}));
  }
  for (const [value, text] of axisTicks(y_axis, 5)) {
    shapes.push(element("line", {class: "grid", x1: FIGURE_MARGIN.left, x2: right, y1: y(value), y2: y(value)}),
      element("text", {x: FIGURE_MARGIN.left - 10, y: y(value) + 4, "text-anchor": "end"}, text));
  }
  for (const [value, text] of axisTicks(x_axis, width < 500 ? 5 : 9)) {
    shapes.push(element("text", {x: x(value), y: bottom + 20, "text-anchor": "middle"}, text));
  }
  shapes.push(
    element("text", {x: (FIGURE_MARGIN.left + right) / 2, y: bottom + 40, "text-anchor": "middle"}, x_axis.label),
    element("text", {x: 0, y: 0, "text-anchor": "middle",
      transform: `translate(13 ${(FIGURE_MARGIN.top + bottom) / 2}) rotate(-90)`}, y_axis.label));
  for (const line of lines) {
    let path = "";
    let pen = "M";
    for (const [px, py] of line.points) {
      if (!Number.isFinite(py)) { pen = "M"; continue; }
      path += `${pen}${x(px).toFixed(1)} ${inside(y(py))}`;
      pen = "L";
    }
    shapes.push(element("path", {d: path, style: `fill: none; stroke: ${line.colour}; ` +
      `stroke-width: ${line.width ?? 1.6};` + (line.dash ? `stroke-dasharray: ${line.dash.join(" ")}` : "")}));
  }
  return element("svg", {class: "figure", viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": label},
    ...shapes);
}

// Names and colours of the controllers, as one line of text below or above a figure.
function controllersLegend(data) {
  return data.order.map((c) => element("span", {class: "item"}, ...controllerLabel(data, c)));
}

// --- saving -----------------------------------------------------------------------------------

const SAVED_STYLES = ["fill", "stroke", "stroke-width", "stroke-dasharray", "opacity", "font-size",
  "font-weight", "font-family", "paint-order", "stroke-linejoin"];

// As text that stands alone: with the page's styles and ground.
function svgText(svg) {
  const copy = svg.cloneNode(true);
  const own = svg.querySelectorAll("*");
  copy.querySelectorAll("*").forEach((node, i) => {
    const style = getComputedStyle(own[i]);
    node.style.cssText = SAVED_STYLES.map((name) => `${name}: ${style.getPropertyValue(name)}`).join("; ");
  });
  const box = svg.viewBox.baseVal;
  copy.setAttribute("width", box.width);
  copy.setAttribute("height", box.height);
  copy.prepend(element("rect", {width: box.width, height: box.height, style: `fill: ${resolvedColour("var(--ground)")}`}));
  return new XMLSerializer().serializeToString(copy);
}

function saveFile(name, type, parts) {
  const address = URL.createObjectURL(new Blob(parts, {type}));
  element("a", {href: address, download: name}).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

async function savePng(name, svg) {
  const image = new Image();
  await new Promise((drawn, failed) => {
    image.onload = drawn;
    image.onerror = failed;
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svgText(svg))}`;
  });
  const canvas = element("canvas", {width: 2 * image.width, height: 2 * image.height});
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  canvas.toBlob((blob) => saveFile(name, "image/png", [blob]));
}

function csvText(rows) {
  const field = (value) => {
    const text = value === null || value === undefined || Number.isNaN(value) ? "" : String(value);
    return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  return rows.map((row) => row.map(field).join(",")).join("\n") + "\n";
}

// Below a figure: buttons that save it. `figure()` gives the SVG, none for a table; `rows()` the data,
// none where another file has them.
function saveButtons(data, name, figure, rows) {
  const file = `${data.scenario}.${name}`;
  const button = (kind, save) => element("button", {type: "button", title: `Save as ${file}.${kind.toLowerCase()}`,
    "aria-label": `Save ${name} as ${kind}`, onclick: save}, kind);
  return element("p", {class: "save"}, "Save as ", ...(figure ? [
    button("SVG", () => saveFile(`${file}.svg`, "image/svg+xml", [svgText(figure())])),
    button("PNG", () => savePng(`${file}.png`, figure()))] : []),
    ...(rows ? [button("CSV", () => saveFile(`${file}.csv`, "text/csv", [csvText(rows())]))] : []));
}
