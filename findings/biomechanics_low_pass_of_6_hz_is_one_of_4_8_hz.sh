#!/bin/bash
# kineticstoolkit 0.17.0, pyomeca 2026.0.2 and neurokit2 0.2.13 (PyPI), with NumPy 2.4.6: a low pass of order 2 at 6 Hz of a
# marker of 100 Hz, by the function that each has for it.
#
# Guess: at the cutoff that is given, 71 % of a motion is left, as of any Butterworth filter; packages of this field correct
# the cutoff for the second pass, back in time, as its textbooks ask for.
# Seen: in all three 50 % is left at 6 Hz, and 71 % at 4.8 Hz. A cutoff that was found with one pass (scipy.signal.sosfilt, a
# real-time filter) must be divided by 0.80 to mean the same there; one that is reported from there is too high by as much.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 scipy==1.17.1 kineticstoolkit==0.17.0 pyomeca==2026.0.2 neurokit2==0.2.13
cd "$folder"
MPLBACKEND=Agg QT_QPA_PLATFORM=offscreen "$folder/venv/bin/python" -W ignore - 2>/dev/null <<'PYTHON'
import sys

import kineticstoolkit
import neurokit2
import numpy as np
from pyomeca import Analogs
from scipy import signal

RATE_HZ, CUTOFF_HZ, ORDER = 100.0, 6.0, 2
times = np.arange(0, 40, 1 / RATE_HZ)


def of_kineticstoolkit(motion):
    series = kineticstoolkit.TimeSeries(time=times, data={"marker": motion})
    return kineticstoolkit.filters.butter(series, CUTOFF_HZ, order=ORDER).data["marker"]


def of_pyomeca(motion):
    return Analogs(motion[None, :], time=times).meca.low_pass(order=ORDER, cutoff=CUTOFF_HZ, freq=RATE_HZ).values[0]


def of_neurokit2(motion):
    return neurokit2.signal_filter(motion, sampling_rate=RATE_HZ, highcut=CUTOFF_HZ, order=ORDER)


def of_one_pass(motion):
    return signal.sosfilt(signal.butter(ORDER, CUTOFF_HZ, fs=RATE_HZ, output="sos"), motion)


def left(filtered_of, motion_hz):
    filtered = filtered_of(np.sin(2 * np.pi * motion_hz * times))
    return np.sqrt(2) * np.std(filtered[1000:3000])


ok = abs(left(of_one_pass, 6.0) - 0.707) < 0.002
for filtered_of in (of_kineticstoolkit, of_pyomeca, of_neurokit2):
    at_cutoff, below = left(filtered_of, 6.0), left(filtered_of, 4.8)
    print(f"{filtered_of.__name__[3:]}: {at_cutoff:.3f} at 6 Hz, {below:.3f} at 4.8 Hz")
    ok = ok and abs(at_cutoff - 0.5) < 0.002 and abs(below - 0.707) < 0.015
sys.exit(not ok)
PYTHON
