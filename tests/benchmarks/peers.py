#!/usr/bin/env python3
"""gauntlet.filter and gauntlet.Filter beside other packages: 94,096 samples of 18 channels, time and numbers.

    PYTHONPATH=build/release/python /usr/bin/python3 tests/benchmarks/peers.py FOLDER

Each package gets a virtual environment of its own in FOLDER, with the newest versions of PyPI (a few hundred MB). An
environment that is there is used again. They run one after the other, on one thread. Slow packages get the first samples
only. A row per package and filter: us per sample of 18 channels from arrays (least of five runs) and from single steps
(least of five), how many times as long as Gauntlet takes, and the largest difference of a number, in noise of the samples.
"""
import importlib.metadata
import json
import math
import os
import pathlib
import subprocess
import sys
import time

import numpy as np

SAMPLES, CHANNELS, RATE_HZ, NOISE = 94096, 18, 1000.0, 2.0
CUTOFF_HZ, MIN_CUTOFF_HZ, BETA, DERIVATIVE_CUTOFF_HZ, R, Q = 5.0, 1.0, 0.01, 1.0, 4.0, 1e-4
ENVIRONMENTS = {"scipy": ["scipy"], "filterpy": ["filterpy", "scipy", "matplotlib"], "pykalman": ["pykalman"], "numba": ["numba"],
                "OneEuroFilter": ["OneEuroFilter"]}


def samples():
    """Counts of a hand that moves at up to 1 Hz, with noise."""
    random = np.random.default_rng(1)
    time_s = np.arange(SAMPLES)[:, None] / RATE_HZ
    motion = sum(100 / k * np.sin(2 * np.pi * 0.2 * k * time_s + random.uniform(0, 7, CHANNELS)) for k in (1, 2, 5))
    return 500 + motion + random.normal(0, NOISE, (SAMPLES, CHANNELS))


def gauntlet_filters():
    import gauntlet

    kinds = {"butterworth": {"cutoff_hz": CUTOFF_HZ},
             "one_euro": {"min_cutoff_hz": MIN_CUTOFF_HZ, "beta": BETA, "derivative_cutoff_hz": DERIVATIVE_CUTOFF_HZ},
             "kalman": {"r": R, "q": Q}}
    for kind, settings in kinds.items():
        def arrays(values, kind=kind, settings=settings, out=np.empty((SAMPLES, CHANNELS))):
            return gauntlet.filter(values, kind, rate_hz=RATE_HZ, out=out[:len(values)], **settings)

        yield kind, SAMPLES, arrays, lambda first, kind=kind, settings=settings: gauntlet.Filter(kind, rate_hz=RATE_HZ, **settings).step


def scipy_filters():
    from scipy import signal

    sos = signal.butter(2, CUTOFF_HZ, fs=RATE_HZ, output="sos")
    start = signal.sosfilt_zi(sos)[:, :, None]

    def steps(first):
        state = start * first

        def step(row):
            nonlocal state
            filtered, state = signal.sosfilt(sos, row[None], axis=0, zi=state)
            return filtered[0]
        return step

    yield "butterworth", SAMPLES, lambda values: signal.sosfilt(sos, values, axis=0, zi=start * values[0])[0], steps


def numba_filters():
    from numba import njit

    turn = 2 * math.pi
    speed_weight = 1 / (1 + RATE_HZ / (turn * DERIVATIVE_CUTOFF_HZ))

    @njit
    def one_euro(row, state, out):
        for i in range(row.size):
            change = row[i] - state[0, i]
            state[1, i] += speed_weight * (change * RATE_HZ - state[1, i])
            cutoff_hz = MIN_CUTOFF_HZ + BETA * abs(state[1, i])
            state[0, i] += change * (cutoff_hz / (cutoff_hz + RATE_HZ / turn))
            out[i] = state[0, i]

    @njit
    def kalman(row, state, out):
        for i in range(row.size):
            p11, p12, p22 = state[2, i], state[3, i], state[4, i]
            p11, p12, p22 = p11 + 2 * p12 + p22 + Q, p12 + p22, p22 + Q
            k1, k2 = p11 / (p11 + R), p12 / (p11 + R)
            x = state[0, i] + state[1, i]
            error = row[i] - x
            state[0, i] = x + k1 * error
            state[1, i] += k2 * error
            state[2, i], state[3, i], state[4, i] = (1 - k1) * p11, (1 - k1) * p12, p22 - k2 * p12
            out[i] = state[0, i]

    k = math.tan(math.pi * CUTOFF_HZ / RATE_HZ)
    a0 = 1 + math.sqrt(2) * k + k * k
    b0, a1, a2 = k * k / a0, 2 * (k * k - 1) / a0, (1 - math.sqrt(2) * k + k * k) / a0

    @njit
    def butterworth(row, state, out):
        for i in range(row.size):
            filtered = b0 * row[i] + state[0, i]
            state[0, i] = 2 * b0 * row[i] - a1 * filtered + state[1, i]
            state[1, i] = b0 * row[i] - a2 * filtered
            out[i] = filtered

    def begin(name, first):
        state = np.zeros((5, CHANNELS))
        if name == "butterworth":
            state[0], state[1] = (1 - b0) * first, (b0 - a2) * first
        else:
            state[0] = first
            state[2] = state[4] = 1
        return state

    for function in (butterworth, one_euro, kalman):
        name = function.__name__

        @njit
        def rows(values, state, out, function=function):
            for k in range(len(values)):
                function(values[k], state, out[k])

        # The first sample of one_euro and kalman is the start, as Gauntlet has it.
        def arrays(values, name=name, rows=rows, out=np.empty((SAMPLES, CHANNELS))):
            skipped = 0 if name == "butterworth" else 1
            out[0] = values[0]
            rows(values[skipped:], begin(name, values[0]), out[skipped:len(values)])
            return out[:len(values)]

        def steps(first, name=name, function=function):
            state, is_first = begin(name, first), name != "butterworth"

            def step(row):
                nonlocal is_first
                out = np.empty(CHANNELS)
                if is_first:
                    is_first, out[:] = False, row
                else:
                    function(row, state, out)
                return out
            return step

        yield name, SAMPLES, arrays, steps


A, H = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([[1.0, 0.0]])


def filterpy_filters():
    from filterpy.kalman import KalmanFilter

    def begin(first):
        filters = []
        for value in first:
            one = KalmanFilter(dim_x=2, dim_z=1)
            one.x, one.F, one.H = np.array([[value], [0.0]]), A, H
            one.P, one.Q, one.R = np.eye(2), Q * np.eye(2), np.array([[R]])
            filters.append(one)
        return filters

    def arrays(values):
        columns = [one.batch_filter(column)[0][:, 0, 0] for one, column in zip(begin(values[0]), values[1:].T)]
        return np.concatenate([values[:1], np.array(columns).T])

    def steps(first):
        filters, is_first = begin(first), True

        def step(row):
            nonlocal is_first
            if is_first:
                is_first = False
                return row.copy()
            for one, value in zip(filters, row):
                one.predict()
                one.update(value)
            return np.array([one.x[0, 0] for one in filters])
        return step

    yield "kalman", 1000, arrays, steps


def pykalman_filters():
    from pykalman import KalmanFilter

    def begin(value):
        # Its first sample has no prediction before it: it begins with the prediction of the second one.
        start = A @ np.eye(2) @ A.T + Q * np.eye(2)
        return KalmanFilter(A, H, Q * np.eye(2), [[R]], initial_state_mean=[value, 0], initial_state_covariance=start)

    def arrays(values):
        columns = [begin(column[0]).filter(column[1:])[0][:, 0] for column in values.T]
        return np.concatenate([values[:1], np.array(columns).T])

    def steps(first):
        filters = [begin(value) for value in first]
        states = [(np.array([value, 0.0]), np.eye(2)) for value in first]
        is_first = True

        def step(row):
            nonlocal is_first
            if is_first:
                is_first = False
                return row.copy()
            for i, one in enumerate(filters):
                states[i] = one.filter_update(*states[i], row[i:i + 1])
            return np.array([mean[0] for mean, _ in states])
        return step

    yield "kalman", 1000, arrays, steps


def OneEuroFilter_filters():
    from OneEuroFilter import OneEuroFilter

    def steps(first):
        filters = [OneEuroFilter(freq=RATE_HZ, mincutoff=MIN_CUTOFF_HZ, beta=BETA, dcutoff=DERIVATIVE_CUTOFF_HZ) for _ in first]
        return lambda row: np.array([one(value) for one, value in zip(filters, row)])

    def arrays(values):
        step = steps(values[0])
        return np.array([step(row) for row in values])

    yield "one_euro", 5000, arrays, steps


def least_us(work, count, runs=5):
    times = []
    for _ in range(runs):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return 1e6 * min(times) / count


def measure(package, folder):
    """In the environment of the package: prints JSON, and keeps the filtered samples."""
    values = np.load(folder / "samples.npy")
    results = {}
    for kind, count, arrays, steps in globals()[f"{package}_filters"]():
        some = values[:count]
        filtered = arrays(some)
        np.save(folder / f"{package}-{kind}.npy", filtered)
        of_steps = min(count, 20000)
        rows = list(values[:of_steps])

        def run():
            step = steps(rows[0])
            for row in rows:
                step(row)

        step = steps(rows[0])
        same = np.abs(np.array([step(row) for row in rows]) - filtered[:of_steps]).max()
        results[kind] = {"count": count, "array_us": least_us(lambda: arrays(some), count), "step_us": least_us(run, of_steps),
                         "steps_against_array": same}
    print(json.dumps({"version": "" if package == "gauntlet" else importlib.metadata.version(package), "results": results}))


def run_in(python, package, folder, **environment):
    one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run([python, __file__, "--measure", package, folder], text=True, stdout=subprocess.PIPE, check=True,
                          env={**os.environ, **one_thread, **environment})
    return json.loads(done.stdout.splitlines()[-1])


def main():
    if sys.argv[1] == "--measure":
        return measure(sys.argv[2], pathlib.Path(sys.argv[3]))
    folder = pathlib.Path(sys.argv[1]).absolute()
    folder.mkdir(parents=True, exist_ok=True)
    np.save(folder / "samples.npy", samples())
    ours = run_in(sys.executable, "gauntlet", folder)["results"]
    print("| filter | package | samples | array [us] | times Gauntlet | step [us] | times Gauntlet | difference [noise] | settled |")
    print("|---|---|---|---|---|---|---|---|---|")
    for kind, own in ours.items():
        print(f"| `{kind}` | Gauntlet | {own['count']:,} | {own['array_us']:.4f} | 1 | {own['step_us']:.3f} | 1 | | |")
    for package, needs in ENVIRONMENTS.items():
        python = folder / package / "bin/python"
        if not python.exists():
            subprocess.run(["python3", "-m", "venv", folder / package], check=True)
            subprocess.run([python, "-m", "pip", "install", "-q", "numpy", *needs], check=True)
        found = run_in(python, package, folder, PYTHONPATH="")
        for kind, theirs in found["results"].items():
            expected = np.load(folder / f"gauntlet-{kind}.npy")[:theirs["count"]]
            difference = np.abs(np.load(folder / f"{package}-{kind}.npy") - expected) / NOISE
            print(f"| `{kind}` | {package} {found['version']} | {theirs['count']:,} | {theirs['array_us']:.4g} "
                  f"| {theirs['array_us'] / ours[kind]['array_us']:.3g} | {theirs['step_us']:.4g} "
                  f"| {theirs['step_us'] / ours[kind]['step_us']:.3g} | {difference.max():.2g} | {difference[len(difference) // 2:].max():.2g} |",
                  flush=True)


main()
