#!/bin/bash
# scipy 1.17.1, ahrs 0.4.0, numpy-quaternion 2024.0.13, pyquaternion 0.9.9, quaternionic 1.0.18 and pytransform3d 3.17.0 (PyPI), with
# NumPy 2.4.6: halfway between two samples of a hand that turns its palm up, 175 and 185 deg about its x axis. The quaternions are those of
# scipy's as_quat(canonical=True), w >= 0, as many sensors send them; so the second has the other sign.
#
# Guess: q and -q are one posture, and interpolation takes the short way: 180 deg, by all of them; so does a mean.
# Seen: the slerp of scipy, ahrs, numpy-quaternion and pyquaternion gives 180 deg. That of quaternionic and of pytransform3d goes the long
# way and gives 0 deg, the palm down (pytransform3d: unless shortest_path=True). The means of scipy and ahrs are 180 deg, and
# mean_rotor_in_chordal_metric() of numpy-quaternion, whose own slerp is right, is 0 deg.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.11 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 scipy==1.17.1 ahrs==0.4.0 numpy-quaternion==2024.0.13 \
  pyquaternion==0.9.9 quaternionic==1.0.18 pytransform3d==3.17.0
"$folder/venv/bin/python" -W ignore - <<'PYTHON'
import ahrs
import numpy as np
import pyquaternion
import quaternion
import quaternionic
from pytransform3d.rotations import quaternion_slerp
from scipy.spatial.transform import Rotation, Slerp

turned = Rotation.from_euler("x", [[175], [185]], degrees=True)
xyzw = turned.as_quat(canonical=True)
first, second = wxyz = np.roll(xyzw, 1, axis=1)
assert (wxyz[:, 0] >= 0).all() and first @ second < 0


def turn_deg(quaternion_wxyz):
    w, x = np.asarray(quaternion_wxyz, dtype=float)[:2]
    return round(np.degrees(2 * np.arctan2(x, w)) % 360)


one, other = quaternion.from_float_array(wxyz)
both = quaternionic.array(wxyz)
slerps = {"scipy": np.roll(Slerp([0, 1], Rotation.from_quat(xyzw))(0.5).as_quat(), 1),
          "ahrs": ahrs.common.quaternion.slerp(first, second, [0.5])[0],
          "numpy-quaternion": quaternion.as_float_array(quaternion.slerp_evaluate(one, other, 0.5)),
          "pyquaternion": pyquaternion.Quaternion.slerp(pyquaternion.Quaternion(first), pyquaternion.Quaternion(second), 0.5).elements,
          "quaternionic": quaternionic.interpolation.slerp(both[0], both[1], 0.5).ndarray,
          "pytransform3d": quaternion_slerp(first, second, 0.5),
          "pytransform3d, shortest_path": quaternion_slerp(first, second, 0.5, shortest_path=True)}
means = {"scipy": np.roll(turned.mean().as_quat(), 1), "ahrs": ahrs.QuaternionArray(wxyz).average(),
         "numpy-quaternion": quaternion.as_float_array(quaternion.mean_rotor_in_chordal_metric(quaternion.from_float_array(wxyz)))}
slerps = {name: turn_deg(value) for name, value in slerps.items()}
means = {name: turn_deg(value) for name, value in means.items()}
print("halfway [deg]:", slerps)
print("mean [deg]:   ", means)
assert slerps == {"scipy": 180, "ahrs": 180, "numpy-quaternion": 180, "pyquaternion": 180, "quaternionic": 0, "pytransform3d": 0,
                  "pytransform3d, shortest_path": 180}, "another way round"
assert means == {"scipy": 180, "ahrs": 180, "numpy-quaternion": 0}, "the mean is another"
PYTHON
