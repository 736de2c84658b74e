#!/usr/bin/env python3
"""Makes angles_01.csv to angles_25.csv, angles.csv and targets.csv by fingertips: the recorded Adroit
hand moves by its own joints, and `gauntlet retarget` finds the angles of models/hand_arm.xml.

Usage: make_retargeted.py PICKLE ADROIT [--program GAUNTLET] [--hand HAND.xml] [--out FOLDER]
PICKLE: door-v0_demos.pickle of github.com/aravindr93/hand_dapg, commit 9a1de23. ADROIT: a checkout of
github.com/vikashplus/Adroit, commit c98c9c9. Needs numpy. Smoothing, rests and joins are those of
make_door_opening.py, for the joints of Adroit. Wrist, forearm, elbow and shoulder are as there.
"""

import argparse
import pathlib
import pickle
import shutil
import subprocess
import tempfile

import make_door_opening as door

ARM = ("wrist_flexion", "wrist_deviation", "forearm_rotation", "elbow_flexion", "shoulder_flexion")
JOINTS = ["ARRx", "ARRy", "ARRz", "WRJ1", "WRJ0"]
for finger in ("FF", "MF", "RF"):
    JOINTS += [f"{finger}J{i}" for i in (3, 2, 1, 0)]
JOINTS += [f"LFJ{i}" for i in (4, 3, 2, 1, 0)] + [f"THJ{i}" for i in (4, 3, 2, 1, 0)]
PALM_COLUMN = 29  # of the observations: 27 joints, latch, door, then the palm's place

HAND = """<mujoco model="Adroit">
  <include file="resources/assets.xml"/>
  <compiler autolimits="true"/>
  <worldbody><include file="resources/chain.xml"/></worldbody>
</mujoco>
"""


def read(path):
    """Observations and actions, as make_door_opening.py has them."""
    with open(path, "rb") as file:
        demos = pickle.load(file)
    observations, actions = [], []
    for number, demo in enumerate(demos):
        for row in demo["observations"]:
            palm = {"palm_" + axis: row[PALM_COLUMN + i] for i, axis in enumerate("xyz")}
            observations.append({"demo": number, **palm,
                                 **{"q_" + joint: row[i] for i, joint in enumerate(JOINTS)}})
        for row in demo["actions"]:  # the first one is ARTz
            actions.append({"a_" + joint: row[i + 1] for i, joint in enumerate(JOINTS)})
    return observations, actions


def adroit_channels():
    """Joints of Adroit's fingers in place of the channels of the glove."""
    channels = {joint + "_deg": (-180, 180, lambda q, palm, joint=joint: q[joint])
                for joint in JOINTS if joint[:2] in ("FF", "MF", "RF", "LF", "TH")}
    return channels | {name: door.CHANNELS[name] for name in ARM}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pickle", type=pathlib.Path)
    parser.add_argument("adroit", type=pathlib.Path)
    here = pathlib.Path(__file__).resolve().parent
    parser.add_argument("--program", default="gauntlet")
    parser.add_argument("--hand", default=str(here.parents[2] / "models" / "hand_arm.xml"))
    parser.add_argument("--out", type=pathlib.Path, default=here)
    options = parser.parse_args()
    observations, actions = read(options.pickle)
    door.CHANNELS = adroit_channels()
    options.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        shutil.copytree(options.adroit, folder / "Adroit")  # its meshes are at ../Adroit
        (folder / "Adroit" / "hand.xml").write_text(HAND)
        door.all_demonstrations(observations, folder)
        door.three_demonstrations(observations, actions, folder)
        for recording in sorted(folder.glob("*.csv")):
            subprocess.run([options.program, "retarget", recording, "--from", folder / "Adroit" / "hand.xml",
                            "--hand", options.hand, "--out", options.out / recording.name], check=True)


if __name__ == "__main__":
    main()
