"""A comparison, a sweep and a search on a dask LocalCluster of two workers, one of which is killed in the middle: same bytes?

Not among the tests of the build, as it needs dask.distributed:

    pip install distributed
    PYTHONPATH=build/release/python python3 tests/python/dask_cluster.py
"""
import os
import signal
import sys
import threading
import time
import warnings

import gauntlet

SET = {"glove.motion.duration_s": 4}
SEEDS = 24


def killer(client, begun, killed):
    """Kills one of the workers as soon as it has run for a while."""
    begun.wait()
    time.sleep(0.5)
    process = sorted(client.run(os.getpid).values())[0]
    os.kill(process, signal.SIGKILL)
    killed.append(process)


def check(name, call, client, expected):
    begun, killed = threading.Event(), []
    thread = threading.Thread(target=killer, args=(client, begun, killed))
    thread.start()
    start = time.monotonic()
    result = call(executor=client.get_executor(), progress=lambda done, total: begun.set())
    took_s = time.monotonic() - start
    begun.set()
    thread.join()
    same = result.json == expected.json and str(result) == str(expected)
    print(f"{name}: worker {killed[0]} killed, {took_s:.1f} s, {'same bytes' if same else 'OTHER BYTES'}")
    return same


def main():
    from distributed import Client, LocalCluster

    warnings.simplefilter("ignore", gauntlet.Remark)
    calls = {
        "compare": lambda **more: gauntlet.compare("hold_still", set=SET, seeds=SEEDS, **more),
        "tune": lambda **more: gauntlet.tune("hold_still", set=SET, controller="tuned_kalman", free={"filter.q": "1e-6:10:log"},
                                             evaluations=12, **more),
        "sweep": lambda **more: gauntlet.sweep("kalman_q", seeds=4, **more),
    }
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        good = []
        for name, call in calls.items():
            start = time.monotonic()
            expected = call(progress=False)
            print(f"{name}: {time.monotonic() - start:.1f} s in one process")
            good.append(check(name, call, client, expected))
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main())
