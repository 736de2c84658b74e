#!/bin/bash
# python-osc 1.10.2 (PyPI): the time of a glove's sample in s since 1970, as time.time() gives it, beside its angle in a message.
#
# Guess: a Python float is 64 bits, and arrives as it was sent; or the library refuses what its message cannot hold.
# Seen: every float is sent with 32 bits, which near 1.76e9 are 128 s apart. 1764410400.123 arrives as 1764410368, 32 s
# earlier, and all samples of a minute have one or two times; no error. The same time in whole ms is an int, which is sent with 64
# bits where it needs them, and arrives as it was. add_arg(time, "d") sends 64 bits, too.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install python-osc==1.10.2
"$folder/venv/bin/python" - <<'PYTHON'
import sys

from pythonosc.osc_message import OscMessage
from pythonosc.osc_message_builder import OscMessageBuilder

BEGIN_S = 1764410400.123


def arrives(value, kind=None):
    builder = OscMessageBuilder("/glove/time")
    builder.add_arg(value, kind)
    return OscMessage(builder.build().dgram).params[0]


seconds = [arrives(BEGIN_S + 0.01 * i) for i in range(6000)]
ms, double = arrives(round(1e3 * BEGIN_S)), arrives(BEGIN_S, "d")
print("sent:", BEGIN_S, " arrives:", seconds[0], " times of 60 s of samples:", len(set(seconds)))
print("whole ms:", ms, " as 'd':", double)
sys.exit(not (seconds[0] == 1764410368.0 and len(set(seconds)) <= 2 and ms == 1764410400123 and double == BEGIN_S))
PYTHON
