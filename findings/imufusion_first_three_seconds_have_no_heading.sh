#!/bin/bash
# imufusion 1.3.3 (PyPI), with NumPy 2.4.6: Ahrs without a magnetometer, of a sensor that turns about the vertical.
#
# Guess: a turn of 60 deg in 2 s is one of 60 deg, whenever it begins; the start only brings inclination in line quickly.
# Seen: begun with the first sample it is one of 0 deg, begun after 2 s one of 30: while it starts, 3 s at any rate, heading is
# set to 0 in each step, and what was turned meanwhile is lost for good. skip_startup() gives 60.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 imufusion==1.3.3
"$folder/venv/bin/python" - <<'PYTHON'
import imufusion
import numpy as np

RATE_HZ = 100  # the default of AhrsSettings
LEVEL_G = np.array([0.0, 0.0, 1.0])


def heading_deg(rest_s, skips=False):
    ahrs = imufusion.Ahrs()
    if skips:
        ahrs.skip_startup()
    for _ in range(int(rest_s * RATE_HZ)):
        ahrs.update_no_magnetometer(np.zeros(3), LEVEL_G)
    for _ in range(2 * RATE_HZ):
        ahrs.update_no_magnetometer(np.array([0.0, 0.0, 30.0]), LEVEL_G)
    return imufusion.quaternion_to_euler(ahrs.get_quaternion())[2]


found = {rest_s: heading_deg(rest_s) for rest_s in (0, 1, 2, 4)}
for rest_s, heading in found.items():
    print(f"60 deg, begun after {rest_s} s: {heading:.1f} deg")
print(f"60 deg, begun at once, without the start: {heading_deg(0, True):.1f} deg")
assert abs(found[0]) < 0.5 and abs(found[1]) < 0.5 and abs(found[2] - 30.0) < 0.5, "while it starts: something else"
assert abs(found[4] - 60.0) < 0.5 and abs(heading_deg(0, True) - 60.0) < 0.5, "after it: something else"
PYTHON
