#!/bin/bash
# ezc3d 1.7.2 and c3d 0.6.0 (PyPI), with NumPy 2.4.6: a marker of a hand that the cameras lost in one frame.
#
# Guess: a lost marker is NaN, or it has the residual -1 of the C3D format, in every reader.
# Seen, in one file that ezc3d writes: ezc3d reads NaN and a residual of 0, as of a marker that is there. c3d reads the
# place (0, 0, 0) and the residual -1. A check that holds for one misses the gap in the other: residual < 0 finds
# nothing with ezc3d, isnan nothing with c3d, where a finger jumps to the origin of the room for a frame.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 ezc3d==1.7.2 c3d==0.6.0
"$folder/venv/bin/python" - "$folder/hand.c3d" <<'PYTHON'
import sys
import warnings

import c3d
import ezc3d
import numpy as np

path, lost = sys.argv[1], 2
file = ezc3d.c3d()
file["parameters"]["POINT"]["RATE"]["value"] = [100]
file["parameters"]["POINT"]["LABELS"]["value"] = ("thumb_tip", "index_tip")
points = np.ones((4, 2, 5))
points[:3, 0] = 100.0
points[:3, 1] = 250.0 + np.arange(5)
points[:3, 1, lost] = np.nan
file["data"]["points"] = points
file.write(path)

read = ezc3d.c3d(path)
place = read["data"]["points"][:3, 1, lost]
residual = read["data"]["meta_points"]["residuals"][0, 1, lost]
print("ezc3d: place", place, "residual", residual)
warnings.simplefilter("ignore")
with open(path, "rb") as handle:
    row = [frame[1] for frame in c3d.Reader(handle).read_frames()][lost][1]
print("c3d:   place", row[:3], "residual", row[3])
assert np.isnan(place).all() and residual == 0.0, "ezc3d says something else"
assert (row[:3] == 0.0).all() and row[3] == -1.0, "c3d says something else"
PYTHON
