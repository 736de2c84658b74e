"""The module gives the bytes of the program."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import numpy as np

import gauntlet
from gauntlet._results import table_of_csv
from support import SHORT, SOURCE, Test, program

FILES = ["scores.json", "scores.csv", "scenario.resolved.yaml", "report.html"]


class Studies(Test):
    def assertSameFile(self, ours, theirs):
        self.assertEqual(pathlib.Path(ours).read_bytes(), pathlib.Path(theirs).read_bytes(), ours)

    def test_run_writes_the_files_of_the_program(self):
        result = gauntlet.run("hold_still", set=SHORT, out="ours")
        program("run", "hold_still", "--set", "glove.motion.duration_s=0.5", "--out", "theirs")
        for name in FILES:
            self.assertSameFile(f"ours/{name}", f"theirs/{name}")
        self.assertEqual(result.json, pathlib.Path("theirs/scores.json").read_text())
        self.assertEqual(result.scores_csv, pathlib.Path("theirs/scores.csv").read_text())
        self.assertEqual(result.resolved_scenario, gauntlet.run("hold_still", set=SHORT).resolved_scenario)
        self.assertEqual(program("diff", "ours", "theirs")[1], "")

    def test_compare_has_the_scores_of_the_program_on_any_number_of_threads(self):
        result = gauntlet.compare("hold_still", set=SHORT, seeds=3, jobs=3)
        out, _ = program("compare", "hold_still", "--set", "glove.motion.duration_s=0.5", "--seeds", 3, "--jobs", 1, "--out",
                         "theirs", "--json")
        self.assertEqual(result.json, out)
        self.assertEqual(result.scores_csv, pathlib.Path("theirs/scores.csv").read_text())
        self.assertEqual(result.page, pathlib.Path("theirs/report.html").read_text())
        self.assertFalse(pathlib.Path("out").exists())
        self.assertEqual(result.data["seeds"], [1, 2, 3])

    def test_compare_continues_what_it_kept(self):
        first = gauntlet.compare("hold_still", set=SHORT, seeds=2, out="kept")
        again = gauntlet.compare("hold_still", set=SHORT, seeds=2, out="kept")
        self.assertEqual(first.json, again.json)
        self.assertTrue(any("continues from" in line for line in again.remarks), again.remarks)

    def test_another_build_of_the_module_does_not_find_what_was_kept(self):
        package = pathlib.Path("other/gauntlet")
        shutil.copytree(pathlib.Path(gauntlet.__file__).parent, package)
        code = f"import gauntlet; print(gauntlet.compare('hold_still', set={SHORT!r}, seeds=2, out='kept').remarks)"

        def remarks(folder):
            environment = {**os.environ, "PYTHONPATH": folder, "GAUNTLET_DATA_DIR": str(SOURCE)}
            return subprocess.run([sys.executable, "-W", "ignore", "-c", code], env=environment, text=True, capture_output=True,
                                  check=True).stdout

        self.assertNotIn("continues from", remarks("other"))
        self.assertIn("continues from", remarks("other"))
        with next(package.glob("_core*.so")).open("ab") as module:
            module.write(b"\0")
        self.assertNotIn("continues from", remarks("other"))

    def test_programs_run_with_consent_to_this_call_alone(self):
        (self.folder / "f.py").write_text("import sys\nopen('was_here', 'w')\nnext(sys.stdin)\n"
                                          "for line in sys.stdin: print(line, end='', flush=True)\n")
        scenario = {"question": "q", "glove": {"channels": ["index_mcp"], "motion": {"kind": "sine", "duration_s": 0.3}},
                    "controllers": {"none": {"filter": "none"},
                                    "mine": {"filter": {"kind": "external", "command": "python3 f.py"}}}}
        tuned = {"controller": "mine", "free": {"filter.timeout_ms": "100:200"}}
        study = {"scenario": "s.yaml", "question": "q", "seeds": 1, "scores": ["tracking_rmse_deg"],
                 "controllers": ["mine"], "axes": [{"key": "glove.motion.duration_s", "values": [0.3]}]}
        (self.folder / "s.yaml").write_text(gauntlet.to_yaml(scenario))
        for call in (lambda: gauntlet.run(scenario), lambda: gauntlet.compare(scenario, seeds=2, out="out"),
                     lambda: gauntlet.tune(scenario, **tuned), lambda: gauntlet.sweep(study, out="cells")):
            self.assertIn("runs only with allow_programs=True", str(self.mistake(call)))
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["f.py", "s.yaml"])
        scores = gauntlet.run(scenario, allow_programs=True).summary("tracking_rmse_deg")
        self.assertEqual(scores["mine"], scores["none"])
        self.assertTrue((self.folder / "was_here").exists())
        self.mistake(gauntlet.run, scenario)

    def test_a_dict_is_the_same_as_the_file(self):
        scenario = {"question": "none", "seed": 3, "glove": {"motion": {"kind": "hold", "duration_s": 0.4}},
                    "controllers": {"raw": {"filter": "none"}, "kalman": {"filter": {"kind": "kalman", "q": np.float64(0.001)}}}}
        pathlib.Path("scenario.yaml").write_text(gauntlet.to_yaml(scenario))
        results = [gauntlet.run(each) for each in (scenario, gauntlet.to_yaml(scenario), "scenario.yaml")]
        self.assertEqual(len({result.json for result in results}), 1)
        self.assertEqual(results[0].controllers, ["raw", "kalman"])

    def test_traces_are_those_of_the_file_and_no_copies(self):
        import h5py
        result = gauntlet.run("hold_still", set=SHORT, out="out")
        name = result.controllers[0]
        trace = result.trace(name)
        with h5py.File("out/trace.h5") as file:
            group = file["controllers"][name] if "controllers" in file else file[name]
            found = 0
            for signal, array in trace.items():
                if signal not in group:
                    continue
                found += 1
                stored = group[signal][...]
                np.testing.assert_array_equal(array.astype(stored.dtype), stored, signal)
                self.assertEqual(array.shape[1], len(trace.names[signal]))
            self.assertGreater(found, 8)
        again = result.trace(name)["hand_angle_rad"]
        self.assertTrue(np.shares_memory(again, trace["hand_angle_rad"]))
        self.assertFalse(again.flags.writeable)
        self.assertEqual(len(trace.time_s), len(again))
        del result, trace
        self.assertTrue(np.isfinite(again).all())  # the memory lives as long as the array

    def test_tune_finds_what_the_program_finds(self):
        named = dict(set={"glove.motion.duration_s": 0.6}, seeds=2, held_out=2, evaluations=4)
        result = gauntlet.tune("random_motion", controller="tuned_kalman", free={"filter.q": "1e-5:1e-2:log"},
                               filter_only=True, **named)
        out, _ = program("tune", "random_motion", "--controller", "tuned_kalman", "--free", "filter.q=1e-5:1e-2:log",
                         "--filter-only", "--set", "glove.motion.duration_s=0.6", "--seeds", 2, "--held-out", 2,
                         "--evaluations", 4, "--json", "--out", "theirs")
        self.assertEqual(result.data, json.loads(out))
        theirs = pathlib.Path("theirs/tuned_kalman.yaml").read_text()
        self.assertTrue(theirs.endswith(result.controllers["tuned_kalman"]))
        self.assertEqual(result.settings.rows, table_of_csv(pathlib.Path("theirs/tune.csv").read_text()).rows)

    def test_sweep_finds_what_the_program_finds(self):
        study = {"question": "none", "name": "q", "scenario": "scenarios/hold_still.yaml", "set": ["glove.motion.duration_s=0.4"], "seeds": 2,
                 "physics": False, "axes": [{"key": "controllers.tuned_kalman.filter.q", "values": ["0.001", "0.01"]}]}
        pathlib.Path("study.yaml").write_text(gauntlet.to_yaml(study))
        result = gauntlet.sweep(study)
        self.assertIsNone(result.folder)
        out, _ = program("sweep", "study.yaml", "--json", "--out", "theirs")
        self.assertEqual(result.data, json.loads(out))
        self.assertEqual([list(row.values()) for row in result.cells],
                         [list(row.values()) for row in gauntlet.sweep("study.yaml", out="ours").cells])
        self.assertEqual(pathlib.Path("ours/cells.csv").read_bytes(), pathlib.Path("theirs/cells.csv").read_bytes())

    def test_identify_and_inspect_say_what_the_program_says(self):
        time_s = np.arange(600) / 100
        command = 40 + 20 * np.sin(2.1 * time_s) + 15 * np.sin(7.3 * time_s + 1) + 5 * np.sin(13 * time_s)
        answer, angle = [], command[0]
        for k in range(len(time_s)):  # 50 ms of dead time, then a lag of 60 ms
            angle += (command[max(k - 5, 0)] - angle) / 6
            answer.append(angle)
        noisy = np.round(np.array(answer) + np.random.default_rng(1).normal(0, 0.1, len(answer)), 3)
        rows = (f"{t:.2f},{c:.3f},{a:.3f}" for t, c, a in zip(time_s, command, noisy))
        pathlib.Path("log.csv").write_text("time_s,finger_command_deg,finger_deg\n" + "\n".join(rows) + "\n")
        result = gauntlet.identify("log.csv")
        out, _ = program("identify", "log.csv", "--json", "--out", "chain.yaml")
        ours, theirs = result.data, json.loads(out)
        self.assertEqual(ours.keys(), theirs.keys())
        self.assertEqual({**ours, "verdict": None}, {**theirs, "verdict": None})
        self.assertTrue(pathlib.Path("chain.yaml").read_text().endswith(result.chain_yaml))
        self.assertIn("dead_time_ms", result.chain_yaml)
        audited = gauntlet.audit("log.csv")
        self.assertEqual(audited.data, json.loads(program("audit", "log.csv", "--json")[0]))
        self.assertEqual(str(audited), program("audit", "log.csv")[0])
        self.assertIn("Largest errors", audited.page)
        recording = SOURCE / "scenarios/recordings/sign_glove/letters_v_h_r.csv"
        self.assertEqual(gauntlet.inspect(recording).data, json.loads(program("inspect", recording, "--json")[0]))
        gauntlet.run("hold_still", set=SHORT, controllers=["raw"], causes="none", out="out", mcap=True)
        topics = ["/raw/command_counts", "/raw/hand_angle_rad"]
        found = [gauntlet.inspect("out/trace.mcap", topic=topic).data for topic in topics]
        self.assertNotEqual(*found)
        for topic, ours in zip(topics, found):
            self.assertEqual(ours, json.loads(program("inspect", "out/trace.mcap", "--topic", topic, "--json")[0]))
        self.assertEqual(self.mistake(gauntlet.inspect, "out/trace.mcap", topic="a", array="b").place, "topic")


if __name__ == "__main__":
    unittest.main()
