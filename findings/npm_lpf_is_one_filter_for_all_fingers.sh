#!/bin/bash
# lpf 1.0.0 (npm), a low pass: next() for a stream of each of two fingers, and smoothArray() of the same samples.
#
# Guess: next() is y += smoothing (x - y), as smoothArray() says in its source; two fingers have two filters; angles in rad
# are filtered as angles in deg are.
# Seen: 1. The module is one object: every require() gives the same memory. A finger at rest at 10 deg, whose samples come
# in turn with those of one at 90 deg, comes out at 33 deg. 2. next() filters its own last ten outputs again: of a step
# it has passed 50, 63, 72 % after three samples where smoothing 0.5 means 50, 75, 88 %. 3. smoothArray() rounds to whole
# numbers: a finger from 0 to 1 rad has only 0 and 1, and it overwrites its input.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
(cd "$folder" && npm install --loglevel=error --no-audit --no-fund --no-save --prefix . lpf@1.0.0 >/dev/null)
cd "$folder"
node - <<'END'
const assert = require("assert");
const [thumb, index] = [require("lpf"), require("lpf")];
thumb.smoothing = 0.5;

let atRest;
for (let i = 0; i < 50; i++) {
  index.next(90);
  atRest = thumb.next(10);
}
console.log("finger at 10 deg:", atRest.toFixed(1), "deg");
assert.ok(thumb === index && Math.abs(atRest - 32.8) < 0.1, "it is another object, or another angle");

thumb.init(Array(10).fill(0));
const step = [1, 1, 1].map((x) => thumb.next(x));
console.log("step:", step.map((x) => x.toFixed(3)).join(" "));
assert.deepStrictEqual(step.map((x) => x.toFixed(3)), ["0.500", "0.625", "0.719"], "next() is another filter");

const radians = [0, 0.4, 0.8, 1, 1, 1];
const smoothed = thumb.smoothArray(radians);
console.log("in rad:", smoothed.join(" "));
assert.ok(smoothed === radians && smoothed.every((x) => x === 0 || x === 1), "it no longer rounds");
END
