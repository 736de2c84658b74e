// A canvas with hands, and the camera that a person turns. Who extends it has draw(), which asks for drawNow().

class HandScene {
  // `note`: where a person is told what is not drawn.
  constructor(canvas, replay, note) {
    this.canvas = canvas;
    this.replay = replay;
    this.note = note;
    this.makePicture();
    this.carrier = this.replay.camera?.body ?? 0;
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
      this.note.append(" This browser has no WebGL: shapes are drawn flat, and cables are not.");
    }
  }

  // How a hand looks that lets others through: in one colour, without the arm.
  tint(colour) { return {opaque: false, colour: resolvedColour(colour), beyond: this.carrier}; }

  // Whose hands are seen, each with its colour: `tinted` as [colour, name].
  nameHands(place, solid, tinted) {
    place.replaceChildren(element("span", {class: "item"}, `Solid: ${solid}`), ...tinted.map(([colour, name]) =>
      element("span", {class: "item"}, element("span", {class: "dot", style: `--colour: ${colour}`}), name)));
  }

  drawNow() {
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    if (width === 0) return;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.picture.draw(this.camera, (hand) => this.fromCarrier(hand), width, height);
  }

  // A camera that an arm carries sees each hand from that hand's own arm, as in the video.
  fromCarrier(hand) {
    return new THREE.Matrix4().getInverse(hand.bodies[this.carrier].matrixWorld);
  }

  // Looks from where the model's camera looks, at all bodies that move beyond what carries it.
  placeCamera(hand, postures) {
    const {camera} = this.replay;
    this.camera = new THREE.PerspectiveCamera(camera?.height_deg ?? 40, 1, 0.005, 20);
    const points = [];
    const moving = new Set(this.replay.hinges.map(({body}) => body));
    const palm = this.palmAmong(moving);
    for (const posture of postures) {
      hand.pose(posture);
      const view = this.fromCarrier(hand);
      for (const {body, frame} of this.replay.shapes) {
        const root = [...moving].some((m) => hand.hangsOn(body, m));
        if (!root || body === this.carrier || !hand.hangsOn(body, palm)) continue;
        points.push(new THREE.Vector3().fromArray(frame).applyMatrix4(hand.bodies[body].matrixWorld).applyMatrix4(view));
      }
    }
    const look = new THREE.Object3D();
    placeAt(look, camera?.frame ?? [0, 0, 0, 0.854, 0.354, 0.146, 0.354]);
    this.camera.up.set(0, 1, 0).applyQuaternion(look.quaternion);
    const back = new THREE.Vector3(0, 0, 1).applyQuaternion(look.quaternion);
    const {centre, away} = this.fit(points, back);
    this.camera.position.copy(centre).addScaledVector(back, away);
    this.camera.target = centre;
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.target.copy(centre);
    this.controls.enableKeys = false;
    this.controls.enableZoom = false;  // a page that is scrolled over it stays as it is
    this.controls.minDistance = 0.1 * away;
    this.controls.maxDistance = 8 * away;
    this.controls.update();
    this.controls.saveState();
    this.listenToCamera();
  }

  // Where the camera looks, and from how far, so that these points fill the picture.
  fit(points, back) {
    const margin_m = 0.02;  // shapes around the points
    const aside = this.camera.up.clone().cross(back);
    const axes = [aside, this.camera.up, back].map((axis) => {
      const along = points.map((point) => point.dot(axis));
      const [low, high] = [Math.min(...along), Math.max(...along)];
      return {axis, middle: (low + high) / 2, half: (high - low) / 2 + margin_m};
    });
    const centre = new THREE.Vector3();
    for (const {axis, middle} of axes) centre.addScaledVector(axis, middle);
    const [wide, high, deep] = axes.map(({half}) => half);
    const aspect = this.canvas.clientWidth / this.canvas.clientHeight || 1;
    return {centre, away: deep + Math.max(high, wide / aspect) / Math.tan(this.camera.fov * RAD_PER_DEG / 2)};
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

  listenToCamera() {
    this.controls.addEventListener("change", () => this.draw());
    this.canvas.addEventListener("pointerdown", () => { this.controls.enableZoom = true; });
    this.canvas.addEventListener("pointerleave", () => { this.controls.enableZoom = false; });
    this.canvas.addEventListener("keydown", (event) => {
      const turns = {ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1]};
      if (!turns[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      this.turn(...turns[event.key]);
      event.preventDefault();
    });
  }
}
