#!/bin/bash
# kalidokit 1.1.5 (npm): angles of a hand from 21 landmarks, Hand.solve(), of fingers whose last joint is straight.
#
# Guess: a straight joint has the angle 0.
# Seen: it is 0 or NaN, as the last digits of the cosine happen to be: one above 1 goes into acos() as it is. Of 181 fingers
# that point from 0 to 180 deg with three joints in one line, more than ten have NaN, the others 0. A rig whose bone gets a NaN
# loses the finger. Recorded hands are rarely that straight; hands from a model or a rounded file are.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
(cd "$folder" && npm install --loglevel=error --no-audit --no-fund --no-save --prefix . kalidokit@1.1.5 >/dev/null)
cd "$folder"
node - <<'END'
const assert = require("assert");
const { Hand } = require("./node_modules/kalidokit/dist/kalidokit.umd.js");

// All five fingers are straight and lie in the plane of the palm; the index finger leans.
function landmarks(lean_deg) {
  const points = [{ x: 0, y: 0, z: 0 }];
  const lean = (lean_deg * Math.PI) / 180;
  for (let finger = 0; finger < 5; finger++) {
    const [sideways, up] = finger === 1 ? [Math.cos(lean), Math.sin(lean)] : [0, 1];
    const knuckle = { x: 0.1 * (finger - 2), y: -0.5 };
    for (let bone = 0; bone < 4; bone++) {
      points.push({ x: knuckle.x + 0.1 * bone * sideways, y: knuckle.y - 0.1 * bone * up, z: 0 });
    }
  }
  return points;
}

let [zero, none, other] = [0, 0, 0];
for (let lean = 0; lean <= 180; lean++) {
  const z = Hand.solve(landmarks(lean), "Right").RightIndexDistal.z;
  if (Number.isNaN(z)) none++;
  else if (Math.abs(z) < 1e-6) zero++;
  else other++;
}
console.log(`of 181 straight fingers: ${zero} have 0, ${none} have NaN, ${other} another angle`);
assert.ok(none > 10 && zero > 10 && other === 0, "straight joints: something else");
END
