"""Ctrl-C, callbacks that raise, and Python that goes on meanwhile."""
import os
import pathlib
import signal
import subprocess
import sys
import textwrap
import threading
import time
import unittest

import gauntlet
from support import SHORT, Test

LONG = {"glove.motion.duration_s": 60}

SCRIPT = """
import gauntlet, sys
def told(done, total):
    print("running", flush=True)
try:
    gauntlet.compare("hold_still", set={"glove.motion.duration_s": 20}, seeds=40, out="out", progress=told)
except KeyboardInterrupt as stopped:
    print("stopped", *getattr(stopped, "__notes__", []))
    result = gauntlet.run("hold_still", set={"glove.motion.duration_s": 0.3})
    print("and goes on", len(result.controllers))
"""


class Stopping(Test):
    def test_ctrl_c_stops_a_comparison_and_python_goes_on(self):
        child = subprocess.Popen([sys.executable, "-W", "ignore", "-c", SCRIPT], stdout=subprocess.PIPE, text=True)
        self.assertEqual(child.stdout.readline(), "running\n")
        start = time.monotonic()
        child.send_signal(signal.SIGINT)
        rest = child.communicate(timeout=60)[0]
        self.assertLess(time.monotonic() - start, 20)  # of many minutes
        self.assertIn("stopped", rest)
        self.assertIn("and goes on 4", rest)
        self.assertEqual(child.returncode, 0)
        left = {path.name for path in pathlib.Path("out").rglob("*")} if pathlib.Path("out").exists() else set()
        self.assertLessEqual(left, {"study.db"})

    def test_the_end_of_python_stops_threads_that_are_not_waited_for(self):
        script = """
            import gauntlet, threading
            class Slow:
                def __init__(self, **facts): pass
                def step(self, sample):
                    inside.set()
                    while FILTER_HANGS: pass
                    return sample
            scenario = {"question": "q", "glove": {"motion": {"kind": "hold", "duration_s": 60}},
                        "controllers": {"a": {"filter": Slow}, "b": {"filter": "none"}}}
            inside = threading.Event()
            for _ in range(2):  # the second waits for its turn
                threading.Thread(target=lambda: gauntlet.compare(scenario, seeds=9, out="out"), daemon=True).start()
            inside.wait()
            print("ends")
            """
        for hangs in ("True", "False"):
            done = subprocess.run([sys.executable, "-W", "ignore", "-c", textwrap.dedent(script.replace("FILTER_HANGS", hangs))],
                                  text=True, capture_output=True, timeout=60)
            self.assertEqual((done.returncode, done.stdout), (0, "ends\n"), done.stderr)
            self.assertEqual(done.stderr, "")  # they wait for the end of the process

    def test_an_exception_of_the_callback_stops_the_work_and_comes_out(self):
        def told(done, total):
            raise LookupError(f"{total:g}")

        with self.assertRaisesRegex(LookupError, r"^\d+$"):
            gauntlet.compare("hold_still", set=LONG, seeds=20, progress=told)
        self.assertTrue(gauntlet.run("hold_still", set=SHORT).controllers)

    def test_progress_rises_to_the_whole(self):
        seen = []
        gauntlet.compare("hold_still", set=SHORT, seeds=2, progress=lambda done, total: seen.append((done, total)))
        self.assertEqual(seen, sorted(seen))
        self.assertEqual(seen[-1][0], seen[-1][1])

    def test_a_callback_cannot_begin_another_long_call(self):
        with self.assertRaisesRegex(gauntlet.RunError, "cannot begin another"):
            gauntlet.compare("hold_still", set=LONG, seeds=20, progress=lambda *_: gauntlet.run("hold_still"))

    def test_other_threads_run_meanwhile(self):
        ticks, stop = [], threading.Event()

        def count():
            while not stop.wait(0.01):
                ticks.append(time.monotonic())

        counter = threading.Thread(target=count)
        counter.start()
        gauntlet.run("hold_still", set={"glove.motion.duration_s": 3}, jobs=1)
        stop.set()
        counter.join()
        self.assertGreater(len(ticks), 10)

    def test_two_threads_take_turns(self):
        results = {}

        def work(seed):
            results[seed] = gauntlet.run("hold_still", set={**SHORT, "seed": seed}).json

        threads = [threading.Thread(target=work, args=(seed,)) for seed in (1, 2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for seed in (1, 2):
            self.assertEqual(results[seed], gauntlet.run("hold_still", set={**SHORT, "seed": seed}).json)


if __name__ == "__main__":
    unittest.main()
