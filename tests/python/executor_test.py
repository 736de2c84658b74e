"""Executors give the bytes of one process, also where a worker is killed."""
import concurrent.futures
import multiprocessing
import os
import pathlib
import signal
import subprocess
import sys
import textwrap
import time
import unittest

import numpy as np

import gauntlet
from support import SHORT, SOURCE, Test

STUDY = {"question": "q", "scenario": str(SOURCE / "scenarios/hold_still.yaml"), "set": ["glove.motion.duration_s=0.3"],
         "seeds": 2, "scores": ["tracking_rmse_deg", "jitter_rms_deg"],
         "axes": [{"key": "event.delay_ms", "values": [0, 5, 25]}]}

TUNE = {"set": SHORT, "seeds": 2, "held_out": 2, "evaluations": 4, "filter_only": True}

SEARCH = {**TUNE, "seeds": 3, "held_out": 3, "filter_only": False, "controller": "tuned_kalman", "free": {"filter.q": "1e-6:10:log"},
          "subject_to": ["tracking_rmse_deg<=50"]}


class Smooth:
    def __init__(self, rate_hz, channels, weight=0.2):
        self.weight = weight
        self.value = None

    def step(self, sample):
        self.value = sample if self.value is None else self.value + self.weight * (sample - self.value)
        return self.value


class Deadly(Smooth):
    """The first one in another process kills it."""

    def step(self, sample):
        if os.getpid() != int(os.environ["CALLER"]) and not pathlib.Path(os.environ["MARK"]).exists():
            pathlib.Path(os.environ["MARK"]).touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return super().step(sample)


class Lossy(concurrent.futures.Executor):
    """Loses the first `losses` parts, as a cluster whose workers die."""

    class KilledWorker(Exception):
        pass

    def __init__(self, losses):
        self.losses = losses
        self.sent = 0
        self._pool = concurrent.futures.ThreadPoolExecutor(2)

    def submit(self, function, *arguments):
        self.sent += 1
        if self.sent > self.losses:
            return self._pool.submit(function, *arguments)
        lost = concurrent.futures.Future()
        lost.set_exception(self.KilledWorker("worker tcp://a died\nthree times"))
        return lost


def of(kind):
    return {"question": "q", "glove": {"motion": {"kind": "random", "duration_s": 0.3}},
            "controllers": {"raw": {"filter": "none"}, "mine": {"filter": gauntlet.PythonFilter(kind, parameters={"weight": 0.3})}}}


class Executors(Test):
    def for_each_pool(self, check):
        spawn = multiprocessing.get_context("spawn")
        for pool in (concurrent.futures.ThreadPoolExecutor(3), concurrent.futures.ProcessPoolExecutor(2),
                     concurrent.futures.ProcessPoolExecutor(1, mp_context=spawn)):
            with pool, self.subTest(pool=type(pool).__name__):
                check(pool)

    def assertSame(self, result, expected):
        self.assertEqual(result.json, expected.json)
        self.assertEqual(str(result), str(expected))
        if isinstance(result, gauntlet.StudyResult):
            self.assertEqual(result.scores_csv, expected.scores_csv)
            self.assertEqual(result.page, expected.page)
            np.testing.assert_array_equal(result.trace(result.controllers[0])["hand_angle_rad"],
                                          expected.trace(expected.controllers[0])["hand_angle_rad"])

    def test_compare_has_the_same_bytes(self):
        expected = gauntlet.compare("hold_still", set=SHORT, seeds=4, causes="all")
        self.for_each_pool(lambda pool: self.assertSame(
            gauntlet.compare("hold_still", set=SHORT, seeds=4, causes="all", executor=pool), expected))

    def test_sweep_has_the_same_bytes(self):
        expected = gauntlet.sweep(STUDY, out="here")

        def check(pool):
            told = []
            out = f"out-{id(pool)}"
            self.assertSame(gauntlet.sweep(STUDY, executor=pool, out=out, progress=lambda done, all: told.append(done)), expected)
            self.assertEqual(told, sorted(told))
            for name in ("cells.csv", "report.html"):
                self.assertEqual(pathlib.Path(out, name).read_bytes(), pathlib.Path("here", name).read_bytes())

        self.for_each_pool(check)

    def test_tune_of_all_kinds_has_the_same_bytes(self):
        expected = gauntlet.tune("hold_still", all=True, **TUNE)
        self.assertGreater(len(expected.controllers), 5)

        def check(pool):
            told = []
            result = gauntlet.tune("hold_still", all=True, **TUNE, executor=pool, progress=lambda done, all: told.append(done))
            self.assertSame(result, expected)
            self.assertEqual((result.page, result.settings.rows, result.controllers),
                             (expected.page, expected.settings.rows, expected.controllers))
            self.assertEqual(told, sorted(told))

        self.for_each_pool(check)

    def test_a_search_of_one_controller_has_the_same_bytes(self):
        expected = gauntlet.tune("hold_still", **SEARCH)

        def check(pool):
            told = []
            result = gauntlet.tune("hold_still", **SEARCH, executor=pool, progress=lambda done, all: told.append(done))
            self.assertSame(result, expected)
            self.assertEqual((result.page, result.settings.rows, result.controllers),
                             (expected.page, expected.settings.rows, expected.controllers))
            self.assertEqual(told, sorted(told))

        self.for_each_pool(check)
        lossy = Lossy(2)
        self.assertSame(gauntlet.tune("hold_still", **SEARCH, executor=lossy), expected)
        # Two of three seeds, for three settings on the fitted part, and for the best and the one before on the other; two again.
        self.assertEqual(lossy.sent, 2 * (3 + 2) + 2)

    def test_own_filters_and_files_of_the_folder_reach_the_workers(self):
        (self.folder / "hand.csv").write_text("time_s,index_mcp\n" + "".join(f"{i / 100},{np.sin(i / 9):.4f}\n" for i in range(90)))
        scenario = of(Smooth)
        scenario["glove"] = {"channels": ["index_mcp"], "motion": {"kind": "recording", "file": "hand.csv"}}
        for scenario in (of(Smooth), scenario):
            expected = gauntlet.compare(scenario, seeds=3)
            self.for_each_pool(lambda pool: self.assertSame(gauntlet.compare(scenario, seeds=3, executor=pool), expected))

    def test_a_killed_worker_costs_nothing_but_time(self):
        os.environ["CALLER"] = str(os.getpid())
        os.environ["MARK"] = str(self.folder / "mark")
        (self.folder / "mark").touch()
        expected = gauntlet.compare(of(Deadly), seeds=5)
        (self.folder / "mark").unlink()
        with concurrent.futures.ProcessPoolExecutor(2) as pool:
            result = gauntlet.compare(of(Deadly), seeds=5, executor=pool)
        self.assertTrue((self.folder / "mark").exists())
        self.assertSame(result, expected)
        self.assertIn("The rest is computed in this process", " ".join(result.remarks))

    def test_a_lost_part_is_sent_again_three_times_at_most(self):
        expected = gauntlet.compare("hold_still", set=SHORT, seeds=3)
        lossy = Lossy(2)
        self.assertSame(gauntlet.compare("hold_still", set=SHORT, seeds=3, executor=lossy), expected)
        self.assertEqual(lossy.sent, 8 + 2)
        for call in (lambda: gauntlet.compare("hold_still", set=SHORT, seeds=3, executor=Lossy(99)),
                     lambda: gauntlet.sweep(STUDY, executor=Lossy(99)),
                     lambda: gauntlet.tune("hold_still", all=True, **TUNE, executor=Lossy(99)),
                     lambda: gauntlet.tune("hold_still", **SEARCH, executor=Lossy(99))):
            with self.assertRaisesRegex(gauntlet.RunError, "^executor: part [0-9]+ of [0-9]+ failed 3 times, at last with "
                                                           "KilledWorker: worker tcp://a died three times$"):
                call()

    def test_a_worker_that_computes_something_else_is_found(self):
        class Other(Lossy):
            """Its workers have another scenario, as after a change of a file."""

            def submit(self, function, name, arguments, *rest):
                file, text, overrides, *others = arguments
                return super().submit(function, name, (file, text, [*overrides, "glove.rate_hz=500"], *others), *rest)

        for call in (lambda: gauntlet.compare("hold_still", set=SHORT, seeds=3, executor=Other(0)),
                     lambda: gauntlet.sweep(STUDY, executor=Other(0)),
                     lambda: gauntlet.tune("hold_still", all=True, **TUNE, executor=Other(0)),
                     lambda: gauntlet.tune("hold_still", **SEARCH, executor=Other(0))):
            with self.assertRaisesRegex(gauntlet.RunError, "executor: a worker gave other results than were asked for"):
                call()

    def test_what_is_kept_is_not_sent(self):
        first = gauntlet.compare("hold_still", set=SHORT, seeds=3, out="out", executor=Lossy(0))
        again = Lossy(0)
        self.assertSame(gauntlet.compare("hold_still", set=SHORT, seeds=3, out="out", executor=again), first)
        self.assertEqual(again.sent, 0)
        self.assertSame(gauntlet.compare("hold_still", set=SHORT, seeds=3, out="out"), first)
        gauntlet.sweep(STUDY, out="cells")
        gauntlet.sweep(STUDY, out="cells", executor=again)
        self.assertEqual(again.sent, 0)

    def test_mistakes(self):
        with self.assertRaisesRegex(TypeError, "executor must be a concurrent.futures.Executor, not str"):
            gauntlet.compare("hold_still", executor="dask")
        ended = concurrent.futures.ThreadPoolExecutor(1)
        ended.shutdown()
        with self.assertRaisesRegex(gauntlet.RunError, "executor: takes no work: cannot schedule new futures after shutdown"):
            gauntlet.compare("hold_still", set=SHORT, seeds=2, executor=ended)

    def test_ctrl_c_stops_caller_and_workers(self):
        script = """
            import concurrent.futures, gauntlet, sys
            told = lambda done, all: print("running", flush=True)
            pool = getattr(concurrent.futures, sys.argv[1])(2)
            with pool:
                try:
                    gauntlet.compare("hold_still", set={"glove.motion.duration_s": 5}, seeds=40, executor=pool, out="out", progress=told)
                except KeyboardInterrupt:
                    print("stopped", flush=True)
            """
        for pool in ("ThreadPoolExecutor", "ProcessPoolExecutor"):
            child = subprocess.Popen([sys.executable, "-W", "ignore", "-c", textwrap.dedent(script), pool], stdout=subprocess.PIPE,
                                     stderr=subprocess.DEVNULL, text=True, start_new_session=True)
            self.assertEqual(child.stdout.readline(), "running\n")
            start = time.monotonic()
            os.killpg(child.pid, signal.SIGINT)  # as the terminal does
            rest = child.communicate(timeout=60)[0]
            self.assertLess(time.monotonic() - start, 20)
            self.assertIn("stopped", rest)


if __name__ == "__main__":
    unittest.main()
