#!/usr/bin/env python3
"""Overhead of gauntlet.filter() with out= beside the same filter in C++: 94,096 samples of 18 channels.

  cmake --build --preset release --target filter_rows gauntlet_python
  PYTHONPATH=build/release/python /usr/bin/python3 tests/benchmarks/python_filter.py [KIND...]

The two take turns, 10 times 20 runs. A row per kind has the least of ten medians of 20 [ms]: of the filter alone in
C++, of the same with missing values held in C++, and of Python; then the overhead of Python over both.
"""
import pathlib
import statistics
import subprocess
import sys
import time

import numpy as np

import gauntlet

PROGRAM = pathlib.Path(__file__).resolve().parents[2] / "build/release/tests/benchmarks/filter_rows"


def samples():
    """The numbers of filter_rows."""
    values, state = np.empty(94096 * 18), 1
    for i in range(len(values)):
        state = (state * 1664525 + 1013904223) & 0xFFFFFFFF
        values[i] = 400 + (state >> 24)
    return values.reshape(-1, 18)


def python_ms(values, out, kind, runs=20):
    times = []
    for _ in range(runs):
        begin = time.perf_counter()
        gauntlet.filter(values, kind, rate_hz=1000, out=out)
        times.append(1000 * (time.perf_counter() - begin))
    return statistics.median(times)


def main():
    values = samples()
    out = np.empty_like(values)
    for kind in sys.argv[1:] or gauntlet.filter_kinds():
        rows = []
        for _ in range(10):
            native = subprocess.run([PROGRAM, kind], text=True, capture_output=True, check=True).stdout.split()
            rows.append((*map(float, native), python_ms(values, out, kind)))
        alone, held, python = (min(times) for times in zip(*rows))  # the least disturbed round
        print(f"{kind:18} {alone:8.2f} {held:8.2f} {python:8.2f} {100 * (python / alone - 1):+7.1f} % "
              f"{100 * (python / held - 1):+7.1f} %", flush=True)


main()
