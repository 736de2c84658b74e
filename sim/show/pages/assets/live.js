// The page of a running session. The program sends a moment 50 times a second; what is shown is made of those of the
// last seconds.

const SHOWN_S = 10;
const STALE_MS = 1500;
const PLOT_EVERY_MS = 100;
const ANSWER_MS = 4000;
const OUTAGE_SHOWN_S = 4;  // behind its end, which a person would miss
const TIERS = ["follow", "hold", "relax", "off"];
const WATCHDOG = ["The last command stays.", "The watchdog holds the motors.", "The watchdog brings the motors to rest.",
  "No commands are sent."];
const GLOVE_COLOUR = "var(--wearer)";

class LivePage extends HandScene {
  constructor(data) {
    super(byId("live-canvas"), data.hand, byId("live-note"));
    this.data = data;
    colours = data.controllers.map(({colour}) => colour);
    this.token = new URLSearchParams(location.search).get("token") ?? "";
    this.moments = [];
    this.stages = [];  // {time_s, ms: [of each stage]}
    this.plotted_ms = 0;
    this.ended = false;
    this.other_number = data.controllers.length > 1 ? 1 : -1;  // of the second hand's controller
    this.hand = new ReplayHand(data.hand);
    this.other = new ReplayHand(data.hand);
    this.ghost = new ReplayHand(data.hand);
    this.picture.add(this.hand, {opaque: true});
    this.picture.add(this.other, this.tint(tintName(Math.max(0, this.other_number))));
    this.picture.add(this.ghost, this.tint(GLOVE_COLOUR));
    this.placeCamera(this.hand, [data.joints.map(() => 0), data.rest_deg]);
    for (const hand of [this.hand, this.other, this.ghost]) hand.pose(data.rest_deg);
    this.makeChoice();
    byId("live-still").addEventListener("click", () => this.post("mark", this.last?.is_still ? "moving" : "still"));
    byId("live-joint").append(...data.joints.map((name, j) => element("option", {value: j}, name)));
    byId("live-joint").addEventListener("change", () => this.draw(true));
    byId("live-ghost").addEventListener("change", () => this.showHands());
    byId("live-other").append(...data.controllers.map(({name}, i) => element("option", {value: i}, name)));
    byId("live-other").addEventListener("change", ({target}) => {
      this.other_number = target.value === "" ? -1 : Number(target.value);
      this.showHands();
    });
    this.showHands();
    new ResizeObserver(() => this.draw(true)).observe(this.canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.showHands());
    this.say("Waiting for the session.", false);
    this.listen();
    setInterval(() => this.watchAge(), 250);
  }

  name(controller) { return this.data.controllers[controller].name; }

  get driven() { return this.data.has_motors ? "motors" : "simulated hand"; }

  // --- what arrives ------------------------------------------------------------------------------

  listen() {
    const events = new EventSource(`events?token=${encodeURIComponent(this.token)}`);
    events.addEventListener("message", ({data}) => {
      const moment = JSON.parse(data);
      if (!moment.has_ended) return this.take(moment);
      events.close();
      this.ended = true;
      const after = this.last ? ` after ${this.last.time_s.toFixed(1)} s` : "";
      this.say("The report is in the terminal.", true);
      this.warn(`The session has ended${after}.`, "", true);
      this.setChoice(-1);
    });
  }

  take(moment) {
    if (this.moments.length && moment.time_s < this.last.time_s) {
      this.moments = [];  // another session
      this.stages = [];
      this.scores = this.outage = null;
    }
    const before = this.last;
    this.moments.push(moment);
    for (const ms of moment.stages_ms) this.stages.push({time_s: moment.time_s, ms});
    const old = (list) => {
      const keep = list.findIndex(({time_s}) => time_s >= moment.time_s - SHOWN_S);
      if (keep > 0) list.splice(0, keep);
    };
    old(this.moments);
    old(this.stages);
    this.arrived_ms = performance.now();
    if (moment.scores) this.scores = moment.scores;
    if (before && before.driving !== moment.driving) this.noteSwitch(before.driving, moment.driving);
    if (!before) {
      this.showHands();
      this.watchAge();
    }
    if (moment.is_still && !before?.is_still) this.still_since_s = moment.time_s;
    this.watchOutage(moment);
    this.hand.pose(moment.hand_deg.map((angle) => angle ?? 0));
    this.ghost.pose(this.gloveAngles(moment).map((angle) => angle ?? 0));
    if (this.other_number >= 0) this.other.pose(moment.asked_deg[this.other_number].map((angle) => angle ?? 0));
    this.draw(false);
  }

  get last() { return this.moments[this.moments.length - 1]; }

  // Of the joints [deg], as the glove measures them: the joint map of its channels.
  gloveAngles({glove_deg}) {
    return this.data.joint_map.map(({offset_deg, terms}) =>
      terms.reduce((sum, [channel, weight]) => sum + weight * (glove_deg[channel] ?? NaN), offset_deg));
  }

  // The second hand is that of the controller that drove, where it was that of the new one.
  noteSwitch(before, now) {
    if (this.other_number === now) this.other_number = before;
    if (this.scores) this.scores.controllers[now] = [0, null, null];  // it begins
    this.watchAge();
    this.showHands();
  }

  // --- what a person is warned of ----------------------------------------------------------------

  watchAge() {
    if (this.ended || !this.arrived_ms) return;
    const age_ms = performance.now() - this.arrived_ms;
    if (age_ms > STALE_MS) {
      const text = "No data from the program: it has ended, or it is stopped.";
      this.say(text, true);
      this.warn(text, `${(age_ms / 1e3).toFixed(0)} s`);
    } else {
      this.say(`${this.name(this.last.driving)} drives the ${this.driven}.`, false);
    }
  }

  watchOutage(moment) {
    const {time_s, silent_s, tier} = moment;
    const is_silent = silent_s > this.data.silent_from_s || tier > 0;
    if (is_silent) {
      this.outage ??= {begin_s: time_s - silent_s};
      this.outage.end_s = null;
    } else if (this.outage) {
      this.outage.end_s ??= time_s;
      if (time_s > this.outage.end_s + OUTAGE_SHOWN_S) this.outage = null;
    }
    if (moment.is_ending) return this.warn("The session ends: the motors turn to their rest positions.", "", true);
    if (!moment.has_sink) return this.warn("The motors cannot be reached: commands go to their rest positions.", "");
    if (!this.outage) return this.warn("", "");
    const seconds = (from_s, to_s) => `${Math.max(0, to_s - from_s).toFixed(1)} s`;
    if (!is_silent) {
      return this.warn("The glove was silent. Its samples are back.", seconds(this.outage.begin_s, this.outage.end_s), true);
    }
    const cause = silent_s > this.data.silent_from_s / 5 ? "No samples from the glove. " : "";
    return this.warn(cause + WATCHDOG[tier], seconds(this.outage.begin_s, time_s));
  }

  // Read aloud when the words change, not with each tenth of a second.
  warn(text, time, is_calm = false) {
    const banner = byId("live-banner");
    banner.hidden = text === "";
    banner.classList.toggle("calm", is_calm);
    if (byId("live-banner-text").textContent !== text) byId("live-banner-text").textContent = text;
    byId("live-banner-time").textContent = time;
  }

  say(text, stale) {
    const state = byId("live-state");
    state.classList.toggle("stale", stale);
    if (state.textContent !== text) state.textContent = text;  // it is read aloud
  }

  // --- the choice --------------------------------------------------------------------------------

  makeChoice() {
    byId("live-choice").append(...this.data.controllers.map(({name}, i) => element("tr", {},
      element("th", {scope: "row"},
        element("button", {type: "button", "aria-pressed": "false", onclick: () => this.post("switch", name)}, dot(i), ...breakable(name)),
        element("small", {}, "\u00a0")),
      element("td", {}, "–"), element("td", {}, "–"))));
    byId("live-scores-note").textContent = `Of the commanded joint angles, mean over ${this.data.scored_joints} joints. ` +
      `Jitter: above ${this.data.jitter_above_hz} Hz. Delay: needs ${this.data.least_delay_s} s of motion; ` +
      `reference: ${this.data.reference}.`;
    this.setChoice(0);
    if (this.data.controllers.length === 1) {
      byId("live-scores-note").append(" --shadow NAME,.. adds controllers to choose from.");
    }
  }

  setChoice(driving) {
    [...byId("live-choice").querySelectorAll("button")].forEach((button, i) => {
      const pressed = String(i === driving);
      if (button.getAttribute("aria-pressed") !== pressed) button.setAttribute("aria-pressed", pressed);
      button.disabled = this.ended;
    });
    const is_still = Boolean(this.last?.is_still);
    const still = byId("live-still");
    const text = is_still ? "Hand moves again" : "Hand is still";
    if (still.textContent !== text) still.textContent = text;
    still.disabled = this.ended;
    byId("live-still-time").textContent = is_still ? `Marked still for ${(this.last.time_s - this.still_since_s).toFixed(1)} s.` : "";
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
    clearTimeout(this.answer_timer);
    this.answer_timer = setTimeout(() => { answer.textContent = ""; }, ANSWER_MS);
  }

  // --- what is shown -----------------------------------------------------------------------------

  // Which hands are seen, with their names.
  showHands() {
    const driving = this.last?.driving ?? 0;
    const tinted = [];
    this.other.setVisible(this.other_number >= 0);
    byId("live-other").value = this.other_number < 0 ? "" : this.other_number;
    if (this.other_number >= 0) {
      const colour = tintName(this.other_number);
      this.other.recolour?.(resolvedColour(colour));
      tinted.push([colour, this.name(this.other_number)]);
    }
    const has_ghost = byId("live-ghost").checked;
    this.ghost.setVisible(has_ghost);
    this.ghost.recolour?.(resolvedColour(GLOVE_COLOUR));
    if (has_ghost) tinted.push([GLOVE_COLOUR, "wearer"]);
    this.nameHands(byId("live-names"), this.name(driving), tinted);
    byId("live-legend").replaceChildren(...this.lines(driving).map(({name, colour}) =>
      element("span", {}, element("span", {class: "dot", style: `--colour: ${colour}`}), name)));
    this.draw(true);
  }

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
      this.drawScores();
      this.drawFacts();
      this.drawCurves();
      this.drawLatency();
    });
  }

  drawScores() {
    const put = (place, text) => { if (place.textContent !== text) place.textContent = text; };
    [...byId("live-choice").rows].forEach((row, i) => {
      const [over_s, jitter_deg, delay_ms] = this.scores?.controllers[i] ?? [0, null, null];
      const role = i === this.last.driving ? `drives the ${this.driven}` : "drives nothing";
      put(row.querySelector("small"), `${role}${over_s > 0 ? `, ${over_s.toFixed(over_s < SHOWN_S ? 1 : 0)} s` : ""}`);
      put(row.cells[1], formatNumber(jitter_deg));
      put(row.cells[2], formatNumber(delay_ms));
    });
  }

  width(place) { return Math.max(280, Math.round(place.clientWidth)); }

  // Of the joint that is chosen.
  lines(driving) {
    const joint = Number(byId("live-joint").value);
    const other = this.other_number;
    return [
      {name: "wearer", colour: GLOVE_COLOUR, width: 1, of: (moment) => this.gloveAngles(moment)[joint]},
      ...(other < 0 ? [] : [{name: `command of ${this.name(other)}`, colour: colourName(other), width: 1,
        of: ({asked_deg}) => asked_deg[other][joint]}]),
      {name: `command of ${this.name(driving)}`, colour: "var(--command)", dash: [4, 3], of: ({command_deg}) => command_deg[joint]},
      {name: "hand", colour: colourName(driving), width: 2.4, of: ({hand_deg}) => hand_deg[joint]},
    ];
  }

  drawCurves() {
    const joint = Number(byId("live-joint").value);
    const end_s = Math.max(SHOWN_S, this.last.time_s);
    const lines = this.lines(this.last.driving)
      .map((line) => ({...line, points: this.moments.map((moment) => [moment.time_s, line.of(moment) ?? NaN])}));
    const values = lines.flatMap(({points}) => points.map(([, y]) => y)).filter(Number.isFinite);
    const [low, high] = values.length ? [Math.min(...values), Math.max(...values)] : [0, 1];
    const room = Math.max(5, 0.08 * (high - low));
    const place = byId("live-plot");
    place.replaceChildren(lineFigure({width: this.width(place), height: 260, lines,
      x: {label: "time [s]", low: end_s - SHOWN_S, high: end_s},
      y: {label: "joint angle [deg]", low: low - room, high: high + room},
      label: `Wearer, commands and hand of ${this.data.joints[joint]} in the last ${SHOWN_S} seconds`}));
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
      element("thead", {}, element("tr", {}, element("th", {class: "words", scope: "col"}, "Stage"), element("td", {}),
        element("th", {scope: "col"}, "Mean ", element("span", {class: "unit"}, "ms")))),
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
    place.replaceChildren(lineFigure({width: this.width(place), height: 260, lines: [{points, colour: "var(--accent)"}],
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
      ["Waiting frames", `${last.waiting} before the loop, ${last.queued} in the receiver`, last.waiting + last.queued > 5],
      ["Command frames", seconds > 0 ? `${formatNumber(commands / seconds)} per s` : "–", false],
      ["With a held sample", `${Math.round(100 * (last.repeated - first.repeated) / Math.max(1, commands))} %`, false],
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
