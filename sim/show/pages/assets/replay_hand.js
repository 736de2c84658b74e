// The hand of the compiled model, put into postures by joint angles alone: sim/hand/hand_shapes.h says what its data
// mean. Everything here is in the model's own units, m and rad; only joint angles come in deg.

const RAD_PER_DEG = Math.PI / 180;

function placeAt(object, frame) {
  object.position.fromArray(frame);
  object.quaternion.set(frame[4], frame[5], frame[6], frame[3]);
}

function transformOf(frame) {
  const object = new THREE.Object3D();
  placeAt(object, frame);
  object.updateMatrix();
  return object.matrix;
}

// As the model has them: capsules and cylinders lie along z, sizes are radii and half lengths.
function formGeometry(shape, meshes) {
  const [a, b, c] = shape.size;
  if (shape.form === "sphere") return new THREE.SphereBufferGeometry(a, 20, 12);
  if (shape.form === "ellipsoid") return new THREE.SphereBufferGeometry(1, 24, 16).scale(a, b, c);
  if (shape.form === "box") return new THREE.BoxBufferGeometry(2 * a, 2 * b, 2 * c);
  if (shape.form === "cylinder") return new THREE.CylinderBufferGeometry(a, a, 2 * b, 24).rotateX(Math.PI / 2);
  if (shape.form === "capsule") {
    const profile = [];
    for (let i = 0; i <= 12; ++i) {
      const angle = (i / 6 - 1) * Math.PI / 2;
      const cap = a * Math.sin(angle) + (i < 6 ? -b : b);
      profile.push(new THREE.Vector2(a * Math.cos(angle), cap));
      if (i === 6) profile.splice(-1, 0, new THREE.Vector2(a, -b));
    }
    return new THREE.LatheBufferGeometry(profile, 20).rotateX(Math.PI / 2);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setIndex(meshes[shape.mesh].triangle);
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(meshes[shape.mesh].vertex, 3));
  geometry.computeVertexNormals();
  return geometry;
}

function joined(geometries) {
  const whole = new THREE.BufferGeometry();
  for (const name of ["position", "normal"]) {
    const parts = geometries.map((geometry) => geometry.getAttribute(name).array);
    const all = new Float32Array(parts.reduce((sum, part) => sum + part.length, 0));
    parts.reduce((at, part) => { all.set(part, at); return at + part.length; }, 0);
    whole.setAttribute(name, new THREE.BufferAttribute(all, 3));
  }
  return whole;
}

// One geometry for all shapes of a body in one colour: [{body, rgba, geometry}].
function bodyGeometries(replay) {
  const groups = new Map();
  for (const shape of replay.shapes) {
    const key = `${shape.body} ${shape.rgba}`;
    if (!groups.has(key)) groups.set(key, {body: shape.body, rgba: shape.rgba, parts: []});
    const geometry = formGeometry(shape, replay.meshes);
    groups.get(key).parts.push((geometry.index ? geometry.toNonIndexed() : geometry)
      .applyMatrix(transformOf(shape.frame)));
  }
  return [...groups.values()].map(({body, rgba, parts}) => ({body, rgba, geometry: joined(parts)}));
}

// A tree of bodies. `bodies[i]` is an Object3D per body of the model, 0 is the world.
class ReplayHand {
  constructor(replay) {
    this.replay = replay;
    this.bodies = replay.bodies.map(({frame}) => {
      const body = new THREE.Object3D();
      placeAt(body, frame);
      return body;
    });
    replay.bodies.forEach(({parent}, i) => { if (i > 0) this.bodies[parent].add(this.bodies[i]); });
    this.hinges = new Map();  // of each body that has any
    for (const hinge of replay.hinges) {
      if (!this.hinges.has(hinge.body)) this.hinges.set(hinge.body, []);
      this.hinges.get(hinge.body).push({...hinge, at: new THREE.Vector3(...hinge.at),
        axis: new THREE.Vector3(...hinge.axis)});
    }
  }

  get world() { return this.bodies[0]; }

  // Whether a body hangs, over any number of others, on this one.
  hangsOn(body, ancestor) {
    while (body > 0 && body !== ancestor) body = this.replay.bodies[body].parent;
    return body === ancestor;
  }

  // `angle_deg[i]` of each joint; the object's frame, if there is one.
  pose(angle_deg, object_frame) {
    const turn = new THREE.Quaternion();
    const anchor = new THREE.Vector3();
    for (const [index, hinges] of this.hinges) {
      const body = this.bodies[index];
      placeAt(body, this.replay.bodies[index].frame);
      for (const hinge of hinges) {
        turn.setFromAxisAngle(hinge.axis, this.turnOf(hinge, angle_deg[hinge.joint] * RAD_PER_DEG));
        anchor.copy(hinge.at).applyQuaternion(body.quaternion);
        body.position.add(anchor);
        body.quaternion.multiply(turn);
        body.position.sub(anchor.copy(hinge.at).applyQuaternion(body.quaternion));
      }
    }
    if (object_frame) placeAt(this.bodies[this.replay.object.body], object_frame);
    this.world.updateMatrixWorld(true);
  }

  turnOf(hinge, joint_rad) {
    if (!hinge.coefficient) return joint_rad - hinge.zero_deg * RAD_PER_DEG;
    const x = joint_rad - hinge.leader_zero_rad;
    return hinge.coefficient.reduceRight((sum, coefficient) => sum * x + coefficient, 0);
  }

  // The angle of a joint [deg] as its body stands now.
  angleOf(joint) {
    const hinge = this.replay.hinges.find((h) => h.joint === joint && !h.coefficient);
    const turn = new THREE.Object3D();
    placeAt(turn, this.replay.bodies[hinge.body].frame);
    const {x, y, z, w} = turn.quaternion.conjugate().multiply(this.bodies[hinge.body].quaternion);
    const along = x * hinge.axis[0] + y * hinge.axis[1] + z * hinge.axis[2];
    return 2 * Math.atan2(along, w) / RAD_PER_DEG + hinge.zero_deg;
  }

  // Points of a cable's way in the world's frame, around its pulleys.
  cableWay(cable) {
    const {points} = cable;
    const at = (point) => new THREE.Vector3().fromArray(point.frame).applyMatrix4(this.bodies[point.body].matrixWorld);
    const way = [];
    points.forEach((point, i) => {
      if (!point.radius) way.push(at(point));
      else if (i > 0 && i + 1 < points.length) way.push(...this.around(point, way[way.length - 1], at(points[i + 1])));
    });
    return way;
  }

  // The points where a cable from p to q lies on a pulley; none where it passes beside it.
  around(pulley, p, q) {
    const there = this.bodies[pulley.body].matrixWorld.clone().multiply(transformOf(pulley.frame));
    const back = new THREE.Matrix4().getInverse(there);
    const from = p.clone().applyMatrix4(back);
    const to = q.clone().applyMatrix4(back);
    let side = null;
    if (pulley.side) {
      side = new THREE.Vector3(...pulley.side.at).applyMatrix4(this.bodies[pulley.side.body].matrixWorld)
        .applyMatrix4(back);
    }
    if (pulley.sphere) {  // in the plane of both ends and its middle
      const x = from.clone().normalize();
      const z = from.clone().cross(to).normalize();
      const plane = new THREE.Matrix4().makeBasis(x, z.clone().cross(x), z);
      const flat = new THREE.Matrix4().getInverse(plane);
      for (const point of [from, to, side]) point?.applyMatrix4(flat);
      there.multiply(plane);
    }
    return wrapArc([from.x, from.y], [to.x, to.y], pulley.radius, side && [side.x, side.y]).map(([x, y], i, arc) => {
      const share = arc.length > 1 ? i / (arc.length - 1) : 0.5;
      return new THREE.Vector3(x, y, from.z + (to.z - from.z) * share).applyMatrix4(there);
    });
  }
}

// The shortest way from p to q around a circle at the origin, on the side of `side` where one is given: the points on
// the circle; none where the straight way does not meet it, or leaves it on that side.
function wrapArc(p, q, radius, side) {
  const far_p = Math.hypot(...p);
  const far_q = Math.hypot(...q);
  if (far_p <= radius || far_q <= radius) return [];
  const [dx, dy] = [q[0] - p[0], q[1] - p[1]];
  const share = Math.min(1, Math.max(0, -(p[0] * dx + p[1] * dy) / (dx * dx + dy * dy || 1)));
  const [nx, ny] = [p[0] + share * dx, p[1] + share * dy];
  if (Math.hypot(nx, ny) >= radius && !(side && nx * side[0] + ny * side[1] < 0)) return [];
  let best = null;
  for (const sense of [1, -1]) {
    const first = Math.atan2(p[1], p[0]) + sense * Math.acos(radius / far_p);
    const last = Math.atan2(q[1], q[0]) - sense * Math.acos(radius / far_q);
    const sweep = ((sense * (last - first)) % (2 * Math.PI) + 2 * Math.PI) % (2 * Math.PI);
    if (sweep > 1.5 * Math.PI) continue;  // the straight parts would cross
    const middle = first + sense * sweep / 2;
    const merit = side ? Math.cos(middle) * side[0] + Math.sin(middle) * side[1] : -sweep;
    if (!best || merit > best.merit) best = {merit, first, sense, sweep};
  }
  if (!best) return [];
  const count = Math.max(2, Math.ceil(best.sweep / 0.2) + 1);
  return [...Array(count).keys()].map((i) => {
    const angle = best.first + best.sense * best.sweep * i / (count - 1);
    return [radius * Math.cos(angle), radius * Math.sin(angle)];
  });
}
