#!/bin/bash
# kalmanjs 1.1.0 (npm), a Kalman filter of one channel: new KalmanFilter({R, Q}), as r and q of a tuned filter.
#
# Guess: R is the variance of the measurement and Q that of the process, as in textbooks, filterpy and pykalman; behind a missing
# sample (NaN) everything is NaN, or the state stays.
# Seen: the letters are the other way round. With R = 3, Q = 0.01 of a noisy finger, behind a step from 0 to 90 deg the first
# sample gives 89.7 deg (almost no filter), where that tuning means 5.05 deg; with the letters exchanged it is 5.05 deg. A NaN
# comes out as NaN, and the filter then begins anew: the sample behind it, a spike of 90 deg above a finger at 10 deg,
# passes unfiltered.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
(cd "$folder" && npm install --loglevel=error --no-audit --no-fund --no-save --prefix . kalmanjs@1.1.0 >/dev/null)
cd "$folder"
node - <<'END'
const assert = require("assert");
const loaded = require("kalmanjs");
const KalmanFilter = loaded.default || loaded;

function afterStep(settings) {
  const filter = new KalmanFilter(settings);
  for (let i = 0; i < 1000; i++) filter.filter(0);
  return filter.filter(90);
}
// The gain of a random walk that has settled, with the variances of the textbook.
function gain(measurement, process) {
  const before = (process + Math.sqrt(process * process + 4 * process * measurement)) / 2;
  return before / (before + measurement);
}
const asNamed = afterStep({ R: 3, Q: 0.01 }), exchanged = afterStep({ R: 0.01, Q: 3 });
console.log("R 3, Q 0.01:", asNamed.toFixed(2), " R 0.01, Q 3:", exchanged.toFixed(2), " textbook:", (90 * gain(3, 0.01)).toFixed(2));
const finger = new KalmanFilter({ R: 0.01, Q: 3 });
for (let i = 0; i < 1000; i++) finger.filter(10);
const missing = finger.filter(NaN), spike = finger.filter(100);
console.log("missing:", missing, " then a spike of 100 deg:", spike);
assert(Math.abs(asNamed - 89.7) < 0.05 && Math.abs(exchanged - 90 * gain(3, 0.01)) < 1e-6);
assert(Number.isNaN(missing) && spike === 100);
END
