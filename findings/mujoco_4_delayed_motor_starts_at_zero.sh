#!/bin/bash
# mujoco 4.0.0 (PyPI), Python 3.11: a bent finger is reset to its keyframe, qpos="1" ctrl="1". Its motor and its sensor have a delay of
# 40 ms, delay="0.04" nsample="20" with a time step of 2 ms.
#
# Guess: the keyframe is where the finger rests: nothing moves while ctrl stays, as without the delay.
# Seen: for 40 ms the motor gets 0 and the sensor reads 0: the history begins with zeros, whatever the keyframe says. The finger opens from
# 1 to 0.32 rad and comes back; a controller that closes its loop by this sensor sees a straight finger. mj_initCtrlHistory() and
# mj_initSensorHistory() behind each reset fill the history.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.11 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 mujoco==4.0.0
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import mujoco
import numpy as np

MODEL = """<mujoco><option timestep="0.002" gravity="0 0 0"/>
<worldbody><body><joint name="pip" type="hinge" axis="0 1 0" damping="0.02" armature="0.001"/>
<geom type="capsule" fromto="0 0 0 0.04 0 0" size="0.008" mass="0.02" contype="0" conaffinity="0"/></body></worldbody>
<actuator><position joint="pip" kp="2" kv="0.05" %s/></actuator>
<sensor><jointpos joint="pip" %s/></sensor>
<keyframe><key qpos="1" ctrl="1"/></keyframe></mujoco>"""
DELAY = 'delay="0.04" nsample="20"'


def run(delay, fills):
    """Lowest angle [rad] in 0.2 s behind the reset, and the readings of the sensor."""
    model = mujoco.MjModel.from_xml_string(MODEL % (delay, delay))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    if fills:
        times = data.time - model.opt.timestep * np.arange(20, 0, -1)
        mujoco.mj_initCtrlHistory(model, data, 0, times, np.full(20, data.ctrl[0]))
        mujoco.mj_initSensorHistory(model, data, 0, times, np.full((20, 1), data.qpos[0]), 0.0)
    angles, readings = [], []
    for _ in range(100):
        mujoco.mj_step(model, data)
        angles.append(data.qpos[0])
        readings.append(data.sensordata[0])
    return min(angles), readings


for name, delay, fills in (("without a delay", "", False), ("with a delay", DELAY, False), ("filled", DELAY, True)):
    lowest, readings = run(delay, fills)
    print(f"{name}: lowest angle {lowest:.2f} rad, {np.count_nonzero(np.array(readings) == 0)} readings of 0")
assert run("", False)[0] > 0.999
lowest, readings = run(DELAY, False)
assert abs(lowest - 0.322) < 0.01 and readings[:20] == [0] * 20 and readings[20] > 0.9, "the history begins with something else"
lowest, readings = run(DELAY, True)
assert lowest > 0.999 and min(readings) > 0.999
PYTHON
