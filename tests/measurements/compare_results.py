#!/usr/bin/python3
"""Do two programs write the same results? Runs the same commands with both and compares all JSON and CSV.

    tests/measurements/compare_results.py OLD/gauntlet build/release/sim/cli/gauntlet

run, compare, sweep, tune, robust, identify, calibrate, inspect and diff, each small, on the ready scenarios.
Of every JSON file, CSV file and --json output the same keys must be there with the same values; how the
text is laid out, and the order of keys, do not count. Prints each difference. Exit code: 0 none, 1 some.
GAUNTLET_DATA_DIR is the root of this copy for both.
"""
import csv
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
SHORT = ["--set", "glove.motion.duration_s=3"]
# What is not a result: versions and times.
SKIPPED = ("manifest.json",)


def commands(data):
    """The command lines, with what they print as the name of their output."""
    scenarios = sorted(name for name in os.listdir(os.path.join(data, "scenarios")) if name.endswith(".yaml"))
    for name in scenarios:
        yield f"run_{name}", ["run", f"scenarios/{name}", "--json", "--out", f"run_{name}"]
    for name in ("door_opening", "steps", "random_motion", "faulty_glove"):
        if name + ".yaml" in scenarios:
            yield f"compare_{name}", ["compare", f"scenarios/{name}.yaml", "--seeds", "3", "--json", "--out",
                                      f"compare_{name}", *SHORT]
    yield "sweep", ["sweep", "studies/kalman_q.yaml", "--seeds", "3", "--filter-only", "--json", "--out", "sweep"]
    tune = ["tune", "scenarios/random_motion.yaml", "--minimise", "delay_ms", "--subject-to", "jitter_rms_deg<=0.2",
            "--filter-only", "--seeds", "3", "--held-out", "3", "--evaluations", "12", "--json", *SHORT]
    yield "tune", [*tune, "--controller", "tuned_kalman", "--free", "filter.q=1e-6:10:log", "--out", "tune"]
    yield "tune_all", [*tune, "--all", "--out", "tune_all"]
    yield "robust", ["robust", "scenarios/door_opening.yaml", "--hands", "4", "--seeds", "2", "--json", "--out",
                     "robust", *SHORT]
    yield "probe", ["run", "scenarios/probe_chain.yaml", "--json", "--out", "probe"]
    yield "identify", ["identify", "probe", "--from", "target", "--json", "--out", "identify.chain.yaml"]
    yield "poses", ["run", "scenarios/known_poses.yaml", "--csv", "--json", "--out", "poses"]
    yield "calibrate", ["calibrate", "poses/trace.raw.csv", "--json", "--out", "calibration.yaml"]
    yield "inspect", ["inspect", "poses/trace.raw.csv", "--json"]
    yield "diff", ["diff", "compare_door_opening", "compare_random_motion", "--json"]


def run(program, folder):
    """{name: what was printed}"""
    environment = dict(os.environ, GAUNTLET_DATA_DIR=ROOT)
    for name in ("scenarios", "studies", "models"):
        os.symlink(os.path.join(ROOT, name), os.path.join(folder, name))
    printed = {}
    for name, words in commands(ROOT):
        result = subprocess.run([program, *words], cwd=folder, env=environment, capture_output=True, check=False)
        printed[name] = result.stdout.decode()
        if result.returncode != 0 and name != "diff":
            print(f"{name}: exit code {result.returncode}: {result.stderr.decode().strip()[-200:]}")
    return printed


def differences(old, new, place=""):
    if isinstance(old, dict) and isinstance(new, dict):
        for key in list(old) + [key for key in new if key not in old]:
            if key not in old or key not in new:
                yield f"{place}.{key}: only {'new' if key not in old else 'old'}"
            else:
                yield from differences(old[key], new[key], f"{place}.{key}")
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for i, (a, b) in enumerate(zip(old, new)):
            yield from differences(a, b, f"{place}[{i}]")
    elif old != new:
        yield f"{place}: {str(old)[:80]} != {str(new)[:80]}"


def files_of(folder):
    found = {}
    for directory, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(directory, name)
            if name.endswith((".json", ".csv")) and not name.endswith(SKIPPED) and not name.startswith("trace."):
                found[os.path.relpath(path, folder)] = path
    return found


def content(path):
    with open(path, encoding="utf-8", newline="") as file:
        return json.load(file) if path.endswith(".json") else list(csv.reader(file))


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    programs = [os.path.abspath(path) for path in sys.argv[1:]]
    found = 0
    compared = 0
    with tempfile.TemporaryDirectory() as old, tempfile.TemporaryDirectory() as new:
        printed = [run(program, folder) for program, folder in zip(programs, (old, new))]
        for name in printed[0]:
            texts = [outputs[name].replace(folder, "FOLDER") for outputs, folder in zip(printed, (old, new))]
            parsed = [json.loads(text) if text else None for text in texts]
            compared += 1
            for line in differences(*parsed):
                found += 1
                print(f"{name} --json{line}")
        files = [files_of(folder) for folder in (old, new)]
        for name in sorted(set(files[0]) | set(files[1])):
            if name not in files[0] or name not in files[1]:
                found += 1
                print(f"{name}: only {'new' if name in files[1] else 'old'}")
                continue
            compared += 1
            for line in differences(content(files[0][name]), content(files[1][name])):
                found += 1
                print(f"{name}{line}")
    print(f"{compared} results compared, {found} differences")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
