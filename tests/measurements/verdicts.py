#!/usr/bin/env python3
"""Verdicts of the ready scenarios as a table of Markdown.

    tests/measurements/verdicts.py GAUNTLET > docs/evidence/verdicts.md
    tests/measurements/verdicts.py GAUNTLET --check docs/evidence/verdicts.md SCENARIO...

The first runs `gauntlet compare` with 8 seeds (recordings: one seed each) for every scenario in scenarios/.
The second runs some of them and fails where a row of the table differs.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
HEAD = """# Verdicts of the ready scenarios

`tests/measurements/verdicts.py` makes this table. Every row is the verdict of `gauntlet compare SCENARIO`: the
sentences that the program prints, with the priority tracking error.

| scenario | recommended | verdict |
|---|---|---|
"""


def row(gauntlet, scenario):
    with tempfile.TemporaryDirectory() as folder:
        answer = subprocess.run(
            [gauntlet, "compare", str(ROOT / "scenarios" / f"{scenario}.yaml"), "--json", "--causes", "none",
             "--out", f"{folder}/out"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if answer.returncode == 2 and "has the curves of one glove" in answer.stderr:  # a question of one run
        return f"| {scenario} | none | Not for `compare`: one glove, which other seeds do not have. |\n"
    if answer.returncode not in (0, 1) or not answer.stdout:
        sys.exit(f"{scenario}: {answer.stderr}")
    verdict = json.loads(answer.stdout)["verdict"]
    text = " ".join(remark["text"] for remark in verdict["reasons"])
    return f"| {scenario} | {verdict['recommended'] or 'none'} | {text} |\n"


def main():
    gauntlet, *rest = sys.argv[1:]
    scenarios = sorted(path.stem for path in (ROOT / "scenarios").glob("*.yaml"))
    if not rest:
        sys.stdout.write(HEAD)
        for scenario in scenarios:
            sys.stdout.write(row(gauntlet, scenario))
            sys.stdout.flush()
        return
    table = pathlib.Path(rest[1]).read_text()
    wrong = [found for found in (row(gauntlet, scenario) for scenario in rest[2:]) if found not in table]
    if missing := [name for name in scenarios if f"\n| {name} | " not in table]:
        sys.exit("no row for: " + ", ".join(missing))
    sys.exit("".join(["not in the table:\n", *wrong]) if wrong else 0)


if __name__ == "__main__":
    main()
