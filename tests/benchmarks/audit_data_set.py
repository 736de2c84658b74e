#!/usr/bin/env python3
"""Time and memory of an audit: 1,000 episodes of 10 s at 30 Hz with 14 joints, and one log of 692 s at 100 Hz with 34.

    tests/benchmarks/audit_data_set.py build/release/sim/cli/gauntlet

Needs numpy. Prints wall time, processor time and the largest memory of each."""
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np


def data_set(episodes, seconds, rate_hz, joints):
    """Sums of four sines; each joint follows 90 ms late, and 2 ms more than the joint before."""
    random = np.random.default_rng(1)
    time_s = np.arange(int(seconds * rate_hz)) / rate_hz
    action = np.zeros((episodes, len(time_s), joints), np.float32)
    state = random.normal(0.0, 0.1, action.shape).astype(np.float32)
    for joint in range(joints):
        for _ in range(4):
            turns, phase, size = (random.uniform(low, high, (episodes, 1))
                                  for low, high in ((0.1, 0.8), (0.0, 6.28), (3.0, 15.0)))
            delay_s = 0.09 + 0.002 * joint
            action[:, :, joint] += size * np.sin(2 * np.pi * turns * time_s + phase)
            state[:, :, joint] += size * np.sin(2 * np.pi * turns * (time_s - delay_s) + phase)
    rows = episodes * len(time_s)
    return {"action": action.reshape(rows, joints), "observation.state": state.reshape(rows, joints),
            "timestamp": np.tile(time_s, episodes), "episode_index": np.repeat(np.arange(episodes), len(time_s))}


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as place:
        for name, shape in (("episodes", (1000, 10.0, 30.0, 14)), ("one_log", (1, 692.0, 100.0, 34))):
            file = pathlib.Path(place) / f"{name}.npz"
            np.savez(file, **data_set(*shape))
            start = time.monotonic()
            with subprocess.Popen([program, "audit", file, "--unit", "deg"], stdout=subprocess.PIPE) as audit:
                said = audit.stdout.read().decode()
                _, status, usage = os.wait4(audit.pid, 0)
                audit.returncode = os.waitstatus_to_exitcode(status)
            print(f"{said.splitlines()[0]}: {time.monotonic() - start:.1f} s, processor "
                  f"{usage.ru_utime + usage.ru_stime:.1f} s, {usage.ru_maxrss / 1024:.0f} MB")
            if audit.returncode != 0:
                return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
