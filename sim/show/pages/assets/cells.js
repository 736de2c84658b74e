// Brings the drawings of a page of many settings to life; they stand there without it.

function showPoint(points, number) {
  const point = points[number];
  byId("point-choice").value = String(number);
  byId("point-name").textContent = point.name;
  byId("point-yaml").textContent = point.yaml;
  byId("point-command").textContent = point.command;
  byId("point-scores").replaceChildren(...Object.entries(point.scores ?? {}).flatMap(([key, value]) => {
    const {name, unit} = metricName(key);
    return [element("dt", {}, name), element("dd", {}, `${formatNumber(value)} ${unit}`)];
  }));
  for (const shape of document.querySelectorAll("[data-point]")) {
    shape.classList.toggle("chosen", shape.dataset.point === String(number));
  }
  const line = document.querySelector(`.parallel path[data-point="${number}"]`);
  if (line) line.parentNode.insertBefore(line, line.parentNode.querySelector("line.axis"));
}

function startPoints(points) {
  const choice = byId("point-choice");
  choice.append(...points.map((point, i) => element("option", {value: i}, point.name)));
  choice.addEventListener("change", () => showPoint(points, Number(choice.value)));
  document.addEventListener("click", (event) => {
    const shape = event.target.closest("[data-point]");
    if (!shape) return;
    showPoint(points, Number(shape.dataset.point));
    byId("point").scrollIntoView();
  });
  showPoint(points, 0);
}

// One heat map at a time.
function startHeatMaps() {
  const figures = [...document.querySelectorAll(".heat-figure")];
  if (figures.length < 2) return;
  const choice = byId("heat-pair");
  choice.append(...figures.map((figure, i) => element("option", {value: i}, figure.dataset.name)));
  const show = () => figures.forEach((figure, i) => { figure.hidden = i !== Number(choice.value); });
  choice.addEventListener("change", show);
  byId("heat-controls").hidden = false;
  show();
}

// Ranges on the axes of the parallel coordinates: a point outside of one of them fades everywhere.
class Brushes {
  constructor(points) {
    this.points = points;
    this.ranges = new Map();  // axis -> [low, high] as places
    this.svg = document.querySelector(".parallel");
    for (const place of this.svg.querySelectorAll(".brush-place")) this.follow(place);
    byId("brush-none").addEventListener("click", () => {
      this.ranges.clear();
      this.svg.querySelectorAll(".brush").forEach((brush) => brush.remove());
      this.show();
    });
    this.show();
  }

  follow(place) {
    const axis = Number(place.dataset.axis);
    let from = null;
    const at = (event) => {
      const box = place.getBoundingClientRect();
      return Math.min(1, Math.max(0, (box.bottom - event.clientY) / box.height));
    };
    place.addEventListener("pointerdown", (event) => {
      from = at(event);
      place.setPointerCapture(event.pointerId);
    });
    place.addEventListener("pointermove", (event) => {
      if (from !== null) this.set(axis, place, from, at(event));
    });
    const end = (event) => {
      if (from !== null && Math.abs(at(event) - from) < 0.01) this.set(axis, place, 0, 0);
      from = null;
    };
    place.addEventListener("pointerup", end);
    place.addEventListener("pointercancel", () => { from = null; });
  }

  set(axis, place, a, b) {
    const [low, high] = a < b ? [a, b] : [b, a];
    this.svg.querySelector(`.brush[data-of="${axis}"]`)?.remove();
    if (high > low) {
      const height = Number(place.getAttribute("height"));
      place.before(element("rect", {class: "brush", "data-of": axis, width: 20,
        x: Number(place.getAttribute("x")) + 8, height: (high - low) * height,
        y: Number(place.getAttribute("y")) + (1 - high) * height}));
      this.ranges.set(axis, [low, high]);
    } else {
      this.ranges.delete(axis);
    }
    this.show();
  }

  passes(point) {
    return [...this.ranges].every(([axis, [low, high]]) => {
      const place = point.places[axis];
      return place !== null && place >= low - 5e-4 && place <= high + 5e-4;
    });
  }

  show() {
    const passes = this.points.map((point) => this.passes(point));
    for (const shape of document.querySelectorAll(".parallel path, .front circle")) {
      shape.classList.toggle("off", !passes[Number(shape.dataset.point)]);
    }
    byId("brushed").textContent =
      `${passes.filter(Boolean).length} of ${this.points.length} settings`;
    byId("brush-none").hidden = this.ranges.size === 0;
  }
}

// Each drawing saves as it stands; its numbers are in the CSV beside the page.
function startSaving() {
  const scenario = byId("title").textContent.replace(/[^\w.-]+/g, "_").replace(/_+$/, "");
  const seen = new Map();
  for (const svg of document.querySelectorAll("main svg[role=img]")) {
    const kind = svg.classList[0];
    seen.set(kind, (seen.get(kind) ?? 0) + 1);
    const name = seen.get(kind) > 1 ? `${kind}_${seen.get(kind)}` : kind;
    (svg.closest(".scroll") ?? svg).after(saveButtons({scenario}, name, () => svg, null));
  }
}

function startCells() {
  const points = JSON.parse(byId("data").textContent);
  document.documentElement.classList.add("scripts");
  startHeatMaps();
  startSaving();
  if (points.length === 0) return;
  startPoints(points);
  new Brushes(points);
}

startCells();
