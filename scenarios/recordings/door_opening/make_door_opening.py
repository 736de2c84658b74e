#!/usr/bin/env python3
"""Makes angles_01.csv to angles_25.csv, one for each demonstration of a person who opens a door, and
angles.csv and targets.csv of three of them.

Usage: make_door_opening.py FOLDER
FOLDER holds door_demos_obs.csv and door_demos_actions.csv: the columns of door-v0_demos.pickle of
github.com/aravindr93/hand_dapg, commit 9a1de23, as text (see README.md). Standard library only.
"""

import csv
import math
import pathlib
import sys

RATE_HZ = 100
THREE_DEMOS = (0, 10, 13)  # they fit the ranges with almost no clamping
SKIP_SAMPLES = 20  # the simulated hand springs from its zero posture to the first target
REST_S = 1.0  # the first and the last posture held, so that rest can be scored
SMOOTHING_S = 0.020  # standard deviation of the Gaussian; -3 dB at 6.6 Hz
JOIN_S = 0.4  # from the end of one demonstration to the start of the next
# Of a demonstration by itself: a posture held, then up to its first speed; brake, then rest.
LEAD_REST_S, LEAD_S, BRAKE_S, LAST_REST_S = 0.4, 0.3, 0.3, 0.5

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
    "thumb_rotation": (0, 90, lambda q, palm: 45 + q["THJ4"]),
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


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def channel_angles(joints_deg, palm):
    values = []
    for low, high, angle in CHANNELS.values():
        values.append(min(max(angle(joints_deg, palm), low), high))
    return values


def palm_of(row):
    return [float(row["palm_" + axis]) for axis in "xyz"]


def angles_of(row):
    joints = {key[2:]: math.degrees(float(value))
              for key, value in row.items() if key.startswith("q_")}
    return channel_angles(joints, palm_of(row))


def targets_of(action, row):
    joints = {}
    for joint, (low, high) in TARGET_RANGE_RAD.items():
        value = float(action["a_" + joint])
        joints[joint] = math.degrees(0.5 * (low + high) + value * 0.5 * (high - low))
    return channel_angles(joints, palm_of(row))


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
                       for c in range(len(CHANNELS))])
    return result


def quintic(start, start_speed, end, end_speed, duration_s, t):
    """Position of the fifth-order polynomial with these ends and no acceleration at them."""
    s = t / duration_s
    v0, v1, d = start_speed * duration_s, end_speed * duration_s, end - start
    return start + v0 * s + (10 * d - 6 * v0 - 4 * v1) * s**3 \
        + (-15 * d + 8 * v0 + 7 * v1) * s**4 + (6 * d - 3 * v0 - 3 * v1) * s**5


def join(before, after, duration_s):
    """Samples between the last of `before` and the first of `after`, without either."""
    steps = round(duration_s * RATE_HZ)
    rows = []
    for step in range(1, steps):
        row = []
        for channel, (low, high, _) in enumerate(CHANNELS.values()):
            speed0 = (before[-1][channel] - before[-2][channel]) * RATE_HZ if len(before) > 1 else 0
            speed1 = (after[1][channel] - after[0][channel]) * RATE_HZ if len(after) > 1 else 0
            value = quintic(before[-1][channel], speed0, after[0][channel], speed1, duration_s,
                            step / RATE_HZ)
            row.append(min(max(value, low), high))
        rows.append(row)
    return rows


def write(path, rows):
    with open(path, "w", newline="") as file:
        file.write("time_s," + ",".join(CHANNELS) + "\n")
        for index, row in enumerate(rows):
            cells = ["" if value is None else f"{value:.3f}" for value in row]
            file.write(f"{index / RATE_HZ:.2f}," + ",".join(cells) + "\n")


def brought_to_rest(row, speed_deg_s, duration_s):
    """Where a motion through `row` comes to rest when braked evenly; where it started from when
    accelerated so, for a duration below 0."""
    return [min(max(angle + 0.5 * duration_s * speed, low), high)
            for angle, speed, (low, high, _) in zip(row, speed_deg_s, CHANNELS.values())]


def one_demonstration(angles):
    """The demonstration with a rest before and behind it."""
    first_speed = [(b - a) * RATE_HZ for a, b in zip(angles[0], angles[1])]
    last_speed = [(b - a) * RATE_HZ for a, b in zip(angles[-2], angles[-1])]
    begin = [brought_to_rest(angles[0], first_speed, -LEAD_S)]
    end = [brought_to_rest(angles[-1], last_speed, BRAKE_S)]
    return (begin * round(LEAD_REST_S * RATE_HZ) + join(begin, angles, LEAD_S) + angles
            + join(angles, end, BRAKE_S) + end * round(LAST_REST_S * RATE_HZ))


def all_demonstrations(observations, folder):
    demos = sorted({int(o["demo"]) for o in observations})
    for demo in demos:
        rows = [o for o in observations if int(o["demo"]) == demo][SKIP_SAMPLES:]
        write(folder / f"angles_{demo + 1:02}.csv",
              one_demonstration(smooth([angles_of(o) for o in rows])))


def three_demonstrations(observations, actions, folder):
    angles, targets = [], []
    missing = [None] * len(CHANNELS)

    def append(new_angles, new_targets=None):
        angles.extend(new_angles)
        targets.extend(new_targets or [missing] * len(new_angles))

    for demo in THREE_DEMOS:
        rows = [(o, a) for o, a in zip(observations, actions) if int(o["demo"]) == demo]
        rows = rows[SKIP_SAMPLES:]
        new_angles = smooth([angles_of(o) for o, a in rows])
        if not angles:
            append([new_angles[0]] * round(REST_S * RATE_HZ))
        append(join(angles, new_angles, JOIN_S))
        append(new_angles, [targets_of(a, o) for o, a in rows])
    last = [angles[-1]] * round(REST_S * RATE_HZ)
    # A posture to settle in: where the motion would come to rest when braked evenly.
    settle = brought_to_rest(
        angles[-1], [(b - a) * RATE_HZ for a, b in zip(angles[-2], angles[-1])], JOIN_S)
    append(join(angles, [settle], JOIN_S))
    append([settle] * len(last))

    write(folder / "angles.csv", angles)
    write(folder / "targets.csv", targets)


def main(source):
    folder = pathlib.Path(__file__).resolve().parent
    observations = read(source / "door_demos_obs.csv")
    all_demonstrations(observations, folder)
    three_demonstrations(observations, read(source / "door_demos_actions.csv"), folder)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]))
