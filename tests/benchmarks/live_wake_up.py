#!/usr/bin/env python3
"""Wake-ups of `gauntlet live` beside those of cyclictest (Debian's rt-tests), in turns.

    tests/benchmarks/live_wake_up.py build/release/sim/cli/gauntlet [SECONDS] [RUNS] [--settings]

With --settings also without one of the settings of docs/how-to/live.md, in the same turns. 60 s and at least five runs are a measurement. p50 and p99 should be at most 1.5 times those of
cyclictest. The script also prints the program's own time from a sample to its command, in processor
time of the thread: p99.9 below 100 us, none above 1 ms. Run it as root, on a machine that does nothing else."""
import json
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile


def of_cyclictest(seconds):
    """p50, p99, p99.9, maximum [us], from its histogram."""
    command = ["cyclictest", "-m", "-q", "-p", "80", "-i", "1000", "-D", str(seconds), "-h", "20000"]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    steps = [tuple(map(int, match)) for match in re.findall(r"^(\d+)\s+(\d+)$", text, re.M)]
    total = sum(count for _, count in steps)
    values = []
    for share in (0.5, 0.99, 0.999):
        seen = 0
        for us, count in steps:
            seen += count
            if seen >= share * total:
                values.append(us)
                break
    return values + [int(re.search(r"Max Latencies: *(\d+)", text).group(1))]


SETTINGS = {
    "live": [],
    "without priority": ["setpriv", "--bounding-set", "-sys_nice", "prlimit", "--rtprio=0"],
    "without locked memory": ["setpriv", "--bounding-set", "-ipc_lock", "prlimit", "--memlock=0"],
    "on one core": ["taskset", "-c", "1"],
}


def of_live(program, seconds, place, before=()):
    subprocess.run([*before, program, "live", "random_motion", "--controller", "tuned_kalman", "--seconds",
                    str(seconds), "--set", f"glove.motion.duration_s={seconds}", "--out", place],
                   check=True, capture_output=True)
    loop = json.loads((place / "live.json").read_text())["loop"]
    late, own = loop["lateness"], loop["step_processor_time"]
    return ([late[key] for key in ("p50_us", "p99_us", "p999_us", "max_us")],
            [own["p999_us"], own["max_us"]], loop["skipped_ticks"])


def main():
    words = [word for word in sys.argv[1:] if word != "--settings"]
    program = pathlib.Path(words[0]).resolve()
    seconds = int(words[1]) if len(words) > 1 else 60
    runs = int(words[2]) if len(words) > 2 else 5
    settings = SETTINGS if "--settings" in sys.argv else {"live": []}
    has_other = shutil.which("cyclictest") is not None
    ours, theirs = [], []
    with tempfile.TemporaryDirectory() as place:
        for _ in range(runs):
            for name, before in settings.items():
                late, own, skipped = of_live(program, seconds, pathlib.Path(place) / name.replace(" ", "_"), before)
                if not before:
                    ours.append(late)
                print(f"{name:21}  p50 {late[0]:.0f}, p99 {late[1]:.0f}, p99.9 {late[2]:.0f}, max {late[3]:.0f} us; "
                      f"skipped {skipped}; sample to command p99.9 {own[0]:.0f}, max {own[1]:.0f} us")
            if has_other:
                theirs.append(of_cyclictest(seconds))
                print("cyclictest             p50 {}, p99 {}, p99.9 {}, max {} us".format(*theirs[-1]))
    if not has_other:
        print("cyclictest is not installed (rt-tests): nothing to compare with")
        return 0
    for place, name in enumerate(("p50", "p99")):
        ratio = (statistics.median(run[place] for run in ours)
                 / max(1, statistics.median(run[place] for run in theirs)))
        print(f"median of {name}: {ratio:.2f} times that of cyclictest")
    return 0


if __name__ == "__main__":
    sys.exit(main())
