#!/bin/bash
# pandas 3.1.1 and polars 2.1.0 (PyPI), with NumPy 2.4.6: ewm(alpha=0.2, adjust=False).mean() and ewm_mean(alpha=0.2,
# adjust=False) of a finger at 0 deg that is at 90 deg behind five missing samples.
#
# Guess: y += 0.2 (x - y) for each sample that is there, so that the first one behind the gap gives 18 deg.
# Seen: both give 39 deg: the old value fades in the gap, the new one keeps its weight of 0.2, and 0.2 / (0.2 + 0.8^6) is 43 %.
# So a glove with gaps is smoothed less where it is worst. ignore_na=True and ignore_nulls=True give 18 deg. In the gap
# pandas holds the last value, as if it were measured; polars has null.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 pandas==3.1.1 polars==2.1.0
"$folder/venv/bin/python" - <<'PYTHON'
import pandas as pd
import polars as pl

angles = [0.0] * 3 + [None] * 5 + [90.0] * 3
one, other = pd.Series(angles, dtype=float), pl.Series(angles)
as_given = (list(one.ewm(alpha=0.2, adjust=False).mean()), other.ewm_mean(alpha=0.2, adjust=False).to_list())
by_sample = (list(one.ewm(alpha=0.2, adjust=False, ignore_na=True).mean()),
             other.ewm_mean(alpha=0.2, adjust=False, ignore_nulls=True).to_list())
print("pandas:", [round(x, 1) for x in as_given[0]])
print("polars:", [x if x is None else round(x, 1) for x in as_given[1]])
print("by sample:", by_sample[0][8], by_sample[1][8])
weight = 0.2 / (0.2 + 0.8**6)
assert all(abs(smoothed[8] - 90 * weight) < 1e-9 for smoothed in as_given), "the gap no longer counts"
assert all(abs(smoothed[8] - 18) < 1e-9 for smoothed in by_sample)
assert as_given[0][3:8] == [0.0] * 5 and as_given[1][3:8] == [None] * 5, "the gap is filled in another way"
PYTHON
