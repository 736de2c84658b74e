import pathlib
import unittest

import numpy as np

import gauntlet
from gauntlet import _settings
from support import Test

NESTED = {
    "name": "it's: odd, #1", "flag": True, "off": False, "word": "yes", "number": 1e-6, "whole": 3, "none_text": "null",
    "list": [1, 2.5, "three"], "maps": [{"a": 1, "b": {"c": [True, "x y"]}}, {"a": 2}], "lists": [[1, 2], [3]],
    "empty": {"inner": {}}, "umlaut": "größe", "array": np.arange(3), "single": np.float32(0.5), "path": pathlib.Path("a/b.csv"),
}
PLAIN = {**NESTED, "array": [0, 1, 2], "single": 0.5, "path": "a/b.csv"}


class Settings(Test):
    def test_a_dict_becomes_yaml_with_the_same_values(self):
        try:
            import yaml
        except ImportError:
            self.skipTest("python3-yaml is not installed")
        self.assertEqual(yaml.safe_load(gauntlet.to_yaml(NESTED).replace("1e-06", "1.0e-06")), PLAIN)

    def test_has_a_line_for_each_key(self):
        self.assertEqual(gauntlet.to_yaml({"glove": {"motion": {"kind": "hold", "duration_s": 2}}, "seeds": [1, 2],
                                           "axes": [{"key": "a.b", "values": [0.5]}, {"key": "c", "low": 1e-5}]}),
                         "glove:\n  motion:\n    kind: hold\n    duration_s: 2\nseeds: [1, 2]\n"
                         "axes:\n  - key: a.b\n    values: [0.5]\n  - key: c\n    low: 1e-05\n")

    def test_values_on_top_are_texts_or_a_dict(self):
        self.assertEqual(_settings.overrides({"a.b": 2, "c": [1, 2], "d": "x y"}), ["a.b=2", "c=[1, 2]", 'd="x y"'])
        self.assertEqual(_settings.overrides("a=1"), ["a=1"])
        self.assertEqual(_settings.overrides(None), [])

    def test_refuses_what_is_no_setting(self):
        self.assertEqual(self.mistake(gauntlet.to_yaml, {"a": {"b": object()}}).key, "b")
        self.assertEqual(self.mistake(gauntlet.to_yaml, {1: 2}).key, "1")

    def test_text_and_file_are_told_apart_by_the_lines(self):
        self.assertEqual(_settings.source("a: 1\n", "scenario"), ("scenario", "a: 1\n"))
        self.assertEqual(_settings.source("a.yaml", "scenario"), ("a.yaml", None))
        self.assertEqual(_settings.source(pathlib.Path("a.yaml"), "scenario"), ("a.yaml", None))


if __name__ == "__main__":
    unittest.main()
