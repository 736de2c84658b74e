#!/bin/bash
# pykalman 0.10.2 and simdkalman 1.0.4 (PyPI), with NumPy 2.4.6: a glove sample in which one channel is missing.
#
# Guess: the channels that are there update the state.
# Seen: both discard the whole sample. Two independent channels at (10, 20) deg; from the third sample on the first is
# missing (masked in pykalman, NaN in simdkalman) and the second moves to 40 deg. Both filters leave it at 20 deg
# without a word, as long as the other channel is gone. A broken sensor of a glove so stops all fingers that one filter
# has. In pykalman, NaN without a mask makes the whole state NaN.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 scipy==1.17.1 pykalman==0.10.2 simdkalman==1.0.4
"$folder/venv/bin/python" - <<'PYTHON'
import numpy as np
import pykalman
import simdkalman

two = np.eye(2)
samples = np.array([[10.0, 20.0], [10.0, 20.0], [np.nan, 40.0], [np.nan, 40.0], [np.nan, 40.0]])
ours = pykalman.KalmanFilter(transition_matrices=two, observation_matrices=two, transition_covariance=two,
                             observation_covariance=0.1 * two, initial_state_mean=[0, 0],
                             initial_state_covariance=100 * two)
masked, _ = ours.filter(np.ma.masked_invalid(samples))
plain, _ = ours.filter(samples)
fast = simdkalman.KalmanFilter(state_transition=two, process_noise=two, observation_model=two,
                               observation_noise=0.1 * two)
simd = fast.compute(samples[None], 0, initial_value=[0, 0], initial_covariance=100 * two,
                    filtered=True).filtered.states.mean[0]
print("second channel, pykalman:  ", masked[:, 1].round(2))
print("second channel, simdkalman:", simd[:, 1].round(2))
print("pykalman without a mask:   ", plain[:, 1].round(2))
assert abs(masked[-1, 1] - 20.0) < 0.1 and abs(simd[-1, 1] - 20.0) < 0.1, "the sample is no longer discarded"
assert np.isnan(plain[-1]).all(), "NaN without a mask no longer reaches the state"
# One filter a channel has 40 deg after a few samples.
alone = pykalman.KalmanFilter(initial_state_covariance=100, observation_covariance=0.1)
assert abs(np.asarray(alone.filter(samples[:, 1])[0])[-1].item() - 40.0) < 1.0
PYTHON
