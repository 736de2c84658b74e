#!/usr/bin/env python3
"""Writes the tables of docs/evidence/mujoco-versions.md: scores of the ready scenarios with several MuJoCos.

    tests/measurements/mujoco_versions.py FOLDER GAUNTLET GAUNTLET...

The first GAUNTLET is the reference, the others are built with GAUNTLET_MUJOCO. Runs are kept in FOLDER: name a new
one for other programs.
"""
import csv
import math
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/evidence/mujoco-versions.md"
MAIN = {"tracking_rmse_deg": "tracking error [deg]", "delay_ms": "delay [ms]", "jitter_rms_deg": "jitter [deg]"}
GRIP = {"grip_force_ripple_n": "grip ripple [N]", "object_slip_mm": "slip [mm]"}
CONTACT = "grasp_bottle"

SETTINGS = "parts/settings.xml"
NO_STOP = (SETTINGS, 'iterations="20" tolerance="1e-9"', 'iterations="200" tolerance="1e-16"')
NO_WARM_START = (SETTINGS, '<flag contact="disable"', '<flag contact="disable" warmstart="disable"')
NO_CONSTRAINT = (SETTINGS, '<flag contact="disable"', '<flag contact="disable" constraint="disable"')
SPHERE = ("parts/object.xml", 'name="object_foot" type="box" size="0.0155 0.0155 0.004"',
          'name="object_foot" type="sphere" size="0.004"')
# Changes of the model, one at a time or together: scenario, model, name, replacements.
CAUSES = [
    ("grasp_precision", "hand_arm.xml", "as it is", []),
    ("grasp_precision", "hand_arm.xml", "no constraints", [NO_CONSTRAINT]),
    ("grasp_precision", "hand_arm.xml", "tolerance 1e-16", [NO_STOP]),
    (CONTACT, "hand_arm_object.xml", "as it is", []),
    (CONTACT, "hand_arm_object.xml", "no warm start", [NO_WARM_START]),
    (CONTACT, "hand_arm_object.xml", "tolerance 1e-16", [NO_STOP]),
    (CONTACT, "hand_arm_object.xml", "tolerance 1e-16, sphere under the bottle", [NO_STOP, SPHERE]),
]


def first_controllers(scenario):
    """Names of the first two controllers of a ready scenario."""
    text = (ROOT / f"scenarios/{scenario}.yaml").read_text().split("\ncontrollers:\n")[1]
    return re.findall(r"^  (\w+):", text, re.MULTILINE)[:2]


def run(gauntlet, name, scenario, folder, *settings):
    """The folder of a finished run."""
    out = folder / name / scenario
    if not (out / "manifest.json").exists():
        shutil.rmtree(out, ignore_errors=True)
        out.parent.mkdir(parents=True, exist_ok=True)
        answer = subprocess.run([gauntlet, "run", scenario, "--causes", "none", "--controllers",
                                 ",".join(first_controllers(scenario)), "--out", str(out), *settings],
                                cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
        if answer.returncode not in (0, 1):
            sys.exit(f"{gauntlet} {scenario}: {answer.stderr}")
    return out


def version_of(out):
    found = re.search(r'mujoco_version: "(.*)"', (out / "scenario.resolved.yaml").read_text())
    return found.group(1)


def scores_of(out):
    """Scores of the hand by controller and name."""
    controllers = first_controllers(out.name)
    with open(out / "scores.csv", newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["channel"] == "summary" and row["controller"] in controllers]
    return {(row["controller"], name): float(value)
            for row in rows for name, value in row.items()
            if name not in ("seed", "controller", "channel") and value and math.isfinite(float(value))}


def differences(reference, other):
    """Absolute differences by controller and name, of what both have."""
    return {key: abs(other[key] - value) for key, value in reference.items() if key in other}


def number(value):
    return "0" if value == 0.0 else f"{value:.2g}"


def largest(difference, name):
    found = [value for (_, score), value in difference.items() if score == name]
    return number(max(found)) if found else "-"


def changed_model(folder, name, changes):
    """A copy of models/ with the replacements."""
    copy = folder / "models" / re.sub(r"\W+", "_", name)
    if not copy.exists():
        shutil.copytree(ROOT / "models", copy)
        for file, old, new in changes:
            text = (copy / file).read_text()
            if old not in text:
                sys.exit(f"models/{file} has no longer: {old}")
            (copy / file).write_text(text.replace(old, new))
    return copy


def by_scenario(versions, scores):
    lines = ["| scenario | " + " | ".join(f"{text}, {version}" for version in versions[1:] for text in MAIN.values()),
             "|---|" + "---|" * (len(MAIN) * (len(versions) - 1))]
    for scenario, of_version in scores.items():
        reference = of_version[versions[0]]
        cells = [largest(differences(reference, of_version[version]), name)
                 for version in versions[1:] for name in MAIN]
        lines.append(f"| {scenario} | " + " | ".join(cells) + " |")
    lines[0] += " |"
    return lines


def by_score(versions, scores):
    """For each score the scenario and controller in which it differs most, without contacts."""
    names = {}
    for scenario, of_version in scores.items():
        if scenario == CONTACT:
            continue
        reference = of_version[versions[0]]
        for version in versions[1:]:
            for key, value in differences(reference, of_version[version]).items():
                best = names.setdefault(key[1], {}).get(version, (-1.0,))
                if value > best[0]:
                    names[key[1]][version] = (value, reference[key], of_version[version][key], scenario, key[0])
    lines = ["| score | " + " | ".join(f"{versions[0]} | {version} | where" for version in versions[1:]) + " |",
             "|---|" + "---|---|---|" * (len(versions) - 1)]
    for name, of_version in names.items():
        cells = []
        for version in versions[1:]:
            value, before, after, scenario, controller = of_version[version]
            cells += ["=", "=", ""] if value <= 1e-9 * abs(before) else \
                [f"{before:.5g}", f"{after:.5g}", f"{scenario}, {controller}"]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return lines


def contact_table(versions, of_version):
    names = {**MAIN, **GRIP}
    controllers = list(dict.fromkeys(controller for controller, _ in of_version[versions[0]]))
    lines = ["| controller | MuJoCo | " + " | ".join(names.values()) + " |", "|---|---|" + "---|" * len(names)]
    for controller in controllers:
        for version in versions:
            cells = [f"{of_version[version].get((controller, name), math.nan):.3g}" for name in names]
            lines.append(f"| {controller} | {version} | " + " | ".join(cells) + " |")
    return lines


def causes_table(gauntlets, versions, folder):
    lines = ["| scenario, raw | model | " + " | ".join(f"{versions[0]} to {version}" for version in versions[1:]) + " |",
             "|---|---|" + "---|" * (len(versions) - 1)]
    for number_of_cause, (scenario, model, name, changes) in enumerate(CAUSES):
        copy = changed_model(folder, f"{number_of_cause} {name}", changes)
        scores = [scores_of(run(gauntlet, f"cause_{number_of_cause}_{version}", scenario, folder,
                                "--set", f"hand.model_path={copy / model}"))
                  for gauntlet, version in zip(gauntlets, versions)]
        cells = [number(differences(scores[0], other)["raw", "tracking_rmse_deg"]) for other in scores[1:]]
        lines.append(f"| {scenario} | {name} | " + " | ".join(cells) + " |")
    return lines


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    gauntlets = sys.argv[2:]
    scenarios = sorted(path.stem for path in (ROOT / "scenarios").glob("*.yaml"))
    scores = {}
    versions = []
    for scenario in scenarios:
        outs = [run(gauntlet, f"program_{place}", scenario, folder) for place, gauntlet in enumerate(gauntlets)]
        versions = [version_of(out) for out in outs]
        scores[scenario] = {version: scores_of(out) for version, out in zip(versions, outs)}
    tables = {"scenarios": by_scenario(versions, scores), "scores": by_score(versions, scores),
              "contact": contact_table(versions, scores[CONTACT]),
              "causes": causes_table(gauntlets, versions, folder)}
    text = PAGE.read_text()
    for name, lines in tables.items():
        begin, end = f"<!-- table: {name} -->\n", "<!-- end of table -->\n"
        before, rest = text.split(begin)
        text = before + begin + "\n" + "\n".join(lines) + "\n\n" + end + rest.split(end, 1)[1]
    PAGE.write_text(text)


if __name__ == "__main__":
    main()
