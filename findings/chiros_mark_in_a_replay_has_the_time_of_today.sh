#!/bin/bash
# chirostest 0.4.1 (PyPI), the SDK of the Chiros exoskeleton glove, with NumPy 2.4.6: a session is replayed, recorded again
# and marked, to label it afterwards.
#
# Guess: mark() has the time of the frame that was written last, as frames keep the time of their recording.
# Seen: mark() has the time of the computer's clock. The frames of a session of 2025 are at 1764410400.00 to .09 s, the mark
# between the fifth and the sixth of them is at the day of the replay, months behind the last frame. In the .csv it is a
# line "# marker" between the rows, of that time. The summary counts no such time: the duration is 0.09 s.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install numpy==2.4.6 chirostest==0.4.1
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import json
import time

import chiros

BEGIN_S = 1764410400.0
with open("session.dgt", "w") as file:
    print(json.dumps({"type": "header", "version": 1, "sdk": "0.4.1", "format": "dgt", "file": "session.dgt",
                      "t_created": BEGIN_S, "metadata": {}}), file=file)
    for i in range(10):
        print(json.dumps({"type": "frame", "seq": i, "t": BEGIN_S + 0.01 * i, "q": [0.1] * 20, "touch": [0.0] * 30, "imu": [],
                          "stale": False, "valid_mask": [15] * 5, "health": [0] * 5}), file=file)

for ending in ("dgt", "csv"):
    recorder = chiros.Recorder(f"labelled.{ending}", {})
    with chiros.Device.from_source(chiros.Replayer("session.dgt")).stream() as frames:
        for frame in frames:
            recorder.write(frame)
            if frame.seq == 4:
                recorder.mark("grasp")
            if frame.seq == 9:
                break
    summary = recorder.close()
    assert abs(summary.duration_s - 0.09) < 1e-3

rows = [json.loads(line) for line in open("labelled.dgt")]
frame_s = [row["t"] for row in rows if row["type"] == "frame"]
mark_s = [row["t"] for row in rows if row["type"] == "marker"]
place = [row["type"] for row in rows].index("marker")
print(f"frames at {frame_s[0]:.2f} to {frame_s[-1]:.2f} s, the mark between them at {mark_s[0]:.2f} s")
print(next(line for line in open("labelled.csv") if line.startswith("#")).strip())
assert rows[place - 1]["seq"] == 4 and abs(frame_s[-1] - BEGIN_S - 0.09) < 1e-3
assert abs(mark_s[0] - time.time()) < 60, "the mark has another time"
PYTHON
