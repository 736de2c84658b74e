#!/bin/bash
# pin 4.1.0 (Pinocchio), ikpy 4.2.1, mujoco 4.0.0 and yourdfpy 0.0.60 (PyPI), Python 3.11: the URDF of a finger with one motor,
# whose second joint has <mimic joint="mcp" multiplier="0.8" offset="0.1"/>.
#
# Guess: the file says that the joints are coupled, so each reader has one free joint, and one fingertip for mcp at 1 rad.
# Seen: yourdfpy alone does: the tip is at x = 11.9 mm. Pinocchio has two free joints and the tip at 37.8 mm, unless
# buildModelFromUrdf() is told mimic=True. ikpy also has two, and no word for it. MuJoCo has two and an equality, which holds
# in mj_step() but not in mj_forward(): also 37.8 mm. So angles of one reader move the finger of another by 26 mm.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.11 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install pin==4.1.0 ikpy==4.2.1 mujoco==4.0.0 yourdfpy==0.0.60
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PYTHON'
import sys

import ikpy.chain
import mujoco
import numpy as np
import pinocchio
import yourdfpy

LINK = ('<link name="%s"><inertial><mass value="0.01"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/>'
        "</inertial></link>")
JOINT = ('<joint name="%s" type="revolute"><parent link="%s"/><child link="%s"/><origin xyz="%s 0 0"/><axis xyz="0 1 0"/>'
         '<limit lower="0" upper="1.6" effort="1" velocity="1"/>%s</joint>')
with open("finger.urdf", "w") as file:
    file.write('<robot name="finger">' + "".join(LINK % name for name in ("palm", "near", "far", "tip"))
               + JOINT % ("mcp", "palm", "near", 0, "")
               + JOINT % ("pip", "near", "far", 0.04, '<mimic joint="mcp" multiplier="0.8" offset="0.1"/>')
               + '<joint name="end" type="fixed"><parent link="far"/><child link="tip"/><origin xyz="0.03 0 0"/></joint></robot>')
seen = {}

for name, options in (("pinocchio", {}), ("pinocchio, mimic=True", {"mimic": True})):
    model = pinocchio.buildModelFromUrdf("finger.urdf", **options)
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, np.array([1.0, 0.0][:model.nq]))
    seen[name] = model.nq, data.oMf[model.getFrameId("tip")].translation[0]

chain = ikpy.chain.Chain.from_urdf_file("finger.urdf", base_elements=["palm"])
free = sum(link.joint_type == "revolute" for link in chain.links)
seen["ikpy"] = free, chain.forward_kinematics([0.0, 1.0, 0.0, 0.0])[0, 3]

text = open("finger.urdf").read().replace(">", '><mujoco><compiler fusestatic="false"/></mujoco>', 1)
model = mujoco.MjModel.from_xml_string(text)
data = mujoco.MjData(model)
data.qpos[0] = 1.0
mujoco.mj_forward(model, data)
seen["mujoco"] = model.nq, data.body("tip").xpos[0]

robot = yourdfpy.URDF.load("finger.urdf", load_meshes=False)
robot.update_cfg([1.0])
seen["yourdfpy"] = robot.num_actuated_joints, robot.get_transform("tip", "palm")[0, 3]

for name, (count, x_m) in seen.items():
    print(f"{name}: {count} free joints, tip at x = {1e3 * x_m:.1f} mm")
coupled = {"yourdfpy", "pinocchio, mimic=True"}
ok = all((count, round(1e3 * x_m, 1)) == ((1, 11.9) if name in coupled else (2, 37.8)) for name, (count, x_m) in seen.items())
sys.exit(not (ok and model.neq == 1))
PYTHON
