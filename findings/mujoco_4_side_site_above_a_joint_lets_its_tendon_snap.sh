#!/bin/bash
# mujoco 3.17.0 and mujoco-core 4.0.0 (PyPI), Python 3.11: the extensor tendon of a finger over the drum of its joint.
#
# Guess: the length of a tendon is geometry. One model has one length at one angle, in every version.
# Seen: with its side site straight above the joint, both give 100.00 mm at 0 deg and 115.79 mm at 90 deg. At 110 deg
# 3.17.0 gives 119.28 mm, and 4.0.0 gives 77.02: the tendon has left the drum. Since 4.0.0 it goes round the drum as the
# line from end through side site to end does, and this line changes sides when an end passes the ray opposite the side
# site (here at 103 deg). No version prints a warning. With the
# side site 45 deg towards the finger both give 119.28 mm.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat >"$folder/finger.py" <<'PYTHON'
import sys
import mujoco
import numpy as np

MODEL = """<mujoco><worldbody>
  <site name="root" pos="-0.05 0 0.012"/>
  <geom name="drum" type="cylinder" size="0.01 0.01" euler="90 0 0" mass="0.1"/>
  <site name="side" pos="SIDE"/>
  <body>
    <joint name="pip" type="hinge" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 0.05 0 0" size="0.004"/>
    <site name="tip" pos="0.05 0 0.012"/>
  </body>
</worldbody><tendon>
  <spatial><site site="root"/><geom geom="drum" sidesite="side"/><site site="tip"/></spatial>
</tendon></mujoco>"""
model = mujoco.MjModel.from_xml_string(MODEL.replace("SIDE", sys.argv[2]))
data = mujoco.MjData(model)
lengths_mm = []
for angle_deg in (0, 90, 110):
    data.qpos[0] = np.radians(angle_deg)
    mujoco.mj_forward(model, data)
    lengths_mm.append(1e3 * data.ten_length[0])
print(sys.argv[1], "side site at", sys.argv[2], "m, at 0, 90, 110 deg:", np.round(lengths_mm, 2), "mm")
assert np.allclose(lengths_mm, [float(length) for length in sys.argv[3:]], atol=0.02), lengths_mm
PYTHON
for package in mujoco==3.17.0 mujoco-core==4.0.0; do
  python3.11 -m venv "$folder/$package"
  "$folder/$package/bin/pip" -q --disable-pip-version-check install "$package" numpy
done
old=$folder/mujoco==3.17.0/bin/python
new=$folder/mujoco-core==4.0.0/bin/python
"$old" "$folder/finger.py" 3.17.0 "0 0 0.012" 100.00 115.79 119.28
"$new" "$folder/finger.py" 4.0.0 "0 0 0.012" 100.00 115.79 77.02
for python in "$old" "$new"; do
  "$python" "$folder/finger.py" both "0.0085 0 0.0085" 100.00 115.79 119.28
done
