#!/bin/bash
# kalidokit 1.1.5 (npm): angles of a hand from 21 landmarks, Hand.solve(), of an index finger whose middle joint bends.
#
# Guess: the bend of the joint comes out as it is, 0 to 110 deg of a fist, and a joint that bends backwards has the other sign.
# Seen: the angle between two bones is folded at 90 deg: a joint at 100, 110 and 130 deg is given as 80, 70 and 50, so that a
# closing fist opens again; -30 deg, bent backwards, is given as 30 deg are. Nothing is said.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
(cd "$folder" && npm install --loglevel=error --no-audit --no-fund --no-save --prefix . kalidokit@1.1.5 >/dev/null)
cd "$folder"
node - <<'END'
const assert = require("assert");
const { Hand } = require("./node_modules/kalidokit/dist/kalidokit.umd.js");

// A flat right hand that points up in the picture; only the middle joint of the index finger (landmark 6) bends.
function landmarks(bend_deg) {
  const points = [{ x: 0, y: 0, z: 0 }];
  const knuckles = [[-0.3, -0.2], [-0.1, -0.5], [0, -0.5], [0.1, -0.5], [0.2, -0.45]];
  knuckles.forEach(([x, y], finger) => {
    let [height, depth] = [y, 0];
    points.push({ x, y: height, z: depth });
    for (let bone = 1; bone < 4; bone++) {
      const bend = finger === 1 && bone >= 2 ? (bend_deg * Math.PI) / 180 : 0;
      height -= 0.1 * Math.cos(bend);
      depth -= 0.1 * Math.sin(bend);
      points.push({ x, y: height, z: depth });
    }
  });
  return points;
}

const given = new Map();
for (const bend of [-30, 30, 60, 90, 100, 110, 130]) {
  const z = Hand.solve(landmarks(bend), "Right").RightIndexIntermediate.z;
  given.set(bend, (-z * 180) / Math.PI);
  console.log(`${bend} deg is given as ${given.get(bend).toFixed(1)} deg`);
}
const is = (bend, angle) => Math.abs(given.get(bend) - angle) < 0.01;
assert.ok(is(30, 30) && is(60, 60) && is(90, 90), "up to 90 deg: something else");
assert.ok(is(100, 80) && is(110, 70) && is(130, 50), "beyond 90 deg: something else");
assert.ok(is(-30, 30), "bent backwards: something else");
END
