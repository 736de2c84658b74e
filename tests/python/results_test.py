import html.parser
import json
import pathlib
import sys
import types
import unittest
import unittest.mock
import xml.etree.ElementTree

import numpy as np

import gauntlet
from support import SHORT, Test, program


class Results(Test):
    @classmethod
    def setUpClass(cls):
        import warnings
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", gauntlet.Remark)
            cls.result = gauntlet.compare("hold_still", set=SHORT, seeds=3)

    def test_the_text_is_that_of_the_terminal(self):
        out, _ = program("compare", "hold_still", "--set", "glove.motion.duration_s=0.5", "--seeds", 3)
        squeezed = lambda text: " ".join(text.split())
        self.assertEqual(squeezed(str(self.result)), squeezed(out))

    def test_scores_have_a_row_per_seed_controller_and_part(self):
        rows = self.result.scores
        self.assertEqual({row["seed"] for row in rows}, {1, 2, 3})
        self.assertEqual({row["controller"] for row in rows}, set(self.result.controllers))
        of_raw = [row["tracking_rmse_deg"] for row in rows if row["controller"] == "raw" and row["channel"] == "summary"]
        self.assertAlmostEqual(sum(of_raw) / 3, self.result.summary("tracking_rmse_deg")["raw"], places=9)

    def test_tables_are_rows_with_the_names_of_files(self):
        table = self.result.table
        self.assertEqual([row["name"] for row in table if row["name"]], [row["name"] for row in table.rows])
        self.assertIn("tracking_rmse_deg", table[0])
        heading = {column.key: (column.heading, column.unit) for column in table.columns}
        self.assertTrue(heading["tracking_rmse_deg"][0])
        self.assertEqual(len(table), len(self.result.controllers))

    def test_html_is_whole(self):
        class Tags(html.parser.HTMLParser):
            def __init__(self):
                super().__init__()
                self.open, self.wrong, self.tables = [], [], 0

            def handle_starttag(self, tag, attributes):
                self.tables += tag == "table"
                if tag not in ("br", "col", "img"):
                    self.open.append(tag)

            def handle_endtag(self, tag):
                if not self.open or self.open.pop() != tag:
                    self.wrong.append(tag)

        for shown, least in ((self.result, 1), (self.result.table, 1), (self.result.scores, 1)):
            tags = Tags()
            tags.feed(shown._repr_html_())
            self.assertEqual((tags.open, tags.wrong), ([], []))
            self.assertGreaterEqual(tags.tables, least)
            self.assertNotIn("<script", shown._repr_html_())

    def test_pandas_gets_the_rows(self):
        class DataFrame:
            def __init__(self, columns):
                self.columns = columns

        before = sys.modules.get("pandas")
        sys.modules["pandas"] = types.SimpleNamespace(DataFrame=DataFrame)
        try:
            frame = self.result.scores.to_pandas()
        finally:
            sys.modules.pop("pandas")
            if before is not None:
                sys.modules["pandas"] = before
        self.assertEqual(list(frame.columns)[:3], ["seed", "controller", "channel"])
        rows = self.result.scores.rows
        for name, values in frame.columns.items():
            self.assertEqual([None if value != value else value for value in values], [row[name] for row in rows])
        try:
            import pandas
        except ImportError:
            return
        real = self.result.scores.to_pandas()
        self.assertEqual(real.shape, (len(rows), len(frame.columns)))
        self.assertEqual(str(real["tracking_rmse_deg"].dtype), "float64")

    def test_xarray_gets_signals_with_their_times_and_names(self):
        result = gauntlet.run("hold_still", set={"glove.motion.duration_s": 0.2, "glove.rate_hz": 500}, causes="none")
        datasets = []
        fake = types.SimpleNamespace(Dataset=lambda variables, coordinates: (variables, coordinates))
        with unittest.mock.patch.dict(sys.modules, {"xarray": fake}):
            for signals in (result.trace("raw"), result.glove):
                variables, coordinates = signals.to_xarray()
                self.assertEqual(set(variables), set(signals))
                for name, (dimensions, array, attributes) in variables.items():
                    self.assertIs(array, signals[name])
                    self.assertEqual(array.shape, tuple(len(coordinates[each]) for each in dimensions), name)
                    self.assertEqual(list(coordinates[dimensions[1]]), signals.names[name])
                    self.assertEqual(attributes, {"units": signals.units[name]})
                datasets.append((variables, coordinates))
        (trace, _), (glove, coordinates) = datasets
        self.assertEqual(trace["hand_angle_rad"][0], ("time_s", "joint"))
        self.assertEqual(glove["counts"][0], ("sample_time_s", "channel"))
        self.assertEqual(list(coordinates["sample_time_s"][:3]), [0, 0.002, 0.004])
        try:
            import xarray
        except ImportError:
            return
        self.assertEqual(result.trace("raw").to_xarray().hand_angle_rad.sel(joint="index_mcp").shape, (200,))

    def test_lerobot_gets_an_episode_for_each_controller(self):
        result = gauntlet.run("hold_still", controllers=["raw", "mean_20"], set={"glove.motion.duration_s": 0.4}, causes="none")

        class Frame(dict):
            def __init__(self, values, index=None):
                super().__init__(values if isinstance(values, dict) else {"rows": values})

            def to_parquet(self, file, index=True):
                file.write_text(",".join(self))

        fake = types.SimpleNamespace(DataFrame=Frame, concat=lambda frames, ignore_index: frames[0])
        with unittest.mock.patch.dict(sys.modules, {"pandas": fake}):
            result.to_lerobot("fake/data", fps=100)
        folder = pathlib.Path("fake/data")
        info, stats = (json.loads((folder / f"meta/{name}.json").read_text()) for name in ("info", "stats"))
        self.assertEqual((info["fps"], info["total_episodes"], info["total_frames"]), (100, 2, 80))
        trace = result.trace("raw")
        for key, signal in (("action", "target_angle_rad"), ("observation.state", "hand_angle_rad")):
            self.assertEqual(info["features"][key]["names"], [name + "_rad" for name in trace.names[signal]])
            both = np.concatenate([result.trace(name)[signal][::10].astype(np.float32) for name in result.controllers])
            np.testing.assert_allclose(stats[key]["mean"], both.astype(float).mean(0))
            self.assertEqual(stats[key]["count"], [80])
        self.assertEqual((folder / "data/chunk-000/file-000.parquet").read_text().split(",")[:3],
                         ["action", "observation.state", "timestamp"])
        for arguments, problem in (({"fps": 30}, "fps: is 30, must be 1 or more and divide the 1000 ticks per second"),
                                   ({"fps": 0}, "fps: is 0, must be"), ({"controllers": ["non"]}, "controllers: 'non' is unknown"),
                                   ({"controllers": []}, "controllers: is empty")):
            with self.assertRaisesRegex(gauntlet.SettingError, problem):
                result.to_lerobot("new", **arguments)
        with self.assertRaisesRegex(gauntlet.SettingError, "folder: fake/data exists; a data set needs a new folder"):
            result.to_lerobot("fake/data")
        self.assertEqual([path.name for path in pathlib.Path("fake").iterdir()], ["data"])
        try:
            import pandas
            import pyarrow
        except ImportError:
            return
        result.to_lerobot("real", fps=100)
        rows = pandas.read_parquet("real/data/chunk-000/file-000.parquet")
        second = np.stack(rows["observation.state"][rows["episode_index"] == 1])
        np.testing.assert_array_equal(second, result.trace("mean_20")["hand_angle_rad"][::10].astype(np.float32))
        self.assertEqual(pandas.read_parquet("real/meta/tasks.parquet")["task_index"].to_dict(), {"raw": 0, "mean_20": 1})
        self.assertEqual(gauntlet.audit("real").data["episodes"], 2)

    def test_the_figure_is_a_picture_with_all_controllers(self):
        self.assertIsNone(self.result.figure)  # a hand at rest has no delay
        moving = gauntlet.compare("random_motion", set={"glove.motion.duration_s": 2}, seeds=2, causes="none",
                                  controllers=["raw", "mean_20"])
        root = xml.etree.ElementTree.fromstring(moving.figure.svg)
        self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
        texts = [element.text or "" for element in root.iter("{http://www.w3.org/2000/svg}text")]
        for name in moving.controllers:
            self.assertTrue(any(text.startswith(name) for text in texts), texts)
        self.assertIn("data:image/svg+xml;base64,", moving._repr_html_())

    def test_the_verdict_is_that_of_the_json(self):
        self.assertEqual(self.result.verdict, self.result.data["verdict"])
        self.assertIn("recommended", self.result.verdict)


if __name__ == "__main__":
    unittest.main()
