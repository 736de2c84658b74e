#!/bin/bash
# ahrs 0.4.0 (PyPI), with NumPy 2.4.6: Complementary, gyroscope and accelerometer at 100 Hz, of a sensor on a hand that turns over.
#
# Guess: as Madgwick and Mahony of the package it is within a few degrees of the truth in every posture; the accelerometer alone is noisy.
# Seen: it mixes roll of both sensors as numbers, and they are 180 and -180 deg where the palm is up. A hand that turns from 150 to 210 deg in
# 1 s is shown 172 deg off, over the palm down; at rest at 180 deg with noise of 0.02 m/s2 the error is above 90 deg most of the time. Madgwick is within 1 deg of it.
# A finger that bends by 80 deg about the vertical, as in a handshake, rests where it was: the gyroscope counts as the change of roll and
# pitch, whatever they are. Its documentation says of neither.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 ahrs==0.4.0
"$folder/venv/bin/python" -W ignore - <<'PYTHON'
import numpy as np
from ahrs.filters import Complementary, Madgwick

RATE_HZ, G = 100.0, 9.81


def errors_deg(kind, roll_deg, noise=0.0):
    """Angles between the estimate and the truth of a sensor that turns about its x axis."""
    roll = np.radians(roll_deg)
    gyroscope = np.zeros((len(roll), 3))
    gyroscope[1:, 0] = np.diff(roll) * RATE_HZ
    gravity = G * np.column_stack([0 * roll, np.sin(roll), np.cos(roll)])
    gravity += np.random.default_rng(1).normal(0, noise, gravity.shape)
    truth = np.column_stack([np.cos(roll / 2), np.sin(roll / 2), 0 * roll, 0 * roll])
    estimate = kind(gyr=gyroscope, acc=gravity, frequency=RATE_HZ).Q
    return 2 * np.degrees(np.arccos(np.clip(np.abs((estimate * truth).sum(axis=1)), 0, 1)))


def bend_deg(kind):
    """Of a finger that bends by 80 deg about its y axis, which is vertical."""
    angles = np.radians(np.clip(np.arange(300) / RATE_HZ - 0.5, 0, 1) * 80)
    gyroscope = np.zeros((300, 3))
    gyroscope[1:, 1] = np.diff(angles) * RATE_HZ
    estimate = kind(gyr=gyroscope, acc=np.tile([0, G, 0], (300, 1)), frequency=RATE_HZ).Q
    return 2 * np.degrees(np.arccos(min(1, abs(estimate[20] @ estimate[-1]))))


turn = 150 + np.clip(np.arange(400) / RATE_HZ - 1, 0, 1) * 60
rest = np.full(1000, 180.0)
seen = {}
for kind in (Complementary, Madgwick):
    seen[kind] = (errors_deg(kind, turn).max(), (errors_deg(kind, rest, 0.02) > 90).mean(), bend_deg(kind))
    print(f"{kind.__name__}: turn at most {seen[kind][0]:.1f} deg off, at rest {100 * seen[kind][1]:.0f} % of the samples above 90 deg, "
          f"the finger bends by {seen[kind][2]:.1f} deg")
assert abs(seen[Complementary][0] - 172) < 2 and seen[Complementary][1] > 0.5, "the palm may be up"
assert seen[Complementary][2] < 1, "it sees a bend about the vertical"
assert seen[Madgwick][0] < 1 and seen[Madgwick][1] == 0 and abs(seen[Madgwick][2] - 80) < 1
PYTHON
