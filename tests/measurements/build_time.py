#!/usr/bin/python3
"""Processor time of cold release builds of the program, without a compiler cache, at two commits.

  tests/measurements/build_time.py OLD NEW [--times 2]

Each commit is cloned into a temporary folder. The builds take turns (OLD, NEW, OLD, NEW ..), so that both have the same
hour of the machine; nothing else should run. Prints, for each commit, the median of user + system seconds of the whole
build and its wall time, the five dearest objects and the compiler with the largest memory, then the ratio NEW / OLD. The
program of studies, which the start script builds first, is a part of the whole build; its seconds are printed, too.
"""
import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
# Runs one compiler and notes its seconds and its peak of memory.
LAUNCHER = """import os, resource, subprocess, sys
code = subprocess.call(sys.argv[2:])
used = resource.getrusage(resource.RUSAGE_CHILDREN)
words = sys.argv[2:]
made = words[words.index("-o") + 1] if "-o" in words else words[-1]
with open(sys.argv[1], "a") as log:
    log.write(f"{used.ru_utime + used.ru_stime:.2f} {used.ru_maxrss} {made}\\n")
sys.exit(code)
"""


def build(clone, work, commit):
    """A cold build: (processor s, wall s, [(s, kB, object), ..])."""
    folder, log, launcher = clone / "build/cold", work / "objects.log", work / "launcher.py"
    subprocess.run(["rm", "-rf", folder, log], check=True)
    launcher.write_text(LAUNCHER)
    subprocess.run(
        ["cmake", "-S", clone, "-B", folder, "--preset", "release", "-D", "GAUNTLET_BUILD_TESTS=OFF",
         "-D", "GAUNTLET_BUILD_PYTHON=OFF",
         "-D", f"CMAKE_CXX_COMPILER_LAUNCHER={sys.executable};{launcher};{log}"],
        check=True, stdout=subprocess.DEVNULL)
    before, begin = os.times(), time.monotonic()
    for target in ("gauntlet_studies", "gauntlet"):
        known = subprocess.run(["ninja", "-C", folder, "-t", "query", target], capture_output=True).returncode == 0
        if known:
            subprocess.run(["ninja", "-C", folder, target], check=True, stdout=subprocess.DEVNULL)
        after, wall_s = os.times(), time.monotonic() - begin
        processor_s = (after.children_user + after.children_system) - (before.children_user + before.children_system)
        if known and target != "gauntlet":
            print(f"{commit}: {processor_s:.0f} s of a processor, {wall_s:.0f} s of wall until {target}", flush=True)
    rows = [line.split(" ", 2) for line in log.read_text().splitlines()]
    objects = sorted(((float(s), int(kb), name) for s, kb, name in rows), reverse=True)
    print(f"{commit}: {processor_s:.0f} s of a processor, {wall_s:.0f} s of wall, {len(objects)} objects", flush=True)
    return processor_s, wall_s, objects


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commits", nargs=2, metavar="COMMIT")
    parser.add_argument("--times", type=int, default=2, help="builds of each commit (default 2)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="gauntlet-build-time-", dir="/var/tmp") as temporary:
        work = pathlib.Path(temporary)
        built = {commit: [] for commit in options.commits}
        for commit in options.commits:
            subprocess.run(["git", "clone", "--quiet", ROOT, work / commit], check=True)
            subprocess.run(["git", "-C", work / commit, "checkout", "--quiet", commit], check=True)
        for _ in range(options.times):
            for commit in options.commits:
                built[commit].append(build(work / commit, work, commit))
    medians = []
    for commit, builds in built.items():
        medians.append(statistics.median(processor_s for processor_s, _, _ in builds))
        wall_s = statistics.median(wall_s for _, wall_s, _ in builds)
        objects = builds[-1][2]
        print(f"\n{commit}: median {medians[-1]:.0f} s of a processor, {wall_s:.0f} s of wall; the dearest objects:")
        for seconds, kilobytes, name in objects[:5]:
            print(f"  {seconds:5.1f} s  {kilobytes / 1024:5.0f} MB  {name}")
        print(f"  largest compiler: {max(kilobytes for _, kilobytes, _ in objects) / 1024:.0f} MB")
    print(f"\nratio {medians[1] / medians[0]:.3f}")


main()
