#!/bin/bash
# gymnasium-robotics 1.4.2 (PyPI): the joints of its Shadow hand, by their names.
#
# Guess: as in Shadow's documentation, where a finger's joints are numbered from 1: FFJ4 is the spread, FFJ3 the knuckle,
# FFJ1 the end joint, and each bends with positive angles.
# Seen: numbered from 0. robot0:FFJ3 is the spread (-0.349 to 0.349 rad, about the axis 0 1 0), FFJ2 the knuckle and FFJ0
# the end joint (0 to 1.571, about 1 0 0). The end joint of the thumb, THJ0, bends with negative angles (-1.571 to 0). So a
# recording of this hand that is read by Shadow's names has the spread as its knuckle, the knuckle as the middle joint, and so on.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check download --no-deps -d "$folder" gymnasium-robotics==1.4.2
"$folder/venv/bin/python" - "$folder"/*.whl <<'PYTHON'
import sys
import xml.etree.ElementTree as xml
import zipfile

with zipfile.ZipFile(sys.argv[1]) as wheel:
    hand = xml.fromstring(b"<hand>" + wheel.read("gymnasium_robotics/envs/assets/hand/robot.xml") + b"</hand>")
joints = {joint.get("name"): (joint.get("axis"), joint.get("range")) for joint in hand.iter("joint") if joint.get("name")}
for name in ("FFJ3", "FFJ2", "FFJ1", "FFJ0", "THJ0"):
    print(name, "axis", joints["robot0:" + name][0], "range", joints["robot0:" + name][1])
assert "robot0:FFJ4" not in joints, "the names say something else"
assert joints["robot0:FFJ3"] == ("0 1 0", "-0.349 0.349"), "FFJ3 is something else"
assert joints["robot0:FFJ2"] == ("1 0 0", "0 1.571"), "FFJ2 is something else"
assert joints["robot0:FFJ0"] == ("1 0 0", "0 1.571"), "FFJ0 is something else"
assert joints["robot0:THJ0"][1] == "-1.571 0", "THJ0 is something else"
PYTHON
