#!/bin/bash
# pandas 3.1.1 (PyPI), with NumPy 2.4.6: the time between two samples of a 100 Hz glove as astype("int64") / 1e9.
#
# Guess: times are nanoseconds, as in pandas 2: 0.01 s, whatever the times were made from.
# Seen: the unit is that of the source. Texts with milliseconds, epochs in ms and date_range() are microseconds, and give
# 1e-05 s: a glove of 100 kHz. The same times as texts with nine digits, or as float seconds, are nanoseconds and give
# 0.01 s. Columns of both kinds compare equal, so that only the rate is wrong. Differences of the times themselves, divided
# by a Timedelta, are right for all.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 pandas==3.1.1
"$folder/venv/bin/python" - <<'PYTHON'
import numpy as np
import pandas as pd

BEGIN_MS = 1764410400000
times = {"text, 3 digits": pd.to_datetime(["2025-11-29 10:00:00.000", "2025-11-29 10:00:00.010"]),
         "text, 9 digits": pd.to_datetime(["2025-11-29 10:00:00.000000000", "2025-11-29 10:00:00.010000000"]),
         "whole ms": pd.to_datetime([BEGIN_MS, BEGIN_MS + 10], unit="ms"),
         "float s": pd.to_datetime([BEGIN_MS / 1e3, BEGIN_MS / 1e3 + 0.010], unit="s"),
         "date_range": pd.date_range("2025-11-29 10:00", periods=2, freq="10ms")}
as_integers = {}
for name, time in times.items():
    as_integers[name] = float(np.diff(time.astype("int64"))[0] / 1e9)
    right = (time[1] - time[0]) / pd.Timedelta("1s")
    print(f"{name}: {time.dtype}, {as_integers[name]:.6g} s as integers, {right:.6g} s as times")
    assert abs(right - 0.01) < 1e-6
micro = [name for name, step_s in as_integers.items() if abs(step_s - 1e-5) < 1e-9]
nano = [name for name, step_s in as_integers.items() if abs(step_s - 0.01) < 1e-6]
assert micro == ["text, 3 digits", "whole ms", "date_range"] and nano == ["text, 9 digits", "float s"], "other units"
assert (times["text, 3 digits"] == times["text, 9 digits"]).all()
PYTHON
