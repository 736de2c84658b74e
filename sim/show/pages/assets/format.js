// Three significant digits are what the intervals usually allow: the rule of the terminal's table.
function formatNumber(value) {
  if (value === null || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const decimals = size >= 99.95 ? 0 : size >= 9.995 ? 1 : size >= 0.9995 ? 2 : 3;
  const digits = size.toFixed(decimals);
  return value < 0 && Number(digits) !== 0 ? `−${digits}` : digits;
}

// The unit is the end of a key; what is left of it names the score.
const UNITS = [
  ["_deg_s", "deg/s"], ["_deg2", "deg²"], ["_deg", "deg"], ["_mm", "mm"], ["_ms", "ms"], ["_per_s", "per s"],
  ["_hz", "Hz"], ["_n", "N"],
];
const CAPITALS = ["rms", "rmse", "sparc", "ldlj"];

function metricName(key) {
  const [ending, unit] = UNITS.find(([end]) => key.endsWith(end)) ?? ["", ""];
  const words = key.slice(0, key.length - ending.length).split("_").map(
    (word) => (CAPITALS.includes(word) ? word.toUpperCase() : word));
  words[0] = words[0][0].toUpperCase() + words[0].slice(1);
  return {name: words.join(" "), unit};
}

function metricLabel(key) {
  const {name, unit} = metricName(key);
  return unit ? `${name}, ${unit}` : name;
}

const capital = (text) => text[0].toUpperCase() + text.slice(1);

// element("td", {class: "best"}, "text", child...): text is always text, never markup.
function element(tag, attributes = {}, ...children) {
  const namespace = ["svg", "g", "path", "line", "rect", "circle", "text"].includes(tag)
    ? "http://www.w3.org/2000/svg" : "http://www.w3.org/1999/xhtml";
  const node = document.createElementNS(namespace, tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === false || value === null || value === undefined) continue;
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (name === "style") node.style.cssText = value;
    else node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

const byId = (id) => document.getElementById(id);

// Long names may break at their underscores.
function breakable(name) {
  return name.split(/(?<=_)/).flatMap((part, i) => (i ? [element("wbr"), part] : [part]));
}

// Adds the scores with this property to a choice.
function addScores(select, data, has) {
  data.metrics.forEach(({key}, m) => {
    if (has(key, m)) select.append(element("option", {value: m}, metricLabel(key)));
  });
}
