#!/bin/bash
# pyxdf 1.17.5 (PyPI), with NumPy 2.4.6: a glove of 100 Hz that is silent for 4 s in the middle of 24 s, in an XDF file of LSL.
#
# Guess: load_xdf() removes the jitter of the times (its default), and leaves a dropout of seconds a dropout.
# Seen: the largest interval is 13 ms, and samples are up to 2.00 s from their time: one line is fitted through all times, the
# dropout with them. It is kept only when it is longer than 1 s and than 500 samples, whichever is more: 5 s at 100 Hz, 25 s
# at 20 Hz. One of 0.5 s moves the samples around it by 0.25 s against all other streams of the file. The rate that the file
# then tells is 77 Hz. With dejitter_timestamps=False, or with jitter_break_threshold_samples=1, the times are those of the file.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 pyxdf==1.17.5
"$folder/venv/bin/python" - "$folder/glove.xdf" 2>/dev/null <<'PYTHON'
import struct
import sys

import numpy as np
import pyxdf

STREAM = struct.pack("<I", 1)
HEADER = ("<?xml version='1.0'?><info><name>glove</name><type>Angles</type><channel_count>1</channel_count>"
          "<nominal_srate>100</nominal_srate><channel_format>double64</channel_format></info>")


def chunk(kind, content):
    return b"\x04" + struct.pack("<IH", len(content) + 2, kind) + content


def largest(dropout_s, **options):
    """Largest interval, largest difference from the file's own times, and rate."""
    times = 100 + np.arange(2000) * 0.01
    times[1000:] += dropout_s
    samples = b"".join(b"\x08" + struct.pack("<dd", time, 45.0) for time in times)
    with open(sys.argv[1], "wb") as file:
        file.write(b"XDF:" + chunk(1, b"<?xml version='1.0'?><info><version>1.0</version></info>")
                   + chunk(2, STREAM + HEADER.encode()) + chunk(3, STREAM + b"\x04" + struct.pack("<I", len(times)) + samples)
                   + chunk(6, STREAM + b"<?xml version='1.0'?><info></info>"))
    stream = pyxdf.load_xdf(sys.argv[1], **options)[0][0]
    read = stream["time_stamps"]
    return np.diff(read).max(), np.abs(read - times).max(), stream["info"]["effective_srate"]


four, half, six = largest(4.0), largest(0.5), largest(6.0)
kept = [largest(4.0, dejitter_timestamps=False), largest(4.0, jitter_break_threshold_samples=1)]
for what, seen in (("4 s", four), ("0.5 s", half), ("6 s", six), ("4 s, no dejitter", kept[0]), ("4 s, break at 1 s", kept[1])):
    print("dropout of %s: largest interval %.4f s, moved by %.3f s, %.1f Hz" % (what, *seen))
ok = 0.012 < four[0] < 0.014 and 1.98 < four[1] < 2.001 and 76 < four[2] < 78 and half[0] < 0.011 and 0.24 < half[1] < 0.251
sys.exit(not (ok and six[1] < 1e-6 and all(seen[0] > 3.9 and seen[1] < 1e-6 for seen in kept)))
PYTHON
