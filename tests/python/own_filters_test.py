"""Filters that are objects of Python, in the same table as ours."""
import pathlib
import signal
import subprocess
import sys
import textwrap
import threading
import time
import unittest

import numpy as np

import gauntlet
from gauntlet import PythonFilter
from support import Test, program

CHANNELS = ["index_mcp", "middle_mcp"]


class Exponential:
    def __init__(self, rate_hz, channels, alpha=0.1):
        self.alpha = alpha
        self.filtered = np.full(len(channels), np.nan)

    def start_channel(self, channel):
        self.filtered[channel] = np.nan

    def step(self, sample):
        before = np.where(np.isnan(self.filtered), sample, self.filtered)
        self.filtered = before + self.alpha * (sample - before)
        return self.filtered


def scenario(duration_s=0.3, **filters):
    return {"question": "q", "glove": {"channels": CHANNELS, "motion": {"kind": "random", "duration_s": duration_s}},
            "controllers": {name: {"filter": each} for name, each in filters.items()}}


def steps(function):
    """A filter whose step(sample) is function(sample, number of the sample)."""
    class Steps:
        def __init__(self, **_):
            self.number = 0

        def step(self, sample):
            self.number += 1
            return function(sample, self.number)
    return Steps


def scores(result, name):
    """All scores of a controller, without its name and place."""
    found = next(each for each in result.data["controllers"] if each["name"] == name)
    return found["summary"], found.get("channels")


class OwnFilters(Test):
    def test_computes_what_ours_compute_to_the_last_bit_on_any_number_of_threads(self):
        given = scenario(none="none", ours={"kind": "exponential", "alpha": 0.1}, mine=Exponential,
                         other=PythonFilter(Exponential, parameters={"alpha": 0.3}),
                         part=PythonFilter(Exponential, channels=["middle_mcp"]),
                         ours_part={"kind": "exponential", "alpha": 0.1, "channels": ["middle_mcp"]},
                         chain=[Exponential, {"kind": "moving_average", "window": 3}],
                         ours_chain=[{"kind": "exponential", "alpha": 0.1}, {"kind": "moving_average", "window": 3}])
        single, both = (gauntlet.compare(given, seeds=2, jobs=jobs, causes="none") for jobs in (1, 2))
        self.assertEqual(single.json, both.json)
        for mine, ours in (("mine", "ours"), ("part", "ours_part"), ("chain", "ours_chain")):
            self.assertEqual(scores(both, mine), scores(both, ours))
        errors = both.summary("tracking_rmse_deg")
        self.assertEqual(len({round(errors[name], 6) for name in ("none", "mine", "other", "part", "chain")}), 5)

    def test_makes_one_for_each_filter_of_a_trial_with_its_facts(self):
        made = []

        def make(rate_hz, channels, **parameters):
            made.append((rate_hz, channels, parameters))
            return Exponential(rate_hz, channels, 0.5)

        given = scenario(mine=PythonFilter(make, parameters={"a": 1, "b": 0.25}),
                         one=PythonFilter(make, channels=[2], parameters={"a": 2}))
        given["score"] = {"noise_free_twin": False}
        gauntlet.run(given, causes="none", jobs=1)
        self.assertEqual(made, [(1000.0, CHANNELS, {"a": 1.0, "b": 0.25}), (1000.0, ["middle_mcp"], {"a": 2.0})])

    def test_one_that_fails_costs_its_own_trials_only(self):
        def raises(sample, number):
            if number == 100:
                raise ValueError("no more\nof it")
            return sample

        def nested(sample, number):
            gauntlet.run("hold_still")

        filters = {
            "raises": (steps(raises), r"python:Steps\w*: at sample 100: ValueError: no more\\nof it \(own_filters_test.py:\d+\)"),
            "short": (steps(lambda sample, number: sample[:2 - (number == 7)]), "at sample 7: returned 1 value, must be an array of 2 numbers"),
            "nan": (steps(lambda sample, number: sample + [0, np.nan]), "at sample 1: returned nan for middle_mcp, must be finite"),
            "none_at_all": (steps(lambda sample, number: None), "at sample 1: returned NoneType, must be an array of 2 numbers"),
            "texts": (steps(lambda sample, number: ["a", "b"]), "returned list, must be an array of 2 numbers"),
            "matrix": (steps(lambda sample, number: sample[None]), "returned an array of 2 dimensions, must be an array of 2 numbers"),
            "scalar": (steps(lambda sample, number: 3.0), "returned float, must be an array of 2 numbers"),
            "exits": (steps(lambda sample, number: sys.exit(3)), "at sample 1: SystemExit: 3"),
            "is_unknown": (PythonFilter(Exponential, parameters={"aplha": 1}), "unexpected keyword argument 'aplha'"),
            "has_no_step": (lambda **_: 5, "'int' object has no attribute 'step'"),
            "nested": (steps(nested), "at sample 1: RunError: a filter cannot begin another long call"),
        }
        result = gauntlet.compare(scenario(0.2, good="none", lists=steps(lambda sample, number: list(sample)),
                                           **{name: each for name, (each, _) in filters.items()}), seeds=2, causes="none")
        for name, (_, expected) in filters.items():
            with self.subTest(name):
                self.assertRegex("\n".join(line for line in result.remarks if f"{name} failed" in line), expected)
                self.assertEqual(next(each for each in result.data["controllers"] if each["name"] == name)["failed_trials"], 2)
        self.assertEqual(scores(result, "lists"), scores(result, "good"))
        self.assertGreater(result.summary("tracking_rmse_deg")["good"], 0)

    def test_functions_over_arrays_must_not_look_ahead(self):
        def backward(samples, rate_hz, width=3.0):
            return np.array([samples[max(0, i + 1 - int(width)):i + 1].mean(axis=0) for i in range(len(samples))])

        def centred(samples, rate_hz):
            return backward(np.roll(samples, -1, axis=0), rate_hz)

        def late(samples, rate_hz):  # from the 150th sample on
            answer = samples.copy()
            answer[100:] += len(samples) >= 150
            return answer

        errors = gauntlet.run(scenario(0.2, mine=PythonFilter(backward, array=True, parameters={"width": 4}),
                                       ours={"kind": "moving_average", "window": 4}), causes="none").summary("peak_error_deg")
        self.assertAlmostEqual(errors["mine"], errors["ours"], delta=1e-9 * errors["ours"])
        for function, expected in ((centred, r"at sample \d+ changes by \S+ when sample \d+ comes"),
                                   (late, "at sample 101 changes by 1 when sample 150 comes")):
            for call in (gauntlet.run, gauntlet.compare):
                error = self.mistake(call, scenario(0.2, mine=PythonFilter(function, array=True)))
                self.assertEqual(error.key, "controllers.mine.filter")
                self.assertRegex(error.problem, f"^python:{function.__name__} looks ahead: its value of index_mcp {expected}"
                                                "|^python:centred looks ahead: its value of middle_mcp")
        result = gauntlet.run(scenario(0.2, good="none", mine=PythonFilter(lambda samples, rate_hz: samples[1:], array=True)))
        self.assertIn("at sample 1: ValueError: returned an array of shape (0, 2), must be (1, 2)", str(result.remarks))

    def test_its_parameters_are_tuned_and_swept(self):
        mine = PythonFilter(Exponential, parameters={"alpha": 0.05})
        given = scenario(0.5, mine=mine, ours={"kind": "exponential", "alpha": 0.05})
        named = dict(evaluations=5, seeds=2, held_out=2, filter_only=True)
        found = gauntlet.tune(given, controller="mine", free={"filter.parameters.alpha": "0.01:0.9"}, **named)
        ours = gauntlet.tune(given, controller="ours", free={"filter.alpha": "0.01:0.9"}, **named)
        self.assertEqual([row["controllers.mine.filter.parameters.alpha"] for row in found.settings],
                         [row["controllers.ours.filter.alpha"] for row in ours.settings])
        self.assertEqual(*([row["tracking_rmse_deg"] for row in each.settings] for each in (found, ours)))
        pathlib.Path("s.yaml").write_text(gauntlet.to_yaml(scenario(mine="none")))
        cells = gauntlet.sweep({"scenario": "s.yaml", "question": "q", "seeds": 1, "scores": ["tracking_rmse_deg"],
                                "physics": False,
                                "axes": [{"key": "controllers.mine.filter.parameters.alpha", "values": [0.1, 0.5]}]},
                               set={"controllers.mine.filter": mine}).cells
        self.assertEqual(len({row["tracking_rmse_deg"] for row in cells}), 2)

    def test_no_file_names_an_object(self):
        given = scenario(0.2, mine=Exponential)
        result = gauntlet.run(given, out="out", causes="none")
        resolved = pathlib.Path("out/scenario.resolved.yaml").read_text()
        self.assertIn("# It repeats only from Python, with the objects", resolved)
        self.assertIn("python:Exponential", resolved)
        again = gauntlet.run("out/scenario.resolved.yaml", set={"controllers.mine.filter": Exponential}, causes="none")
        self.assertEqual(scores(again, "mine"), scores(result, "mine"))
        named = {**given, "controllers": {"mine": {"filter": {"kind": "external", "command": "python:Exponential"}}, "raw": {"filter": "none"}}}
        pathlib.Path("s.yaml").write_text(gauntlet.to_yaml(named))
        pathlib.Path("study.yaml").write_text(gauntlet.to_yaml({
            "scenario": "s.yaml", "question": "q", "seeds": 1, "scores": ["tracking_rmse_deg"],
            "axes": [{"key": "glove.motion.duration_s", "values": [0.2]}]}))
        for command in (["run", "s.yaml"], ["compare", "s.yaml"], ["sweep", "study.yaml"], ["robust", "s.yaml", "--hands", 1],
                        ["tune", "s.yaml", "--controller", "mine", "--free", "filter.timeout_ms=100:200"],
                        ["run", "out/scenario.resolved.yaml"]):
            for consent in ([], ["--allow-programs"]):
                _, error = program(*command, *consent, "--out", "theirs", code=2)
                self.assertRegex(error, r"^gauntlet: \S+:\d+:\d+: controllers.mine.filter\[0\].command: is python:Exponential, an "
                                        r"object of Python, which no file contains; [^\n]+\n$")
        for call in (lambda: gauntlet.run("s.yaml", allow_programs=True), lambda: gauntlet.compare("s.yaml", out="theirs")):
            self.assertIn("an object of Python", self.mistake(call).problem)
        self.assertFalse(pathlib.Path("theirs").exists())
        self.assertEqual(self.mistake(gauntlet.to_yaml, given).key, "filter")
        for call, arguments in ((gauntlet.filter, (np.zeros((4, 2)), {"kind": Exponential})), (gauntlet.Controller, (given,))):
            self.mistake(call, *arguments)
        error = self.mistake(gauntlet.run, scenario(mine=Exponential(1000, CHANNELS)))
        self.assertIn("filter: is of type Exponential, must be the class, or a function", str(error))
        program("export", "out", "--controller", "mine", "--out", "robot.yaml", code=2)

    def test_trials_are_kept_only_of_known_code_that_is_deterministic(self):
        (self.folder / "own.py").write_text(textwrap.dedent("""
            import gauntlet, sys, warnings
            from support import Test
            calls = []
            class Counted:
                def __init__(self, **facts): calls.append(1)
                def step(self, sample): return sample * SCALE
            def local():
                class Counted:
                    def __init__(self, **facts): calls.append(1)
                    def step(self, sample): return sample * SCALE
                return Counted
            SCALE = 0.99
            if __name__ == "__main__":
                warnings.simplefilter("ignore")
                make = local() if sys.argv[1] == "local" else Counted
                for seeds in (3, 3):
                    scenario = {"question": "q", "score": {"noise_free_twin": False},
                                "glove": {"channels": ["index_mcp"], "motion": {"kind": "hold", "duration_s": 0.2}},
                                "controllers": {"mine": {"filter": gauntlet.PythonFilter(make, deterministic=sys.argv[2] == "yes")}}}
                    gauntlet.compare(scenario, seeds=seeds, causes="none", out=sys.argv[1] + sys.argv[2])
                    print(len(calls), end=" ")
                    calls.clear()
            """))

        def calls(*arguments):
            time.sleep(0.1)  # so that the file is older than the process
            done = subprocess.run([sys.executable, "own.py", *arguments], text=True, capture_output=True, check=True,
                                  env={**__import__("os").environ, "PYTHONPATH": ":".join(sys.path)})
            return list(map(int, done.stdout.split()))

        # The first seed always runs again, as its signals are shown.
        self.assertEqual(calls("global", "yes"), [3, 1])
        self.assertEqual(calls("global", "yes"), [1, 1])
        own = self.folder / "own.py"
        own.write_text(own.read_text().replace("SCALE = 0.99", "SCALE = 0.98"))
        self.assertEqual(calls("global", "yes"), [3, 1])
        self.assertEqual(calls("global", "no"), [3, 3])
        self.assertEqual(calls("local", "yes"), [3, 3])

    def test_code_that_may_be_older_than_its_file_is_never_known(self):
        from gauntlet import _filters
        module = self.folder / "written_now.py"
        module.write_text("class F: pass\nclass G(F): pass\ndef f(): pass\n")
        sys.path.insert(0, str(self.folder))
        self.addCleanup(sys.path.remove, str(self.folder))
        import written_now
        self.addCleanup(sys.modules.pop, "written_now")
        for make in (written_now.F, written_now.f, lambda: 0, int, np.ufunc, steps(len)):
            self.assertEqual(_filters._files(make), [], make)
        __import__("os").utime(module, (1e9, 1e9))
        for make in (written_now.F, written_now.G, written_now.f):
            self.assertEqual({file.resolve() for file in _filters._files(make)}, {module.resolve()}, make)

    def test_ctrl_c_stops_it_wherever_it_is(self):
        script = """
            import gauntlet, os, time
            class Hangs:
                def __init__(self, **facts): self.count = 0
                def step(self, sample):
                    self.count += 1
                    if self.count == 5:
                        os.write(1, b"hangs\\n")  # two trials at once: print() would mix their lines
                        while True: time.sleep(0.001)
                    return sample
            scenario = {"question": "q", "glove": {"channels": ["index_mcp"], "motion": {"kind": "hold", "duration_s": 0.2}},
                        "controllers": {name: {"filter": Hangs} for name in "abc"}}
            try:
                gauntlet.compare(scenario, seeds=4, jobs=2, causes="none", out="out", progress=lambda *_: None)
            except KeyboardInterrupt:
                print("stopped")
            scenario["controllers"] = {"a": {"filter": lambda **_: type("I", (), {"step": lambda self, sample: sample})()}}
            print("and goes on", len(gauntlet.run(scenario, causes="none").controllers))
            """
        child = subprocess.Popen([sys.executable, "-W", "ignore", "-c", textwrap.dedent(script)], stdout=subprocess.PIPE, text=True)
        self.addCleanup(child.wait)
        self.addCleanup(child.kill)
        self.assertEqual(child.stdout.readline(), "hangs\n")
        time.sleep(0.2)
        child.send_signal(signal.SIGINT)
        rest = child.communicate(timeout=60)[0]
        self.assertIn("stopped\nand goes on 1\n", rest)
        self.assertEqual(child.returncode, 0)

    def test_thread_local_values_last_and_objects_are_let_go(self):
        local, alive = threading.local(), []

        class Counts:
            def __init__(self, **_):
                alive.append(1)
                local.count = 0

            def __del__(self):
                alive.pop()

            def step(self, sample):
                local.count += 1
                self.count = getattr(self, "count", 0) + 1
                if local.count != self.count:
                    raise AssertionError(f"{local.count} of {self.count}")
                return sample

        result = gauntlet.run(scenario(0.2, mine=Counts), causes="none", jobs=2)
        self.assertEqual((result.remarks, alive), ([], []))


if __name__ == "__main__":
    unittest.main()
