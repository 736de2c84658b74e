"""Mistakes in Python are those of the program: the same line, with place and key."""
import pathlib
import unittest

import numpy as np

import gauntlet
from support import SHORT, Test, program

BASE = {"glove": {"motion": {"kind": "hold", "duration_s": 0.4}}, "controllers": {"raw": {"filter": "none"}}}


def changed(path, value):
    """BASE with one more key."""
    scenario = {"glove": {"motion": dict(BASE["glove"]["motion"])},
                "controllers": {"raw": dict(BASE["controllers"]["raw"])}}
    group = scenario
    for key in path[:-1]:
        group = group[key]
    group[path[-1]] = value
    return scenario


WRONG = {
    "unknown key": changed(["glove", "motoin"], {"kind": "hold"}),
    "unknown key below": changed(["controllers", "raw", "filter"], {"kind": "kalman", "qq": 1}),
    "type": changed(["seed"], "many"),
    "range": changed(["glove", "motion", "duration_s"], -1),
    "not finite": changed(["glove", "motion", "duration_s"], float("nan")),
    "kind": changed(["controllers", "raw", "filter"], {"kind": "kalmann"}),
    "list": changed(["controllers", "raw", "filter"], [{"kind": "kalman", "r": [1, -2]}, {"kind": "none"}]),
    "found while building": changed(["controllers", "raw", "filter"], {"kind": "kalman", "r": [1, 2]}),
    "odd text": changed(["baseline"], 'no "such: one'),
}


class Errors(Test):
    def test_of_a_dict_are_those_of_the_program_for_the_same_file(self):
        for name, scenario in WRONG.items():
            with self.subTest(name):
                error = self.mistake(gauntlet.run, scenario)
                pathlib.Path("scenario").write_text(gauntlet.to_yaml(scenario))
                _, theirs = program("run", "./scenario", code=2)
                self.assertEqual(f"gauntlet: ./{error}\n", theirs)
                self.assertRegex(error.place, r"^scenario(:\d+:\d+)?$")
                self.assertEqual(str(error), ": ".join(filter(None, [error.place, error.key, error.problem])))
                for given in ("./scenario", gauntlet.to_yaml(scenario)):
                    same = self.mistake(gauntlet.compare, given)
                    self.assertEqual((same.key, same.problem), (error.key, error.problem))

    def test_of_values_on_top_name_the_value(self):
        error = self.mistake(gauntlet.run, "hold_still", set={"glove.motion.duration_s": -2})
        self.assertEqual((error.place, error.key), ("--set glove.motion.duration_s=-2", "glove.motion.duration_s"))
        _, theirs = program("run", "hold_still", "--set", "glove.motion.duration_s=-2", code=2)
        self.assertEqual(f"gauntlet: {error}\n", theirs)

    def test_suggest_what_was_meant(self):
        self.assertIn("did you mean hold_still?", str(self.mistake(gauntlet.run, "hold_stil")))
        self.assertIn("did you mean raw?", str(self.mistake(gauntlet.run, "hold_still", controllers=["rww"])))
        self.assertIn("must be one of none", str(self.mistake(gauntlet.filter, np.zeros((4, 2)), "kalmn")))
        error = self.mistake(gauntlet.filter, np.zeros((4, 2)), "kalman")  # whose default is for 18 channels
        self.assertEqual((error.place, error.key), ("filter", "r"))

    def test_of_arguments_name_the_argument(self):
        for place, call, named in [("jobs", gauntlet.run, {"jobs": -1}), ("seeds", gauntlet.compare, {"seeds": -3}),
                                   ("causes", gauntlet.run, {"causes": "some"}), ("out", gauntlet.run, {"out": ""}),
                                   ("controllers", gauntlet.run, {"controllers": "raw"}),
                                   ("evaluations", gauntlet.tune, {"evaluations": 0}), ("--free", gauntlet.tune, {}),
                                   ("seeds", gauntlet.sweep, {"seeds": 0})]:
            with self.subTest(place):
                self.assertEqual(self.mistake(call, "hold_still", **named).place, place)
        with self.assertRaises(TypeError):
            gauntlet.run(7)

    def test_leave_no_folder(self):
        self.mistake(gauntlet.run, WRONG["kind"], out="out/deep")
        self.mistake(gauntlet.compare, WRONG["found while building"], out="out/deep")
        self.assertFalse(pathlib.Path("out").exists())

    def test_refuse_a_folder_that_is_a_file(self):
        pathlib.Path("taken").write_text("mine")
        self.assertIn("is a file", str(self.mistake(gauntlet.run, "hold_still", set=SHORT, out="taken")))
        self.assertEqual(pathlib.Path("taken").read_text(), "mine")

    def test_of_files_name_the_file(self):
        pathlib.Path("empty.csv").write_text("")
        for call in (gauntlet.inspect, gauntlet.identify, gauntlet.audit):
            with self.subTest(call.__name__):
                self.assertIn("empty.csv", str(self.mistake(call, "empty.csv")))
                self.assertIn("missing.csv", str(self.mistake(call, "missing.csv")))


if __name__ == "__main__":
    unittest.main()
