// The page of a running session. The program sends a moment 50 times a second; what is shown is made of those of the
// last seconds.

const SHOWN_S = 10;
const STALE_MS = 1500;
const PLOT_EVERY_MS = 100;
const TIERS = ["follow", "hold", "relax", "off"];

class LivePage extends HandScene {
  constructor(data) {
    super(byId("live-canvas"), data.hand, byId("live-note"));
    this.data = data;
    this.token = new URLSearchParams(location.search).get("token") ?? "";
    this.moments = [];
    this.stages = [];  // {time_s, ms: [of each stage]}
    this.plotted_ms = 0;
    this.ended = false;
    this.hand = new ReplayHand(data.hand);
    this.picture.add(this.hand, {opaque: true});
    this.placeCamera(this.hand, [data.joints.map(() => 0), data.rest_deg]);
    this.hand.pose(data.rest_deg);
    this.makeChoice();
    byId("live-still").addEventListener("click", () => this.post("mark", this.last?.is_still ? "moving" : "still"));
    byId("live-joint").append(...data.joints.map((name, j) => element("option", {value: j}, name)));
    byId("live-joint").addEventListener("change", () => this.draw(true));
    this.makeLegend();
    new ResizeObserver(() => this.draw(true)).observe(this.canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw(true));
    this.say("Waiting for the session.", false);
    this.listen();
    setInterval(() => this.watchAge(), 250);
    this.draw(true);
  }

  // --- what arrives ------------------------------------------------------------------------------

  listen() {
    const events = new EventSource(`events?token=${encodeURIComponent(this.token)}`);
    events.addEventListener("message", ({data}) => {
      const moment = JSON.parse(data);
      if (!moment.has_ended) return this.take(moment);
      events.close();
      this.ended = true;
      this.say("The session has ended.", true);
      this.setChoice(-1);
    });
  }

  take(moment) {
    if (this.moments.length && moment.time_s < this.moments[this.moments.length - 1].time_s) {
      this.moments = [];  // another session
      this.stages = [];
    }
    this.moments.push(moment);
    for (const ms of moment.stages_ms) this.stages.push({time_s: moment.time_s, ms});
    const old = (list) => {
      const keep = list.findIndex(({time_s}) => time_s >= moment.time_s - SHOWN_S);
      if (keep > 0) list.splice(0, keep);
    };
    old(this.moments);
    old(this.stages);
    this.arrived_ms = performance.now();
    this.hand.pose(moment.hand_deg.map((angle) => angle ?? 0));
    this.draw(false);
  }

  get last() { return this.moments[this.moments.length - 1]; }

  watchAge() {
    if (this.ended || !this.arrived_ms) return;
    const age_ms = performance.now() - this.arrived_ms;
    if (age_ms > STALE_MS) this.say(`No data for ${(age_ms / 1e3).toFixed(0)} s: the program has ended or stands still.`, true);
    else this.say(`${this.data.controllers[this.last.driving]} drives the ${this.data.has_motors ? "motors" : "simulated hand"}.`, false);
  }

  say(text, stale) {
    const state = byId("live-state");
    state.classList.toggle("stale", stale);
    if (state.textContent !== text) state.textContent = text;  // it is read aloud
  }

  // --- the choice --------------------------------------------------------------------------------

  makeChoice() {
    byId("live-choice").append(...this.data.controllers.map((name) =>
      element("button", {type: "button", "aria-pressed": "false", onclick: () => this.post("switch", name)}, ...breakable(name))));
    this.setChoice(0);
    if (this.data.controllers.length === 1) byId("live-answer").textContent = "--shadow NAME,.. adds controllers to choose from.";
  }

  setChoice(driving) {
    [...byId("live-choice").children].forEach((button, i) => {
      const pressed = String(i === driving);
      if (button.getAttribute("aria-pressed") !== pressed) button.setAttribute("aria-pressed", pressed);
      button.disabled = this.ended;
    });
    byId("live-still").setAttribute("aria-pressed", String(Boolean(this.last?.is_still)));
    byId("live-still").disabled = this.ended;
  }

  async post(path, body) {
    const answer = byId("live-answer");
    try {
      const response = await fetch(`${path}?token=${encodeURIComponent(this.token)}`, {method: "POST", body});
      const text = (await response.text()).trim();
      answer.textContent = response.ok ? `${capital(text)}.` : text;
    } catch (error) {
      answer.textContent = "The program does not answer.";
    }
  }

  // --- what is shown -----------------------------------------------------------------------------

  // The hand once per frame of the screen, figures and numbers less often.
  draw(at_once) {
    if (at_once) this.plotted_ms = 0;
    if (this.frame) return;
    this.frame = requestAnimationFrame((now_ms) => {
      this.frame = 0;
      this.drawNow();
      if (!this.last || now_ms - this.plotted_ms < PLOT_EVERY_MS) return;
      this.plotted_ms = now_ms;
      this.setChoice(this.ended ? -1 : this.last.driving);
      this.drawFacts();
      this.drawCurves();
      this.drawLatency();
    });
  }

  makeLegend() {
    byId("live-legend").append(...[["glove", "--glove"], ["command", "--command"], ["hand", "--c1"]].map(([name, colour]) =>
      element("span", {}, element("span", {class: "dot", style: `--colour: var(${colour})`}), name)));
  }

  width(place) { return Math.max(280, Math.round(place.clientWidth)); }

  drawCurves() {
    const joint = Number(byId("live-joint").value);
    const channel = this.data.channels.indexOf(this.data.joints[joint]);
    const end_s = Math.max(SHOWN_S, this.last.time_s);
    const lines = [
      {colour: "var(--glove)", width: 1, of: ({glove_deg}) => (channel < 0 ? null : glove_deg[channel])},
      {colour: "var(--command)", dash: [4, 3], of: ({command_deg}) => command_deg[joint]},
      {colour: "var(--c1)", width: 2, of: ({hand_deg}) => hand_deg[joint]},
    ].map((line) => ({...line, points: this.moments.map((m) => [m.time_s, line.of(m) ?? NaN])}));
    const values = lines.flatMap(({points}) => points.map(([, y]) => y)).filter(Number.isFinite);
    const [low, high] = values.length ? [Math.min(...values), Math.max(...values)] : [0, 1];
    const room = Math.max(5, 0.08 * (high - low));
    const place = byId("live-plot");
    place.replaceChildren(lineFigure({width: this.width(place), height: 260, lines,
      x: {label: "time [s]", low: end_s - SHOWN_S, high: end_s},
      y: {label: "joint angle [deg]", low: low - room, high: high + room},
      label: `Glove, command and hand of ${this.data.joints[joint]} in the last ${SHOWN_S} seconds`}));
  }

  drawLatency() {
    if (!this.stages.length) return;
    const means = this.data.stages.map((_, i) => this.stages.reduce((sum, {ms}) => sum + ms[i], 0) / this.stages.length);
    const totals = this.stages.map(({ms}) => ms.reduce((sum, part) => sum + part, 0)).sort((a, b) => a - b);
    const quantile = (share) => totals[Math.min(totals.length - 1, Math.ceil(share * totals.length) - 1)];
    byId("live-total").textContent = `Last ${SHOWN_S} s, ${totals.length} commands: median ${formatNumber(quantile(0.5))} ms, ` +
      `99 % below ${formatNumber(quantile(0.99))} ms, largest ${formatNumber(totals[totals.length - 1])} ms.`;
    this.drawHistogram(totals);
    const largest = Math.max(...means, 1e-9);
    byId("live-stages").replaceChildren(
      element("thead", {}, element("tr", {}, element("th", {class: "words", scope: "col"}, "Stage"), element("th", {}),
        element("th", {scope: "col"}, "mean [ms]"))),
      element("tbody", {}, ...this.data.stages.map((name, i) => element("tr", {},
        element("th", {scope: "row"}, capital(name)),
        element("td", {}, element("span", {class: "bar",
          style: `--colour: var(--part${i}); width: ${(100 * means[i] / largest).toFixed(1)}%`})),
        element("td", {}, formatNumber(means[i]))))));
  }

  drawHistogram(totals) {
    const step = niceStep(Math.max(0.1, totals[totals.length - 1]), 25);
    const counts = new Array(Math.floor(totals[totals.length - 1] / step) + 1).fill(0);
    for (const total of totals) ++counts[Math.floor(total / step)];
    const points = [[0, 0]];
    counts.forEach((count, i) => points.push([i * step, count], [(i + 1) * step, count]));
    points.push([counts.length * step, 0]);
    const place = byId("live-histogram");
    place.replaceChildren(lineFigure({width: this.width(place), height: 180, lines: [{points, colour: "var(--accent)"}],
      x: {label: "sample to command [ms]", low: 0, high: counts.length * step},
      y: {label: "commands", low: 0, high: Math.max(...counts) * 1.05},
      label: `Histogram of the time from sample to command in the last ${SHOWN_S} seconds`}));
  }

  drawFacts() {
    const {last} = this;
    const first = this.moments[0];
    const late_ms = Math.max(...this.moments.map((moment) => moment.late_ms));
    const commands = last.commands - first.commands;
    const seconds = last.time_s - first.time_s;
    const rows = [
      ["Time", `${last.time_s.toFixed(1)} s`, false],
      ["Watchdog", TIERS[last.tier], last.tier > 0],
      ...(this.data.has_motors ? [["Motors", last.has_sink ? "reached" : "not reached: brought to rest", !last.has_sink]] : []),
      ["Frames in the queue", `${last.waiting} before the loop, ${last.queued} in the receiver`, last.waiting + last.queued > 5],
      ["Commands", seconds > 0 ? `${formatNumber(commands / seconds)} per s` : "–", false],
      ["Of a repeated sample", `${Math.round(100 * (last.repeated - first.repeated) / Math.max(1, commands))} %`, false],
      ["Latest wake-up", `${formatNumber(late_ms)} ms`, late_ms > 5],
      ["Skipped ticks", String(last.skipped - first.skipped), last.skipped > first.skipped],
    ];
    const list = byId("live-facts");
    if (list.children.length !== 2 * rows.length) {
      list.replaceChildren(...rows.flatMap(([name]) => [element("dt", {}, name), element("dd", {})]));
    }
    rows.forEach(([, text, warns], i) => {
      const value = list.children[2 * i + 1];
      if (value.textContent !== text) value.textContent = text;
      value.classList.toggle("warn", warns);
    });
  }
}

document.documentElement.classList.add("scripts");
window.livePage = new LivePage(JSON.parse(byId("data").textContent));  // for the console
