#!/bin/bash
# filterpy 1.4.5 and 2.0.0 (PyPI), with NumPy 2.4.6: kinematic_kf(dim=2, order=1), a filter of position and speed of two fingers.
#
# Guess: as the documentation of both says, z has the position of each dimension, so fingers at 10 and 40 deg settle there.
# Seen: in 1.4.5 they do. In 2.0.0 each row of H is 1 0 1 0: every measurement is that of the sum of both positions. With
# dim_z=2, which it now takes for z to have two values, both fingers settle at 12.5 deg, without a word. Without dim_z, z has
# one value, and two are a ValueError. Set H after the call.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat >"$folder/fingers.py" <<'PYTHON'
import sys

import filterpy
import numpy as np
from filterpy.common import kinematic_kf

is_new = filterpy.__version__.startswith("2.")
kf = kinematic_kf(2, 1, dt=0.01, dim_z=2) if is_new else kinematic_kf(2, 1, dt=0.01)


def settled():
    for _ in range(1000):
        kf.predict()
        kf.update(np.array([[10.0], [40.0]]))
    return kf.x.ravel()[[0, 2]]


as_made = settled()
print(filterpy.__version__, "H:", kf.H.tolist(), "settles at:", as_made.round(2))
kf.H = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]])
mended = settled()
print("with H set:", mended.round(2))
sys.exit(not (np.allclose(as_made, [12.5, 12.5] if is_new else [10, 40], atol=0.01) and np.allclose(mended, [10, 40], atol=0.1)))
PYTHON
for version in 1.4.5 2.0.0; do
  python3 -m venv "$folder/$version"
  pip=("$folder/$version/bin/pip" -q --disable-pip-version-check)
  "${pip[@]}" install setuptools wheel
  "${pip[@]}" install numpy==2.4.6 scipy==1.17.1 "filterpy==$version" 2>/dev/null
  "$folder/$version/bin/python" -W ignore "$folder/fingers.py"
done
