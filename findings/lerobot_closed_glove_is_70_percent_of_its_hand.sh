#!/bin/bash
# lerobot 0.4.4 (PyPI): its map of the Homunculus glove to the HopeJR hand.
#
# Guess: a glove that is closed (all flexions 100) closes the hand (all motors 100), and one that is open and spread leaves
# the motors within their 0 to 100.
# Seen: the flexors of index, middle and ring finger get 70, those of the little finger 50, while pip and dip get 100. Open
# and spread, one flexor gets 30 (50) and the other -30 (-50), below the motors' range. A range of motion that is measured
# behind this map says that knuckles close to 70 % or 50 %.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check download --no-deps -d "$folder" lerobot==0.4.4
"$folder/venv/bin/python" - "$folder"/*.whl <<'PYTHON'
import sys
import zipfile

with zipfile.ZipFile(sys.argv[1]) as wheel:
    # This file needs no other; the package itself needs PyTorch.
    code = wheel.read("lerobot/teleoperators/homunculus/joints_translation.py")
module = {}
exec(compile(code, "joints_translation.py", "exec"), module)


class Glove(dict):
    def __init__(self, flexion, abduction):
        super().__init__()
        self.flexion, self.abduction = flexion, abduction

    def __missing__(self, name):
        return self.abduction if "abduction" in name else self.flexion


to_hand = module["homunculus_glove_to_hope_jr_hand"]
closed, spread = to_hand(Glove(100.0, 0.0)), to_hand(Glove(0.0, 100.0))
for name in ("index_radial_flexor.pos", "index_ulnar_flexor.pos", "pinky_ulnar_flexor.pos", "index_pip_dip.pos"):
    print(f"{name:24} closed {closed[name]:6.1f}  spread {spread[name]:6.1f}")
assert closed["index_radial_flexor.pos"] == closed["index_ulnar_flexor.pos"] == 70.0, "index: something else"
assert closed["pinky_ulnar_flexor.pos"] == 50.0 and closed["index_pip_dip.pos"] == 100.0, "little finger: something else"
assert spread["index_radial_flexor.pos"] == 30.0 and spread["index_ulnar_flexor.pos"] == -30.0, "spread: something else"
assert spread["pinky_ulnar_flexor.pos"] == -50.0, "spread of the little finger: something else"
PYTHON
