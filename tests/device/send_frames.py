#!/usr/bin/env python3
"""Sends ten frames of two values over UDP: send_frames.py FORMAT PORT.

A second encoder of each format, made from its description alone (docs/reference/live-formats.md). Frame i
has the number i, the time 2 s + i * 10 ms, and the values 512 + i and 300.5 - i.
"""
import json
import socket
import struct
import sys
import time
import zlib

form, port = sys.argv[1], int(sys.argv[2])
to = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
to.connect(("127.0.0.1", port))


def padded(text):
    raw = text.encode() + b"\0"
    return raw + b"\0" * (-len(raw) % 4)


def with_crc(raw):
    return raw + struct.pack("<I", zlib.crc32(raw))


def binary(kind, count, number, time_ns, content):
    return with_crc(b"\xf7GNT" + struct.pack("<BBHqq", 1, kind, count, number, time_ns) + content)


if form == "binary":
    to.send(binary(0, 13, 0, -2**63, b"index,thumb_x"))
if form == "csv":
    to.send(b"frame,time_ms,index,thumb_x\n")
for i in range(10):
    number, time_s, a, b = i, 2 + i * 0.01, 512 + i, 300.5 - i
    message = padded("/glove/right") + padded(",if") + struct.pack(">if", a, b)
    packet = {
        "csv": f"{number},{time_s * 1e3:.0f},{a},{b}".encode(),
        "labels": f"index:{a} thumb_x:{b}\r\n".encode(),
        "json": json.dumps({"frame": number, "time_s": round(time_s, 3), "index": a, "thumb_x": b}).encode(),
        "binary": binary(2 if i % 2 else 1, 2, number, 2_000_000_000 + i * 10_000_000,
                         struct.pack("<dd" if i % 2 else "<ff", a, b)),
        "osc": message,
        "bundle": b"#bundle\0" + struct.pack(">II", 2_208_988_800 + 2, round(i * 0.01 * 2**32)) +
                  struct.pack(">I", len(message)) + message,
    }[form]
    to.send(packet)
    time.sleep(0.03)
