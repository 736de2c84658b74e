#!/bin/bash
# OneEuroFilter 0.2.1 (PyPI): a recording that begins at time 0, at another rate than the one given first.
#
# Guess: with timestamps, each interval is that of its timestamps, from the second sample on.
# Seen: a time of 0.0 counts as no time. The first interval is then 1 / freq of the constructor. A glove of 10 Hz, with
# freq=120, jumps from 0 to 90 deg: of the jump the filter lets 4.5 deg through when the recording begins at 0 s, and
# 34.7 deg when it begins at 1 s. The same samples so give other angles for several samples.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install OneEuroFilter==0.2.1
"$folder/venv/bin/python" - <<'PYTHON'
from OneEuroFilter import OneEuroFilter

def filtered(begin_s):
    one = OneEuroFilter(freq=120, mincutoff=1.0, beta=0.0, dcutoff=1.0)
    return [one(angle, begin_s + 0.1 * i) for i, angle in enumerate([0.0, 90.0, 90.0, 90.0])]

at_zero, at_one = filtered(0.0), filtered(1.0)
print("begins at 0 s:", [round(x, 2) for x in at_zero])
print("begins at 1 s:", [round(x, 2) for x in at_one])
assert abs(at_zero[1] - 4.48) < 0.01 and abs(at_one[1] - 34.73) < 0.01, "the first interval is another"
assert abs(at_zero[3] - at_one[3]) > 10.0
PYTHON
