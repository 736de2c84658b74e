// Two ways to draw hands into a canvas: by WebGL, or, where a browser has none, as a flat picture of their shapes.

// How a hand looks: {opaque: true} as the model has it, with cables, else in one colour that lets others through.
class WebGlPicture {
  constructor(canvas, replay) {
    const context = canvas.getContext("webgl", {antialias: true, alpha: true});
    if (!context) throw new Error("no WebGL");
    this.renderer = new THREE.WebGLRenderer({canvas, context, antialias: true, alpha: true});
    this.replay = replay;
    this.parts = bodyGeometries(replay);
    this.scene = new THREE.Scene();
    this.roots = new Map();  // of each hand
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8a8f98, 0.75));
    this.light = new THREE.DirectionalLight(0xffffff, 0.55);
    this.scene.add(this.light, this.light.target);
  }

  add(hand, {opaque, colour, beyond}) {
    const root = new THREE.Group();
    root.matrixAutoUpdate = false;
    root.add(hand.world);
    this.roots.set(hand, root);
    this.scene.add(root);
    const put = (part, material, order) => {
      const mesh = new THREE.Mesh(part.geometry, material);
      mesh.renderOrder = order;
      hand.bodies[part.body].add(mesh);
    };
    if (opaque) {
      for (const part of this.parts) {
        put(part, new THREE.MeshLambertMaterial({color: new THREE.Color(...part.rgba)}), 0);
      }
      this.addCables(hand);
    } else {
      // First how near it is, then its colour once: shapes inside each other are not seen. A little further away than it
      // is, so that of a hand that follows nothing is seen.
      const behind = {polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 300 * this.roots.size};
      const near = new THREE.MeshBasicMaterial({colorWrite: false, ...behind});
      const tint = new THREE.MeshLambertMaterial({color: colour, transparent: true, opacity: 0.45, ...behind});
      for (const part of this.parts) {
        if (!hand.hangsOn(part.body, beyond) || part.body === beyond) continue;
        put(part, near, 2);
        put(part, tint, 3);
      }
      hand.recolour = (now) => tint.color.set(now);
    }
    hand.setVisible = (visible) => { root.visible = visible; };
  }

  // A thin cylinder for every straight piece.
  addCables(hand) {
    const unit = new THREE.CylinderBufferGeometry(1, 1, 1, 6, 1, true).translate(0, 0.5, 0).rotateX(Math.PI / 2);
    this.cables = {hand, colours: new Map()};
    for (const cable of this.replay.cables) {
      const key = String(cable.rgba);
      if (!this.cables.colours.has(key)) {
        const material = new THREE.MeshLambertMaterial({color: new THREE.Color(...cable.rgba)});
        this.cables.colours.set(key, {list: [], material});
      }
      this.cables.colours.get(key).list.push(cable);
    }
    for (const group of this.cables.colours.values()) {
      const most = group.list.reduce((sum, {points}) => sum + 36 * points.length, 0);
      // Of its own geometry: this three.js takes the matrices of the mesh before for one that shares it.
      group.mesh = new THREE.InstancedMesh(unit.clone(), group.material, most);
      group.mesh.frustumCulled = false;
      this.roots.get(hand).add(group.mesh);
    }
  }

  moveCables() {
    const piece = new THREE.Object3D();
    for (const {list, mesh} of this.cables?.colours.values() ?? []) {
      let count = 0;
      for (const cable of list) {
        const way = this.cables.hand.cableWay(cable);
        for (let i = 0; i + 1 < way.length; ++i) {
          piece.position.copy(way[i]);
          piece.lookAt(way[i + 1]);
          piece.scale.set(cable.width, cable.width, way[i].distanceTo(way[i + 1]));
          piece.updateMatrix();
          mesh.setMatrixAt(count++, piece.matrix);
        }
      }
      mesh.count = count;
      mesh.instanceMatrix.needsUpdate = true;
    }
  }

  // `viewOf(hand)`: takes away where the camera's carrier is.
  draw(camera, viewOf, width, height) {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    if (this.width !== width || this.height !== height || this.ratio !== ratio) {
      Object.assign(this, {width, height, ratio});
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
    }
    this.moveCables();
    this.light.position.copy(camera.position).add(camera.up);
    this.light.target.position.copy(camera.target);
    this.turnRoots(viewOf);
    this.renderer.render(this.scene, camera);
    this.turnRoots(() => new THREE.Matrix4());  // postures are in the world's frame
  }

  turnRoots(matrixOf) {
    for (const [hand, root] of this.roots) {
      root.matrix.copy(matrixOf(hand));
      root.updateMatrixWorld(true);
    }
  }
}

// Every shape as a thick line from end to end, the furthest first.
class FlatPicture {
  constructor(canvas, replay) {
    this.canvas = canvas;
    this.replay = replay;
    this.hands = [];
  }

  add(hand, look) {
    this.hands.push({hand, look, visible: true});
    const place = this.hands[this.hands.length - 1];
    hand.recolour = (now) => { look.colour = now; };
    hand.setVisible = (visible) => { place.visible = visible; };
  }

  draw(camera, viewOf, width, height) {
    this.canvas.width = width;
    this.canvas.height = height;
    const context = this.canvas.getContext("2d");
    context.lineCap = "round";
    camera.updateMatrixWorld();
    camera.matrixWorldInverse.getInverse(camera.matrixWorld);
    const pixels = height / 2 / Math.tan(camera.fov * RAD_PER_DEG / 2);
    for (const {hand, look, visible} of [...this.hands].sort((a, b) => a.look.opaque - b.look.opaque)) {
      if (!visible) continue;
      context.globalAlpha = look.opaque ? 1 : 0.35;
      const lines = this.replay.shapes.filter((shape) => look.opaque || hand.hangsOn(shape.body, look.beyond))
        .map((shape) => this.line(hand, shape, look, viewOf(hand), camera)).filter((line) => line.far > 0);
      for (const {ends, radius, far, colour} of lines.sort((a, b) => b.far - a.far)) {
        context.strokeStyle = colour;
        context.lineWidth = Math.max(1, 2 * radius * pixels / far);
        context.beginPath();
        ends.forEach(({x, y}, i) => context[i ? "lineTo" : "moveTo"]((1 + x) * width / 2, (1 - y) * height / 2));
        context.stroke();
      }
    }
  }

  line(hand, shape, look, view, camera) {
    const {size, form} = shape;
    const longest = size.indexOf(Math.max(...size));
    const round = form === "capsule" || form === "cylinder";
    const radius = round || form === "sphere" ? size[0] : [...size].sort((a, b) => a - b)[1];
    const half = [0, 0, 0];
    if (form === "box" || form === "ellipsoid") half[longest] = Math.max(0, size[longest] - radius);
    if (round) half[2] = form === "capsule" ? size[1] : Math.max(0, size[1] - radius);
    const place = view.clone().multiply(hand.bodies[shape.body].matrixWorld).multiply(transformOf(shape.frame));
    const ends = [1, -1].map((sign) => new THREE.Vector3(...half.map((h) => sign * h + 1e-6 * sign)).applyMatrix4(place));
    const middle = ends[0].clone().add(ends[1]).multiplyScalar(0.5).applyMatrix4(camera.matrixWorldInverse);
    const grey = shape.rgba.slice(0, 3).map((part) => Math.round(255 * part));
    return {ends: ends.map((end) => end.project(camera)), radius, far: -middle.z,
      colour: look.opaque ? `rgb(${grey})` : look.colour};
  }
}
