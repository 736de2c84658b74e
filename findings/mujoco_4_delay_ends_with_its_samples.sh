#!/bin/bash
# mujoco 4.0.0 (PyPI), Python 3.11: a motor that is 40 ms late, delay="0.04", with nsample="5", and a glove that is read every 10 ms,
# interval="0.01"; the time step is 2 ms.
#
# Guess: the delay is the delay; five samples are a coarse history of it, or the compiler asks for 20. The sensor holds its value for 10 ms.
# Seen: the command arrives after 10 ms, 5 steps, and the sensor with delay="0.04" nsample="5" is as early: what is older than the history is
# not delayed any more. interval="0.01" alone holds nothing, the sensor is new in each step; only with nsample="1" beside it does it
# hold. Neither is a warning.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.11 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 mujoco==4.0.0
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON' 2>&1
import os

import mujoco

MODEL = """<mujoco><option timestep="0.002" gravity="0 0 0"/>
<worldbody><body><joint name="pip" type="hinge" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0.04 0 0" size="0.008" mass="0.02" contype="0" conaffinity="0"/></body></worldbody>
<actuator><motor joint="pip" %s/></actuator><sensor><jointpos joint="pip"/><jointpos joint="pip" %s/></sensor></mujoco>"""


def arrives_ms(options):
    """When a command of step 50 moves the motor."""
    model = mujoco.MjModel.from_xml_string(MODEL % (options, ""))
    data = mujoco.MjData(model)
    for step in range(100):
        data.ctrl[0] = step >= 50
        mujoco.mj_step(model, data)
        if data.actuator_force[0] != 0:
            return 2 * (step - 50)


def ages_ms(options):
    """Ages of the sensor's value from step 50 on, of a finger at 1 rad/s."""
    model = mujoco.MjModel.from_xml_string(MODEL % ("", options))
    data = mujoco.MjData(model)
    data.qvel[0] = 1
    ages = []
    for _ in range(60):
        mujoco.mj_step(model, data)
        ages.append(round(1e3 * (data.sensordata[0] - data.sensordata[1])))
    return ages[50:]


motor = {options: arrives_ms(options) for options in ('delay="0.04" nsample="20"', 'delay="0.04" nsample="5"')}
print("motor:", motor)
assert list(motor.values()) == [40, 10], "the delay is another"
sensor = {options: ages_ms(options) for options in ('delay="0.04" nsample="20"', 'delay="0.04" nsample="5"', 'interval="0.01"',
                                                    'interval="0.01" nsample="1"')}
for options, ages in sensor.items():
    print(f"sensor, {options}: ages {ages} ms")
assert list(sensor.values())[:3] == [[40] * 10, [10] * 10, [0] * 10], "the sensor is another"
assert max(sensor['interval="0.01" nsample="1"']) == 8
assert not os.path.exists("MUJOCO_LOG.TXT"), "it warns"
PYTHON
