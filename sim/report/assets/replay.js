// The hand itself, moving: what a controller's hand did, with the wearer's as a ghost behind it.

class ReplayView {
  constructor(data, store, clock) {
    this.data = data;
    this.replay = data.replay;
    this.clock = clock;
    this.store = store;
    this.video = null;
    this.loop = data.decisive_second;  // until a person chooses another time
    this.decoded = new Map();
    this.channels = this.replay.joints.map((name) => data.channels.indexOf(name));  // -1: not measured
    this.time = 0;
    this.playing = false;
    this.canvas = byId("replay-canvas");
    this.makePicture();
    this.carrier = this.replay.camera?.body ?? 0;
    const look = (controller) => ({opaque: false, colour: resolvedColour(colourName(controller)), beyond: this.carrier});
    this.hand = new ReplayHand(this.replay);
    this.other = new ReplayHand(this.replay);
    this.ghost = new ReplayHand(this.replay);
    this.picture.add(this.hand, {opaque: true});
    this.picture.add(this.other, look(0));
    this.picture.add(this.ghost, {...look(0), colour: resolvedColour("var(--wearer)")});
    this.chooseControllers();
    this.placeCamera();
    this.listen();
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

  makePicture() {
    try {
      this.picture = new WebGlPicture(this.canvas, this.replay);
    } catch (error) {
      // A canvas that was asked for WebGL gives nothing else.
      const canvas = this.canvas.cloneNode();
      this.canvas.replaceWith(canvas);
      this.canvas = canvas;
      this.picture = new FlatPicture(canvas, this.replay);
      byId("replay-note").append(" This browser has no WebGL: shapes are drawn flat, and cables are not.");
    }
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
    if (other >= 0) this.other.recolour?.(resolvedColour(colourName(other)));
    this.ghost.recolour?.(resolvedColour("var(--wearer)"));
    this.range.value = this.time;
    byId("replay-clock").textContent = `${this.time.toFixed(2)} s`;
    this.draw();
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

  drawNow() {
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    if (width === 0) return;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.picture.draw(this.camera, (hand) => this.fromCarrier(hand), width, height);
  }

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

  // --- camera -----------------------------------------------------------------------------------

  // A camera that an arm carries sees each hand from that hand's own arm, as in the video.
  fromCarrier(hand) {
    return new THREE.Matrix4().getInverse(hand.bodies[this.carrier].matrixWorld);
  }

  // Looks from where the model's camera looks, at all bodies that move beyond what carries it.
  placeCamera() {
    const {camera} = this.replay;
    this.camera = new THREE.PerspectiveCamera(camera?.height_deg ?? 40, 1, 0.005, 20);
    const reach = new THREE.Box3();
    const moving = new Set(this.replay.hinges.map(({body}) => body));
    const palm = this.palmAmong(moving);
    for (let i = 0; i < 9; ++i) {
      for (const controller of [null, this.shown().hand]) {
        this.hand.pose(this.anglesAt(controller, this.store.duration_s * i / 8));
        const view = this.fromCarrier(this.hand);
        for (const {body, frame} of this.replay.shapes) {
          const root = [...moving].some((m) => this.hand.hangsOn(body, m));
          if (!root || body === this.carrier || !this.hand.hangsOn(body, palm)) continue;
          reach.expandByPoint(new THREE.Vector3().fromArray(frame)
            .applyMatrix4(this.hand.bodies[body].matrixWorld).applyMatrix4(view));
        }
      }
    }
    const ball = reach.getBoundingSphere(new THREE.Sphere());
    const look = new THREE.Object3D();
    placeAt(look, camera?.frame ?? [0, 0, 0, 0.854, 0.354, 0.146, 0.354]);
    this.camera.up.set(0, 1, 0).applyQuaternion(look.quaternion);
    const back = new THREE.Vector3(0, 0, 1).applyQuaternion(look.quaternion);
    const away = 0.95 * (ball.radius + 0.02) / Math.sin(this.camera.fov * RAD_PER_DEG / 2);
    this.camera.position.copy(ball.center).addScaledVector(back, away);
    this.camera.target = ball.center;
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.target.copy(ball.center);
    this.controls.enableKeys = false;
    this.controls.enableZoom = false;  // a page that is scrolled over it stays as it is
    this.controls.minDistance = 0.1 * away;
    this.controls.maxDistance = 8 * away;
    this.controls.update();
    this.controls.saveState();
  }

  // The body that carries most of those that move by themselves: fingers.
  palmAmong(moving) {
    const carried = new Map();
    for (const body of moving) {
      const {parent} = this.replay.bodies[body];
      carried.set(parent, (carried.get(parent) ?? 0) + 1);
    }
    return [...carried].reduce((most, one) => (one[1] > most[1] ? one : most), [this.carrier, 0])[0];
  }

  turn(aside_rad, up_rad) {
    const arm = this.camera.position.clone().sub(this.controls.target);
    arm.applyAxisAngle(this.camera.up, aside_rad);
    const level = this.camera.up.clone().cross(arm).normalize();
    arm.applyAxisAngle(level, up_rad);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
    this.draw();
  }

  // --- what a person does -----------------------------------------------------------------------

  listen() {
    for (const id of ["replay-hand", "replay-other", "replay-ghost"]) {
      byId(id).addEventListener("change", () => this.show(this.time));
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
    this.controls.addEventListener("change", () => this.draw());
    this.canvas.addEventListener("pointerdown", () => { this.controls.enableZoom = true; });
    this.canvas.addEventListener("pointerleave", () => { this.controls.enableZoom = false; });
    this.canvas.addEventListener("keydown", (event) => {
      const turns = {ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1]};
      if (!turns[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      this.turn(...turns[event.key]);
      event.preventDefault();
    });
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
