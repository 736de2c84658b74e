#!/bin/bash
# hand-tracking-sdk 1.1.0 (PyPI), frames of a hand from the lines that a headset sends: one of the wrist and one of the
# landmarks for each sample, 72 times a second.
#
# Guess: HandFrameAssembler puts the two lines of a sample together: 100 samples are 100 frames.
# Seen: each line makes a frame with the newest of the other kind: 199 frames. Every second one has the landmarks of the
# sample before under the time of the new one. A filter that is stepped by frame and told 72 Hz gets each posture of
# the fingers twice: it sees half their speed, and its cutoff is twice the one that was asked for.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install hand-tracking-sdk==1.1.0
"$folder/venv/bin/python" - <<'PYTHON'
from hand_tracking_sdk.frame import HandFrameAssembler

SAMPLES = 100
assembler = HandFrameAssembler()
frames = []
for sample in range(SAMPLES):
    time_ns = sample * 1_000_000_000 // 72
    wrist = "Right wrist:, " + ", ".join(str(v) for v in (sample, 0, 0, 0, 0, 0, 1))
    landmarks = "Right landmarks:, " + ", ".join([str(sample)] * 63)
    for line in (wrist, landmarks):
        frame = assembler.push_line(line, recv_ts_ns=time_ns, source_ts_ns=time_ns)
        if frame is not None:
            frames.append((frame.source_ts_ns, frame.wrist.x, frame.landmarks.points[0][0]))

mixed = [frame for frame in frames if frame[1] != frame[2]]
print(f"{SAMPLES} samples: {len(frames)} frames, of which {len(mixed)} join the wrist of one sample and landmarks of the one before")
print("time of the sample in ms, wrist, landmarks:", *(f"({ns / 1e6:.1f}, {w:.0f}, {l:.0f})" for ns, w, l in frames[1:5]))
assert len(frames) == 2 * SAMPLES - 1 and len(mixed) == SAMPLES - 1, "it puts them together in another way"
PYTHON
