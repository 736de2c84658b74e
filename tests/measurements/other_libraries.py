#!/usr/bin/env python3
"""Filters as other libraries compute them from the lines of `gauntlet export --for`, beside `gauntlet filter`.

    tests/measurements/other_libraries.py GAUNTLET FOLDER > docs/reference/other-libraries.md
    tests/measurements/other_libraries.py GAUNTLET FOLDER --check docs/reference/other-libraries.md
    tests/measurements/other_libraries.py GAUNTLET --here c scipy

The first two install the pinned packages (PyPI, npm) in FOLDER, if they are not there, run all filters and make the page,
or fail where it is not current. The last uses what this machine has (a C compiler, this Python's scipy), and fails where
a number differs from Gauntlet's by more than 1e-9 deg.

The recording is a finger in deg: swings, steps, noise, stretches without samples. Its first column is without times, at
50 Hz; for libraries that take times it is run once more with times that jitter by 3 ms.
"""
import argparse
import json
import math
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

RATE_HZ, SAMPLES, SAME_DEG = 50, 1000, 1e-9
# Name of a controller, kind, settings for a signal in rad.
FILTERS = [
    ("one_euro", "one_euro", {"min_cutoff_hz": 1.1, "beta": 0.6}),
    ("one_euro_raw", "one_euro", {"min_cutoff_hz": 1.1, "beta": 0.6, "speed_from": "raw"}),
    ("exponential", "exponential", {"alpha": 0.23}),
    ("butterworth", "butterworth", {"order": 2, "cutoff_hz": 3.7}),
    ("butterworth_5", "butterworth", {"order": 5, "cutoff_hz": 6}),
    ("moving_average", "moving_average", {"window": 7}),
    ("savitzky_golay", "savitzky_golay", {"window": 9, "order": 2}),
    ("alpha_beta", "alpha_beta", {"alpha": 0.3, "beta": 0.05}),
    ("alpha_beta_gamma", "alpha_beta_gamma", {"alpha": 0.3, "beta": 0.05, "gamma": 0.001}),
    ("kalman", "kalman", {"r": 0.01, "q": 2e-5}),
    ("kalman_3", "kalman", {"r": 0.01, "q": 2.0, "process_noise": "white", "states": 3}),
    ("kalman_steady", "kalman_steady", {"r": 0.01, "q": 1e-6, "states": 3}),
]
LIBRARIES = ["oneeurofilter", "1eurofilter", "mediapipe", "dex-retargeting", "scipy", "filterpy", "lerobot", "c", "javascript"]
# Programs that no registry has: their formula, that of dex-retargeting, was read in their source.
READ = ["open-television", "wuji-retargeting"]
PYPI = {"oneeurofilter": ["OneEuroFilter==0.2.1"], "mediapipe": ["mediapipe==0.10.21"], "scipy": ["scipy==1.17.1", "numpy==2.4.6"],
        "dex-retargeting": ["--no-deps", "dex-retargeting==0.5.0", "numpy==2.4.6"],
        "filterpy": ["filterpy==2.0.0", "scipy==1.17.1", "numpy==2.4.6"],
        "lerobot": ["numpy==1.26.4", "huggingface_hub==0.36.0", "safetensors==0.7.0"]}
# Without what else it needs: PyTorch, as Debian has it for the processor alone.
PYPI_ALONE = {"lerobot": ["lerobot==0.4.4"]}
DEBIAN = {"lerobot": "python3-torch"}
NPM = "1eurofilter@1.3.0"
# Reasons of differences above SAME_DEG.
REASONS = {"mediapipe": "landmarks are floats of 24 bits"}

PYTHON = """import json, sys
samples, times_s = json.load(sys.stdin)
{lines}
{run}
json.dump([float(x) for x in filtered], sys.stdout)
"""
RUNS = {
    "": "filtered = smooth(samples)",
    "oneeurofilter with times": "filtered = [one_euro(x, t) for x, t in zip(samples, times_s)]",
    # Its __init__ imports PyTorch, which the filter does not use.
    "dex-retargeting": """import importlib.metadata, importlib.util, numpy as np
file = importlib.metadata.distribution("dex-retargeting").locate_file("dex_retargeting/optimizer_utils.py")
spec = importlib.util.spec_from_file_location("optimizer_utils", file)
module = importlib.util.module_from_spec(spec)
spec.loader.exec_module(module)
low_pass = module.LPFilter({alpha})
filtered = [low_pass.next(np.array([x]))[0] for x in samples]""",
    # Its __init__ imports the steps for images and tokens, with all that these need.
    "lerobot": """import math
pipeline = RobotProcessorPipeline([SmoothAction(["index.pos"])], to_transition=robot_action_to_transition,
                                  to_output=transition_to_robot_action)
filtered = [pipeline({{"index.pos": x if x is not None else math.nan, "wrist.pos": 1.0}})["index.pos"] for x in samples]""",
    "mediapipe": '''import mediapipe as mp
from mediapipe.framework.formats import landmark_pb2
graph = mp.CalculatorGraph(graph_config="""
input_stream: "landmarks"
output_stream: "smoothed"
node {{
  calculator: "LandmarksSmoothingCalculator"
  input_stream: "LANDMARKS:landmarks"
  output_stream: "FILTERED_LANDMARKS:smoothed"
  options {{ [mediapipe.LandmarksSmoothingCalculatorOptions.ext] {{ {options} }} }}
}}""")
filtered = []
graph.observe_output_stream("smoothed", lambda _, packet: filtered.append(mp.packet_getter.get_proto(packet).landmark[0].x))
graph.start_run()
for x, t in zip(samples, times_s):
    landmarks = landmark_pb2.LandmarkList()
    landmarks.landmark.add(x=x, y=0, z=0)
    graph.add_packet_to_input_stream("landmarks", mp.packet_creator.create_proto(landmarks).at(round(t * 1e6)))
graph.close_all_packet_sources()
graph.wait_until_done()''',
}
LEROBOT_HEAD = """import importlib.metadata, os, sys, types
sys.path += os.environ["DEBIAN_PYTHON"].split(":")
package = types.ModuleType("lerobot.processor")
package.__path__ = [str(importlib.metadata.distribution("lerobot").locate_file("lerobot/processor"))]
sys.modules[package.__name__] = package
from lerobot.processor.converters import robot_action_to_transition, transition_to_robot_action
from lerobot.processor.pipeline import ProcessorStepRegistry, RobotActionProcessorStep, RobotProcessorPipeline
package.ProcessorStepRegistry, package.RobotActionProcessorStep = ProcessorStepRegistry, RobotActionProcessorStep
"""
C_MAIN = """
#include <stdio.h>
int main(void) {
  Smoother s = {0};
  for (double x; scanf("%lf", &x) == 1;) printf("%.17g\\n", smooth(&s, x));
}
"""
JS_MAIN = """
const [samples, times] = JSON.parse(require("fs").readFileSync(0)).map((row) => row.map((x) => (x === null ? NaN : x)));
console.log(JSON.stringify(%s));
"""


def recording():
    """Angles in deg, NaN where missing, and jittered times in s."""
    chance = random.Random(70)
    angles, times_s = [], []
    for i in range(SAMPLES):
        t = i / RATE_HZ
        angle = 45 + 25 * math.sin(2 * math.pi * 0.4 * t) + (20 if int(t / 1.7) % 2 else -20) + chance.gauss(0, 0.8)
        angles.append(math.nan if i % 97 in range(60, 66) or i % 13 == 5 else round(angle, 3))
        times_s.append(round(1 + t + chance.uniform(-0.003, 0.003), 6))
    return angles, times_s


def held(angles):
    """The last good sample in place of a missing one."""
    filled = []
    for angle in angles:
        filled.append(filled[-1] if math.isnan(angle) else angle)
    return filled


def run(command, text="", **options):
    result = subprocess.run(command, input=text, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False, **options)
    if result.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: {result.stderr[-2000:]}")
    return result.stdout


def ours(gauntlet, kind, settings, angles):
    """In deg, through a signal in rad."""
    sets = [part for key, value in settings.items() for part in ("--set", f"{key}={value}")]
    rows = "x\n" + "".join("nan\n" if math.isnan(a) else f"{math.radians(a)!r}\n" for a in angles)
    text = run([gauntlet, "filter", kind, "--set", f"rate_hz={RATE_HZ}", *sets], rows)
    return [math.degrees(float(line)) for line in text.split()[1:]]


def make_controllers(gauntlet, folder):
    """The output folder of a run with one controller for each filter."""
    controllers = "".join(f"  {name}: {{filter_on: angle, filter: {json.dumps({'kind': kind, **settings})}}}\n"
                          for name, kind, settings in FILTERS)
    (folder / "filters.yaml").write_text(
        f"question: Do other libraries compute the same?\nglove:\n  rate_hz: {RATE_HZ}\n  channels: [index_mcp]\n"
        f"  motion: {{kind: hold, duration_s: 1}}\ncontrollers:\n{controllers}")
    run([gauntlet, "run", "filters.yaml", "--out", "out", "--causes", "none"], cwd=folder)


def lines_of(gauntlet, folder, controller, library):
    """Comments and code of an export, or none."""
    result = subprocess.run([gauntlet, "export", folder / "out", "--controller", controller, "--for", library, "--exact"],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if result.returncode == 2 and "has no" in result.stderr:
        return None
    if result.returncode != 0:
        sys.exit(result.stderr)
    rows = result.stdout.split("\n")
    head = next(i for i, row in enumerate(rows) if not row.startswith(("# ", "// ")))
    return [row.lstrip("#/ ") for row in rows[:head]], "\n".join(rows[head:])


def unpack_debian(package, place):
    """A package and what it needs beyond this machine's, without installing them."""
    place.mkdir(exist_ok=True)
    plan = run(["apt-get", "install", "--simulate", "--no-install-recommends", package])
    names = [line.split()[1] for line in plan.splitlines() if line.startswith("Inst ")]
    if names:
        run(["apt-get", "download", *names], cwd=place)
    for archive in place.glob("*.deb"):
        run(["dpkg", "-x", archive, place / "root"])


def of_debian(place):
    """The environment in which Python finds what unpack_debian() unpacked."""
    folders = {str(file.parent) for file in (place / "root/usr/lib").rglob("lib*.so*") if "python3" not in str(file)}
    return {**os.environ, "LD_LIBRARY_PATH": ":".join(sorted(folders)),
            "DEBIAN_PYTHON": ":".join([str(place / "root/usr/lib/python3/dist-packages"), "/usr/lib/python3/dist-packages"])}


class Machine:
    """Runs lines: with what is installed in a folder, or here."""

    def __init__(self, folder, work):
        self.folder, self.work = folder, work

    def python(self, library):
        if self.folder is None:
            return sys.executable
        place = self.folder / library
        if not (place / "ready").exists():
            run([sys.executable, "-m", "venv", "--clear", place])
            pip = [place / "bin/pip", "-q", "--disable-pip-version-check", "install"]
            run([*pip, *PYPI[library]])
            if library in PYPI_ALONE:
                run([*pip, "--no-deps", *PYPI_ALONE[library]])
            if library in DEBIAN:
                unpack_debian(DEBIAN[library], place / "debian")
            (place / "ready").touch()
        return place / "bin/python"

    def filtered(self, library, code, angles, times_s, with_times=False):
        filled = held(angles)
        if library == "c":
            (self.work / "smooth.c").write_text(code + C_MAIN)
            run(["cc", "-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-o", "smooth", "smooth.c", "-lm"], cwd=self.work)
            return [float(x) for x in run([self.work / "smooth"], "\n".join(map(str, angles))).split()]
        if library in ("javascript", "1eurofilter"):
            call = {"javascript": "samples.map(makeSmoother())", "1eurofilter": "smooth(samples)"}[library]
            if library == "1eurofilter":
                npm = self.folder / "npm"
                if not (npm / "node_modules/1eurofilter").exists():
                    npm.mkdir(exist_ok=True)
                    run(["npm", "install", "--loglevel=error", "--no-audit", "--no-fund", "--no-save", "--prefix", ".", NPM], cwd=npm)
                code = code.replace('require("1eurofilter")', f"require({json.dumps(str(npm / 'node_modules/1eurofilter'))})")
            if with_times:
                call = "samples.map((x, i) => oneEuro.filter(x, times[i]))"
            values = [None if math.isnan(x) else x for x in (angles if library == "javascript" else filled)]
            (self.work / "smooth.js").write_text(code + JS_MAIN % call)
            return json.loads(run(["node", self.work / "smooth.js"], json.dumps([values, times_s])))
        how = RUNS.get(library + (" with times" if with_times else ""), RUNS.get(library, RUNS[""]))
        if library == "dex-retargeting":
            how, code = how.format(alpha=re.search(r"low_pass_alpha: (\S+)", code)[1]), ""
        if library == "mediapipe":
            how, code = how.format(options=" ".join(code.split())), ""
        python, environment = self.python(library), None
        if library == "lerobot":
            how, code = how.format(), LEROBOT_HEAD + code
            filled = [None if math.isnan(x) else x for x in angles]
            environment = of_debian(self.folder / library / "debian")
        (self.work / "smooth.py").write_text(PYTHON.format(lines=code, run=how))
        return json.loads(run([python, self.work / "smooth.py"], json.dumps([filled, times_s]), env=environment))



def largest(one, other):
    if len(one) != len(other):
        sys.exit(f"{len(one)} and {len(other)} samples")
    return max(abs(a - b) for a, b in zip(one, other))


def measure(gauntlet, machine, work, libraries):
    """A row for each filter that a library has, and the comments of each library."""
    make_controllers(gauntlet, work)
    angles, times_s = recording()
    regular_s = [1 + i / RATE_HZ for i in range(SAMPLES)]
    rows, notes = [], {}
    for library in libraries:
        for name, kind, settings in FILTERS:
            lines = lines_of(gauntlet, work, name, library)
            if lines is None:
                continue
            comments, code = lines
            notes[library] = " ".join(comments)
            reference = ours(gauntlet, kind, settings, angles)
            difference = largest(reference, machine.filtered(library, code, angles, regular_s))
            with_times = None
            if library in ("oneeurofilter", "1eurofilter", "mediapipe"):
                with_times = largest(reference, machine.filtered(library, code, angles, times_s, with_times=True))
            rows.append((library, name, difference, with_times))
    if libraries == LIBRARIES:
        for library in READ:
            notes[library] = " ".join(lines_of(gauntlet, work, "exponential", library)[0])
    return rows, notes


def number(difference):
    return "below 1e-9" if difference <= SAME_DEG else f"{difference:.1g}"


def table(heads, rows):
    return "".join("| " + " | ".join(line) + " |\n" for line in [heads, ["---"] * len(heads), *rows])


def page(rows, notes):
    text = """# Your filter in other libraries

<!-- Written by tests/measurements/other_libraries.py. Do not edit. -->

`gauntlet export FOLDER --controller NAME --for LIBRARY` prints a tuned filter as lines of a library or a language. The
folder is that of `run` or `compare`. The lines are for a signal in deg (`--unit`), at the rate of the scenario.

From a recording to the line of your script:

<!-- not run: needs a recording -->
```sh
gauntlet inspect my_hand.csv --write-scenario my_hand.yaml
gauntlet compare my_hand.yaml
gauntlet export out/my_hand --controller one_euro --for oneeurofilter
```

If the library does not have the filter, the closest that it has is tuned in its place: the one with the least tracking
error among those with about the jitter of your filter. The first comment says which, and what it costs: its scores
beside those of your filter, over the same seeds, which are not those of the search. The command first says how long the
search takes, if that is more than 5 s. With `--exact` it fails instead, and names the libraries that have the filter.

## Filters by library

The numbers are the largest difference from Gauntlet in deg. Empty: the library does not have the filter. The recording has 1000 samples of a finger at 50 Hz with swings, steps of 40 deg, noise, and stretches without
samples. Its times are regular. It runs once more with times that jitter by 3 ms in the libraries that take times: Gauntlet has one
rate.

"""
    chosen = {name: ", ".join(f"`{key}: {value}`" for key, value in settings.items() if key in ("speed_from", "order", "states"))
              for name, _, settings in FILTERS}
    of = {(library, name): number(difference) for library, name, difference, _ in rows}
    text += table(["filter", *LIBRARIES], [[f"`{kind}`" + (chosen[name] and f" with {chosen[name]}"),
                                            *(of.get((library, name), "") for library in LIBRARIES)] for name, kind, _ in FILTERS])
    text += """
`open-television` and `wuji-retargeting` have `exponential` alone, by the formula of `dex-retargeting`. They are in no registry of
packages: the formula was read in their source, and is not run by the test. `lerobot` is run with the PyTorch of Debian 12
(1.13), older than it asks for, and without its steps for images and tokens.
"""
    text += "\nThe only difference above 1e-9 is that of MediaPipe: " + REASONS["mediapipe"] + ".\n"
    text += "\nWith the jittered times:\n\n"
    text += table(["filter", "library", "difference"],
                  [["`one_euro`" + (chosen[name] and f" with {chosen[name]}"), f"`{library}`", number(with_times)]
                   for library, name, _, with_times in rows if with_times is not None])
    text += "\n## Versions and differences\n\n"
    text += table(["library", "notes"], [[f"`{library}`", re.sub(r"^Filter .*? samples per second; ", "", note)]
                                         for library, note in notes.items()])
    return text + """
`one_euro` is not one filter. The speed is counted from the last filtered value (`speed_from: filtered`, the default, as in
both packages) or from the last sample (`raw`, as in MediaPipe). Settings of one are not settings of the other: on the
recording above they differ by """ + "{:.1f}" + """ deg. So tune with the form that your program has.

## Settings that you have

`like` reads settings of a library as that library means them. So your present setting is one more controller of the
comparison:

```yaml
controllers:
  mine: {filter: {kind: one_euro, like: mediapipe, min_cutoff: 0.05, beta: 0.8, unit: rad, disable_value_scaling: true}}
  arm: {filter: {kind: exponential, like: dex-retargeting, low_pass_alpha: 0.2, loop_hz: 30}}
```

| `like` | keys |
|---|---|
| `oneeurofilter`, `1eurofilter` | `mincutoff`, `beta`, `dcutoff`, `unit` |
| `mediapipe` | `frequency` (of the first step alone), `min_cutoff`, `beta`, `derivate_cutoff`, `disable_value_scaling`, `unit` |
| `dex-retargeting`, `open-television` | `low_pass_alpha`, `loop_hz`: frames per second of the program that has it, if they are not the glove's |
| `wuji-retargeting` | `lp_alpha`, `loop_hz` |
| `scipy` | `N`, `Wn`, `fs` of `butter()`: without `fs`, `Wn` is a share of half the glove's rate |

- `unit` (deg, rad or counts) is that of the signal which `beta` is for. It must be given where `beta` is not 0. A stream
  also has `m`, for coordinates of landmarks: [compare the result](../how-to/choose-a-filter.md#in-your-program).
- `disable_value_scaling` must be true. By default MediaPipe divides the speed by the size of the hand in the image,
  which angles do not have.
- `low_pass_alpha` at another rate keeps its decay in time: 0.2 at 30 Hz is 0.106 at 60 Hz.
- `scenario.resolved.yaml` has the settings of Gauntlet's filter.

A stream takes them, too: `gauntlet filter exponential --set like=dex-retargeting --set low_pass_alpha=0.2 < in.csv`, in
Python `gauntlet.filter(angles, "exponential", like="dex-retargeting", low_pass_alpha=0.2)`. There `unit` is the unit of
the samples; only `--map`, which makes degrees, converts.
"""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("gauntlet", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("folder", nargs="?", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--check", type=pathlib.Path)
    parser.add_argument("--here", nargs="+", choices=LIBRARIES)
    arguments = parser.parse_args()
    if (arguments.folder is None) == (arguments.here is None):
        parser.error("must have either FOLDER or --here")
    if arguments.folder:
        arguments.folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as work:
        work = pathlib.Path(work)
        rows, notes = measure(arguments.gauntlet, Machine(arguments.folder, work), work, arguments.here or LIBRARIES)
        angles, _ = recording()
        filtered, raw = (ours(arguments.gauntlet, kind, settings, angles) for _, kind, settings in FILTERS[:2])
    wrong = [row for row in rows if row[2] > SAME_DEG and row[0] not in REASONS]
    for library, name, difference, _ in wrong:
        print(f"{library}, {name}: differs by {difference:.3g} deg", file=sys.stderr)
    if arguments.here:
        print(f"{len(rows)} filters of {', '.join(arguments.here)}, {len(wrong)} differ by more than {SAME_DEG} deg")
        return 1 if wrong or not rows else 0
    text = page(rows, notes).replace("{:.1f}", f"{largest(filtered, raw):.1f}")
    if arguments.check:
        if text != arguments.check.read_text("utf-8"):
            print(f"{arguments.check} is not current: make it again", file=sys.stderr)
            return 1
    else:
        print(text, end="")
    return 1 if wrong else 0


sys.exit(main())
