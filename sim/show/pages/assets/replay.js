// The hand itself, moving: what a controller's hand did, with the wearer's as a ghost behind it.

class ReplayView extends HandScene {
  constructor(data, store, clock) {
    super(byId("replay-canvas"), data.replay, byId("replay-note"));
    this.data = data;
    this.clock = clock;
    this.store = store;
    this.video = null;
    this.loop = data.decisive_second;  // until a person chooses another time
    this.decoded = new Map();
    this.channels = this.replay.joints.map((name) => data.channels.indexOf(name));  // -1: not measured
    this.time = 0;
    this.playing = false;
    this.hand = new ReplayHand(this.replay);
    this.other = new ReplayHand(this.replay);
    this.ghost = new ReplayHand(this.replay);
    this.picture.add(this.hand, {opaque: true});
    this.picture.add(this.other, this.tint(tintName(0)));
    this.picture.add(this.ghost, this.tint("var(--wearer)"));
    this.chooseControllers();
    this.placeCamera(this.hand, this.postures());
    this.listen();
    this.nameShown();
    this.show(0);
    if (this.loop) this.showDecisiveSecond();
  }

  // Over and over while it is in sight; at rest for those who want no motion.
  showDecisiveSecond() {
    this.moveTo(this.loop[2]);
    if (window.matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    new IntersectionObserver(([{isIntersecting}], observer) => {
      if (!this.loop) observer.disconnect();
      else if (isIntersecting !== this.playing) this.play(isIntersecting);
    }).observe(this.canvas);
  }

  chooseControllers() {
    const names = this.data.controllers.map(({name}) => name);
    for (const id of ["replay-hand", "replay-other"]) {
      byId(id).append(...this.data.order.map((c) => element("option", {value: c}, names[c])));
    }
    const baseline = this.data.controllers.findIndex((controller) => controller.baseline);
    byId("replay-hand").value = this.data.order[0];
    if (baseline >= 0 && baseline !== this.data.order[0]) byId("replay-other").value = baseline;
    this.range = byId("replay-time");
    this.range.max = this.store.duration_s;
  }

  // --- motion -----------------------------------------------------------------------------------

  curve(text) {
    if (!this.decoded.has(text)) this.decoded.set(text, decodeCurve(text, this.data.curves.step_deg));
    return this.decoded.get(text);
  }

  // Between two points of a curve, straight; behind its end, the last.
  at(values, place) {
    const from = Math.min(values.length - 1, Math.max(0, Math.floor(place)));
    const to = Math.min(values.length - 1, from + 1);
    const share = Math.min(1, Math.max(0, place - from));
    return values[from] + (values[to] - values[from]) * share;
  }

  // Of all joints [deg]; `controller` null: the wearer's.
  anglesAt(controller, time_s) {
    const held = controller === null ? this.replay.held_deg.wearer : this.replay.held_deg.controllers[controller];
    const place = (time_s - this.store.first_s) / this.store.step_s;
    return this.channels.map((channel, joint) => {
      if (channel < 0) return held[joint] ?? 0;
      const curves = this.data.curves.channels[channel];
      const angle = this.at(this.curve(controller === null ? curves.true : curves.controllers[controller].hand), place);
      return Number.isFinite(angle) ? angle : held[joint] ?? 0;
    });
  }

  objectAt(controller, time_s) {
    const {object} = this.replay;
    if (!object) return null;
    if (!object.decoded) object.decoded = object.controllers.map((c) => c.map((text) => decodeCurve(text, object.step)));
    const curves = object.decoded[controller];
    return curves.length === 7 ? curves.map((values) => this.at(values, time_s * object.rate_hz)) : null;
  }

  // Of the wearer and of the hand, for the place of the camera.
  postures() {
    return [...Array(9).keys()].flatMap((i) => [null, this.shown().hand].map(
      (controller) => this.anglesAt(controller, this.store.duration_s * i / 8)));
  }

  // What each hand is of: a controller, the wearer (null), or nothing (-1).
  shown() {
    const number = (id) => (byId(id).value === "" ? -1 : Number(byId(id).value));
    return {hand: number("replay-hand"), other: number("replay-other"),
      ghost: byId("replay-ghost").checked ? null : -1};
  }

  show(time_s) {
    this.time = Math.min(this.store.duration_s, Math.max(0, time_s));
    for (const [name, of] of Object.entries(this.shown())) {
      this[name].setVisible(of !== -1);
      if (of === -1) continue;
      const object = of === null ? null : this.objectAt(of, this.time);
      this[name].pose(this.anglesAt(of, this.time), object);
    }
    const other = this.shown().other;
    if (other >= 0) this.other.recolour?.(resolvedColour(tintName(other)));
    this.ghost.recolour?.(resolvedColour("var(--wearer)"));
    this.range.value = this.time;
    byId("replay-clock").textContent = `${this.time.toFixed(2)} s`;
    this.draw();
  }

  nameShown() {
    const {hand, other, ghost} = this.shown();
    const name = (controller) => this.data.controllers[controller].name;
    this.nameHands(byId("replay-legend"), name(hand), [
      ...(other < 0 ? [] : [[tintName(other), name(other)]]),
      ...(ghost === -1 ? [] : [["var(--wearer)", "wearer"]])]);
  }

  // What is drawn is asked for once per frame of the screen, and only while it is in sight.
  draw() {
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame((now_ms) => {
      this.drawNow();
      if (this.playing) this.goOn(now_ms);
    });
  }

  // Other colours or another width.
  redraw() { this.show(this.time); }

  goOn(now_ms) {
    const passed_s = Math.min(0.1, (now_ms - (this.last_ms ?? now_ms)) / 1e3) * Number(byId("replay-speed").value);
    this.last_ms = now_ms;
    const time = this.time + passed_s;
    const [from, to] = this.loop ?? [0, this.store.duration_s];
    this.moveTo(time > to ? from : time);
    this.video?.lead(this.time, Number(byId("replay-speed").value));
  }

  moveTo(time_s, settled = false) {
    this.show(time_s);
    this.clock.set(this.time, "replay", settled);
  }

  // Another part of the page set the time.
  follow(time_s) {
    if (time_s === null) return;
    this.leaveLoop();
    if (this.playing) this.play(false);
    this.show(time_s);
  }

  leaveLoop() { this.loop = null; }

  play(on) {
    this.playing = on;
    this.last_ms = null;
    byId("replay-play").textContent = on ? "Pause" : "Play";
    if (on) this.draw();
    else this.video?.leave();
  }

  // --- what a person does -----------------------------------------------------------------------

  listen() {
    for (const id of ["replay-hand", "replay-other", "replay-ghost"]) {
      byId(id).addEventListener("change", () => {
        this.nameShown();
        this.show(this.time);
      });
    }
    byId("replay-play").addEventListener("click", () => {
      if (this.playing) this.leaveLoop();
      this.play(!this.playing);
      if (!this.playing) this.clock.set(this.time, "replay", true);
    });
    byId("replay-view").addEventListener("click", () => this.controls.reset());
    this.range.addEventListener("input", () => {
      this.leaveLoop();
      if (this.playing) this.play(false);
      this.moveTo(Number(this.range.value));
    });
    this.range.addEventListener("change", () => this.clock.set(this.time, "replay", true));
    this.clock.listen("replay", (time_s) => this.follow(time_s));
  }
}

// Nothing where no hand was simulated.
function startReplay(data, curves, clock) {
  if (!data.replay || !curves) {
    byId("replay").hidden = true;
    return null;
  }
  const view = new ReplayView(data, curves.store, clock);
  byId("replay").view = view;  // for the console
  return view;
}
