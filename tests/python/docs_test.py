"""The Python of docs/how-to/python.md and of the notebook runs, and prints what the page shows."""
import contextlib
import io
import json
import re
import unittest

import gauntlet
from support import SOURCE, Test, program

PAGE = SOURCE / "docs/how-to/python.md"
NOTEBOOK = SOURCE / "docs/how-to/compare-filters.ipynb"


def printed(code, names):
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        exec(compile(code, "example", "exec"), names)
    return [line.rstrip() for line in text.getvalue().strip("\n").split("\n")]


def export_robot():
    program("run", "hold_still", "--set", "glove.motion.duration_s=0.2", "--causes", "none", "--out", "out")
    program("export", "out", "--controller", "raw", "--out", "robot.yaml")


class Docs(Test):
    def test_three_lines_of_the_controllers_readme_drive_a_robot(self):
        lines, = re.findall(r"```python\n(.*?)```", (SOURCE / "controller/README.md").read_text(), re.S)
        self.assertEqual(lines.count("\n"), 3)
        export_robot()
        names = {"gauntlet": gauntlet, "motor_counts": [2048] * 18, "counts": [400.0] * 18}
        exec(lines, names)
        self.assertTrue(names["controller"].event)
        self.assertNotEqual(list(names["motor_counts"]), [2048] * 18)

    def test_examples_of_the_page_print_what_stands_below_them(self):
        blocks = re.findall(r"```python\n(.*?)```(?:\n+```text\n(.*?)```)?", PAGE.read_text(), re.S)
        self.assertGreater(len(blocks), 5)
        export_robot()
        names = {}
        for code, expected in blocks:
            shown = printed(code, names)
            if expected:
                self.assertEqual(shown, expected.strip("\n").split("\n"), code)

    def test_cells_of_the_notebook_run_in_their_order(self):
        notebook = json.loads(NOTEBOOK.read_text())
        self.assertEqual(notebook["nbformat"], 4)
        cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
        self.assertGreater(len(cells), 4)
        names = {}
        for code in cells:
            lines = code.rstrip().split("\n")
            printed("\n".join(lines[:-1]), names)
            try:  # the last line of a cell is shown
                shown = eval(compile(lines[-1], "cell", "eval"), names)
            except SyntaxError:
                printed(lines[-1], names)
                continue
            self.assertTrue(repr(shown) if not hasattr(shown, "_repr_html_") else shown._repr_html_())


if __name__ == "__main__":
    unittest.main()
