#!/usr/bin/env python3
"""Makes angles_01.csv to angles_25.csv, one for each demonstration of a person who opens a door, and
angles.csv and targets.csv of three of them.

Usage: make_door_opening.py PICKLE ADROIT [--program GAUNTLET] [--hand HAND.xml] [--out FOLDER]
PICKLE: door-v0_demos.pickle of github.com/aravindr93/hand_dapg, commit 9a1de23. ADROIT: a checkout of
github.com/vikashplus/Adroit, commit c98c9c9. Needs numpy. The recorded hand moves by its own joints, and
`gauntlet retarget` finds the angles of models/hand_arm.xml whose fingertips do the same (README.md).
"""

import argparse
import csv
import math
import pathlib
import pickle
import shutil
import subprocess
import tempfile

RATE_HZ = 100
THREE_DEMOS = (0, 10, 13)  # they fit the ranges with almost no clamping
SKIP_SAMPLES = 20  # the simulated hand springs from its zero posture to the first target
REST_S = 1.0  # the first and the last posture held, so that rest can be scored
SMOOTHING_S = 0.020  # standard deviation of the Gaussian; -3 dB at 6.6 Hz
JOIN_S = 0.4  # from the end of one demonstration to the start of the next
# Of a demonstration by itself: a posture held, then up to its first speed; brake, then rest.
LEAD_REST_S, LEAD_S, BRAKE_S, LAST_REST_S = 0.4, 0.3, 0.3, 0.5

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

# Ranges of the actuators [rad]: target -1 is the lower end, +1 the upper end.
TARGET_RANGE_RAD = {
    "ARRx": (-0.75, 0.75), "ARRy": (-0.75, 0.75), "ARRz": (-1.0, 2.0),
    "WRJ1": (-0.524, 0.175), "WRJ0": (-0.79, 0.61), "LFJ4": (0.0, 0.7),
    "THJ4": (-1.0, 1.0), "THJ3": (0.0, 1.3), "THJ2": (-0.26, 0.26), "THJ1": (-0.52, 0.52),
    "THJ0": (-1.571, 0.0),
}
for finger in ("FF", "MF", "RF", "LF"):
    TARGET_RANGE_RAD[finger + "J3"] = (-0.44, 0.44)
    for joint in ("J2", "J1", "J0"):
        TARGET_RANGE_RAD[finger + joint] = (0.0, 1.6)

# channel: (lowest, highest [deg], function of the Adroit joints [deg] and of the palm [m])
CHANNELS = {
    "thumb_rotation": (0, 140, lambda q, palm: 45 + q["THJ4"]),
    "thumb_abduction": (0, 60, lambda q, palm: 0.7 * q["THJ3"]),
    "thumb_mcp": (0, 60, lambda q, palm: -q["THJ1"]),
    "thumb_ip": (-15, 80, lambda q, palm: -q["THJ0"]),
    "index_mcp": (-45, 90, lambda q, palm: q["FFJ2"]),
    "index_pip": (0, 100, lambda q, palm: q["FFJ1"]),
    "middle_mcp": (-45, 90, lambda q, palm: q["MFJ2"]),
    "middle_pip": (0, 100, lambda q, palm: q["MFJ1"]),
    "ring_mcp": (-45, 90, lambda q, palm: q["RFJ2"]),
    "ring_pip": (0, 100, lambda q, palm: q["RFJ1"]),
    "little_mcp": (-45, 90, lambda q, palm: q["LFJ2"]),
    "little_pip": (0, 100, lambda q, palm: q["LFJ1"]),
    "finger_spread": (0, 25, lambda q, palm:
                      10 + 0.25 * (q["FFJ3"] - 0.5 * (q["RFJ3"] + q["LFJ3"]))),
    "wrist_flexion": (-70, 75, lambda q, palm: q["WRJ0"]),
    "wrist_deviation": (-20, 35, lambda q, palm: -q["WRJ1"]),
    "forearm_rotation": (-70, 85, lambda q, palm: q["ARRz"] - 28.6),
    "elbow_flexion": (0, 145, lambda q, palm: 70 - 100 * palm[1] + 60 * (palm[2] - 0.2)),
    "shoulder_flexion": (-30, 120, lambda q, palm: 30 + 80 * palm[1] + 60 * (palm[2] - 0.2)),
}


# What is retargeted: Adroit's fingers as they are, with the channels of arm and wrist.
ARM = ("wrist_flexion", "wrist_deviation", "forearm_rotation", "elbow_flexion", "shoulder_flexion")
ADROIT = {joint + "_deg": (-180, 180, lambda q, palm, joint=joint: q[joint])
          for joint in JOINTS if joint[:2] in ("FF", "MF", "RF", "LF", "TH")}
ADROIT |= {name: CHANNELS[name] for name in ARM}


def read(path):
    """Per demonstration the joints [rad], palms [m] and actions (-1 to 1) of its rows."""
    with open(path, "rb") as file:
        demos = pickle.load(file)
    return [[({joint: row[i] for i, joint in enumerate(JOINTS)}, row[PALM_COLUMN:PALM_COLUMN + 3],
              {joint: action[i + 1] for i, joint in enumerate(JOINTS)})  # the first one is ARTz
             for row, action in zip(demo["observations"], demo["actions"])][SKIP_SAMPLES:]
            for demo in demos]


def channel_angles(channels, joints_deg, palm):
    return [min(max(angle(joints_deg, palm), low), high) for low, high, angle in channels.values()]


def angles_of(channels, demo):
    return smooth([channel_angles(channels, {joint: math.degrees(value) for joint, value in q.items()}, palm)
                   for q, palm, _ in demo])


def targets_of(channels, demo):
    rows = []
    for _, palm, action in demo:
        joints = {joint: math.degrees(0.5 * (low + high) + action[joint] * 0.5 * (high - low))
                  for joint, (low, high) in TARGET_RANGE_RAD.items()}
        rows.append(channel_angles(channels, joints, palm))
    return rows


def smooth(rows):
    """Zero-phase Gaussian over time: the simulated fingers tremble with the noise of the targets
    and bounce at contacts (up to 1500 deg/s); a person's fingers do neither."""
    reach = round(4 * SMOOTHING_S * RATE_HZ)
    weights = [math.exp(-0.5 * (k / (SMOOTHING_S * RATE_HZ)) ** 2)
               for k in range(-reach, reach + 1)]
    total = sum(weights)
    result = []
    for index in range(len(rows)):
        near = [rows[min(max(index + k, 0), len(rows) - 1)] for k in range(-reach, reach + 1)]
        result.append([sum(w * row[c] for w, row in zip(weights, near)) / total
                       for c in range(len(rows[0]))])
    return result


def quintic(start, start_speed, end, end_speed, duration_s, t):
    """Position of the fifth-order polynomial with these ends and no acceleration at them."""
    s = t / duration_s
    v0, v1, d = start_speed * duration_s, end_speed * duration_s, end - start
    return start + v0 * s + (10 * d - 6 * v0 - 4 * v1) * s**3 \
        + (-15 * d + 8 * v0 + 7 * v1) * s**4 + (6 * d - 3 * v0 - 3 * v1) * s**5


def join(channels, before, after, duration_s):
    """Samples between the last of `before` and the first of `after`, without either."""
    steps = round(duration_s * RATE_HZ)
    rows = []
    for step in range(1, steps):
        row = []
        for channel, (low, high, _) in enumerate(channels.values()):
            speed0 = (before[-1][channel] - before[-2][channel]) * RATE_HZ if len(before) > 1 else 0
            speed1 = (after[1][channel] - after[0][channel]) * RATE_HZ if len(after) > 1 else 0
            value = quintic(before[-1][channel], speed0, after[0][channel], speed1, duration_s,
                            step / RATE_HZ)
            row.append(min(max(value, low), high))
        rows.append(row)
    return rows


def write(path, channels, rows):
    with open(path, "w", newline="") as file:
        file.write("time_s," + ",".join(channels) + "\n")
        for index, row in enumerate(rows):
            cells = ["" if value is None else f"{value:.3f}" for value in row]
            file.write(f"{index / RATE_HZ:.2f}," + ",".join(cells) + "\n")


def brought_to_rest(channels, row, speed_deg_s, duration_s):
    """Where a motion through `row` comes to rest when braked evenly; where it started from when
    accelerated so, for a duration below 0."""
    return [min(max(angle + 0.5 * duration_s * speed, low), high)
            for angle, speed, (low, high, _) in zip(row, speed_deg_s, channels.values())]


def one_demonstration(channels, demo):
    """The demonstration with a rest before and behind it."""
    angles = angles_of(channels, demo)
    first_speed = [(b - a) * RATE_HZ for a, b in zip(angles[0], angles[1])]
    last_speed = [(b - a) * RATE_HZ for a, b in zip(angles[-2], angles[-1])]
    begin = [brought_to_rest(channels, angles[0], first_speed, -LEAD_S)]
    end = [brought_to_rest(channels, angles[-1], last_speed, BRAKE_S)]
    return (begin * round(LEAD_REST_S * RATE_HZ) + join(channels, begin, angles, LEAD_S) + angles
            + join(channels, angles, end, BRAKE_S) + end * round(LAST_REST_S * RATE_HZ))


def three_demonstrations(channels, demos):
    """Angles of three demonstrations with rests and joins, and their targets; None where there are none."""
    angles, targets = [], []

    def append(new_angles, new_targets=None):
        angles.extend(new_angles)
        targets.extend(new_targets or [None] * len(new_angles))

    for demo in THREE_DEMOS:
        new_angles = angles_of(channels, demos[demo])
        if not angles:
            append([new_angles[0]] * round(REST_S * RATE_HZ))
        append(join(channels, angles, new_angles, JOIN_S))
        append(new_angles, targets_of(CHANNELS, demos[demo]))
    last = [angles[-1]] * round(REST_S * RATE_HZ)
    # A posture to settle in: where the motion would come to rest when braked evenly.
    settle = brought_to_rest(
        channels, angles[-1], [(b - a) * RATE_HZ for a, b in zip(angles[-2], angles[-1])], JOIN_S)
    append(join(channels, angles, [settle], JOIN_S))
    append([settle] * len(last))
    return angles, targets


def retargeted_targets(demos, path):
    """The retargeted angles of `path` plus what the targets differ from the angles by, both copied by the table:
    the noise would not outlast a retargeting of its own."""
    copied, targets = three_demonstrations(CHANNELS, demos)
    with open(path, newline="") as file:
        angles = list(csv.DictReader(line for line in file if not line.startswith("#")))
    rows = []
    for row, before, target in zip(angles, copied, targets, strict=True):
        if target is None:
            rows.append([None] * len(CHANNELS))
            continue
        rows.append([min(max(float(row[name]) + t - a, low), high)
                     for (name, (low, high, _)), t, a in zip(CHANNELS.items(), target, before)])
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pickle", type=pathlib.Path)
    parser.add_argument("adroit", type=pathlib.Path)
    here = pathlib.Path(__file__).resolve().parent
    parser.add_argument("--program", default="gauntlet")
    parser.add_argument("--hand", default=str(here.parents[2] / "models" / "hand_arm.xml"))
    parser.add_argument("--out", type=pathlib.Path, default=here)
    options = parser.parse_args()
    demos = read(options.pickle)
    options.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        shutil.copytree(options.adroit, folder / "Adroit")  # its meshes are at ../Adroit
        (folder / "Adroit" / "hand.xml").write_text(HAND)
        for number, demo in enumerate(demos, 1):
            write(folder / f"angles_{number:02}.csv", ADROIT, one_demonstration(ADROIT, demo))
        write(folder / "angles.csv", ADROIT, three_demonstrations(ADROIT, demos)[0])
        for recording in sorted(folder.glob("*.csv")):
            made = options.out / recording.name
            made.unlink(missing_ok=True)
            subprocess.run([options.program, "retarget", recording, "--from", folder / "Adroit" / "hand.xml",
                            "--hand", options.hand, "--out", made], check=True)
    write(options.out / "targets.csv", CHANNELS, retargeted_targets(demos, options.out / "angles.csv"))


if __name__ == "__main__":
    main()
