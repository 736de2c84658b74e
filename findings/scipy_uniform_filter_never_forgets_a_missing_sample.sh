#!/bin/bash
# scipy 1.17.1 (PyPI), with NumPy 2.4.6: ndimage.uniform_filter1d(), a moving average, of a glove with one missing sample.
#
# Guess: the samples whose window has the missing one are NaN, three with a window of three. gaussian_filter1d() of the
# same module does so.
# Seen: all samples from there to the end are NaN: the function adds and takes away in one running sum. So a sentinel for
# "no data" of 3.4e38 (largest float) leaves 0 deg for the rest of a hand at 45 deg: a finite, plausible angle.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 scipy==1.17.1
"$folder/venv/bin/python" - <<'PYTHON'
import numpy as np
from scipy import ndimage

missing, sentinel = np.full(12, 45.0), np.full(12, 45.0)
missing[4], sentinel[4] = np.nan, np.finfo(np.float32).max
average = ndimage.uniform_filter1d(missing, 3)
print("moving average:", average)
print("convolution:   ", np.convolve(missing, np.ones(3) / 3, "same"))
print("of a sentinel: ", ndimage.uniform_filter1d(sentinel, 3))
assert np.isnan(average[3:]).all() and not np.isnan(average[:3]).any(), "it no longer reaches the end"
assert (ndimage.uniform_filter1d(sentinel, 3)[6:] == 0).all(), "the angles behind a sentinel are others"
# The same window as a sum of its own, and the bell of the same module.
assert np.isnan(np.convolve(missing, np.ones(3) / 3, "same")).sum() == 3
assert np.isnan(ndimage.gaussian_filter1d(missing, 0.25)).sum() == 3
PYTHON
