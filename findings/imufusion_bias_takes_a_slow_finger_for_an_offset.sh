#!/bin/bash
# imufusion 1.3.3 (PyPI), with NumPy 2.4.6: Bias, its estimate of a gyroscope's offset, before Ahrs, of a finger that bends slowly.
#
# Guess: an offset is learnt while the sensor stands still; a finger that moves evenly at 2.5 deg/s moves.
# Seen: what stays below 3 deg/s for 3 s counts as standing still; Of a steady turn by 75 deg
# in 30 s it has learnt 2.4 deg/s as an offset and shows 27 deg; and when the finger then rests, it turns back by 9 deg in 5 s.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 imufusion==1.3.3
"$folder/venv/bin/python" - <<'PYTHON'
import imufusion
import numpy as np

RATE_HZ = 100  # the default of both settings
bias, ahrs = imufusion.Bias(), imufusion.Ahrs()
ahrs.skip_startup()


def turn(speed_deg_s, seconds):
    """About the vertical, where gravity cannot correct the heading. Returns the heading."""
    for _ in range(int(seconds * RATE_HZ)):
        gyroscope = bias.update(np.array([0.0, 0.0, speed_deg_s]))
        ahrs.update_no_magnetometer(gyroscope, np.array([0.0, 0.0, 1.0]))
    return imufusion.quaternion_to_euler(ahrs.get_quaternion())[2]


moved = turn(2.5, 30)
learnt = bias.get_offset()[2]
rested = turn(0.0, 5)
print(f"after 30 s at 2.5 deg/s (75 deg): {moved:.1f} deg, offset {learnt:.2f} deg/s; after 5 s of rest: {rested:.1f} deg")
assert abs(moved - 26.7) < 1.0 and abs(learnt - 2.42) < 0.05, "a slow turn: something else"
assert abs(moved - rested - 9.0) < 1.0, "at rest behind it: something else"
PYTHON
