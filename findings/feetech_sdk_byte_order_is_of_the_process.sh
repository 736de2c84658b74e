#!/bin/bash
# feetech-servo-sdk 1.0.0 (PyPI; module scservo_sdk), with pyserial 3.5: two handlers for two kinds of servos.
#
# STS and SMS servos send the low byte first, SCS servos the high byte: PacketHandler(0) and PacketHandler(1).
# Guess: each handler keeps its own byte order, so a hand with fingers of SCS and a wrist of STS has two of them.
# Seen: the byte order is one variable of the process, and the handler that is made last sets it for all. A goal of 2048
# (0x0800) by the first handler leaves as 00 08 before and as 08 00 after the second one is made: 8, another end of the
# range. No error; the checksum is right.
# Exit code 0: seen again; 1: something else. No servo is needed: the bytes are read at the other end of a terminal.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install feetech-servo-sdk==1.0.0 pyserial==3.5
"$folder/venv/bin/python" - <<'PYTHON'
import os
import tty

from scservo_sdk import PacketHandler, PortHandler

GOAL_POSITION = 42
device, terminal = os.openpty()
tty.setraw(terminal)
port = PortHandler(os.ttyname(terminal))
port.openPort()

def sent(handler):
    handler.write2ByteTxOnly(port, 1, GOAL_POSITION, 2048)
    packet = os.read(device, 64)
    assert sum(packet[2:]) & 0xFF == 0xFF, "the checksum"
    return packet[-3:-1].hex(" ")

low_first = PacketHandler(0)
before = sent(low_first)
high_first = PacketHandler(1)
after = sent(low_first)
print("2048 by PacketHandler(0):", before)
print("the same, after PacketHandler(1) was made:", after)
assert (before, after) == ("00 08", "08 00"), "the byte order is kept"
PYTHON
