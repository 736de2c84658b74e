#!/bin/bash
# weartsdk 2.0.3 (PyPI), tracking messages of the TouchDIVER glove: getValues() and setValues() of one class.
#
# Guess: setValues() takes what getValues() of the same message gives, in the order thumb, index, middle of the default type.
# Seen: for TrackingType.DEFAULT, getValues() gives 9 values, the type in front, and setValues() asserts that there are 8: no
# message of the default type is read back (AssertionError). For TrackingType.WEART_HAND all 9 are read, and there the index
# finger stands before the thumb: of 10, 20, .. behind the type, thumb closure is 20 / 255.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install weartsdk==2.0.3
"$folder/venv/bin/python" - <<'PYTHON'
from weartsdk.WeArtCommon import ActuationPoint, HandSide, TrackingType
from weartsdk.WeArtMessages import TrackingMessage

default = TrackingMessage(TrackingType.DEFAULT)
values = default.getValues()
try:
    default.setValues(values)
    outcome = "read"
except AssertionError:
    outcome = "AssertionError"
print("DEFAULT:", len(values), "values,", outcome)
assert len(values) == 9 and outcome == "AssertionError", "the default type is read in another way"

hand = TrackingMessage(TrackingType.WEART_HAND)
values = hand.getValues()
hand.setValues(values[:1] + [str(10 * i) for i in range(1, 9)])
thumb = hand.GetClosure(HandSide.Right, ActuationPoint.Thumb)
index = hand.GetClosure(HandSide.Right, ActuationPoint.Index)
print(f"WEART_HAND: thumb {255 * thumb:.0f}, index {255 * index:.0f} of 255")
assert round(255 * thumb) == 20 and round(255 * index) == 10, "the order is another"
PYTHON
