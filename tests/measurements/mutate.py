#!/usr/bin/python3
"""Makes small errors in the code, one at a time, and lists those that the unit tests do not see.

    tests/measurements/mutate.py                       15 errors in each folder
    tests/measurements/mutate.py score --count 40 --seed 2 --work /var/tmp/mutate

An error is a comparison that includes or leaves out its limit, == for !=, + for -, * for /, && for ||,
a constant that is twice as large, an integer that is one larger, or a statement that is missing. Places
are drawn at random from a seed. The tests that may see an error are those of the folder's own program
in tests/. One that does not compile is drawn again. Errors that change no result are in
mutate_equivalent.txt, each with the reason, and are not drawn.

The errors are made in a copy of the tracked files, in a temporary folder or in --work, which is kept
and makes the next call faster. Needs git, cmake, ninja and what a build of Gauntlet needs. It prints
one line for each error. Exit code: 0 all errors are seen, but for --most-percent; 1 more
live; 2 the tests fail without one.
"""
import argparse
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
EQUIVALENT = os.path.join(ROOT, "tests/measurements/mutate_equivalent.txt")
# Per folder: where its code is, what of it other programs test, and its test programs.
FOLDERS = {
    "controller": ("controller", ("examples", "c_api", "embedded"),
                   ("controller_test", "controller_filter_test", "controller_prediction_test",
                    "controller_model_predictive_test", "controller_loading_test",
                    "controller_filter_properties_test")),
    "score": ("sim/score", (), ("score_test",)),
    "recordings": ("sim/recordings", ("inspect",), ("recordings_test",)),
    # Tests of the command see most of its errors, which is not counted here.
    "inspect": ("sim/recordings/inspect", (), ("inspect_parts_test",)),
    "tables": ("sim/tables", (), ("recordings_test",)),
    "link": ("sim/trial/link", (), ("link_test",)),
    "device": ("sim/live/device", (), ("device_test",)),
    "live": ("sim/live", ("device", "server"), ("live_test",)),
    "statistics": ("sim/score/statistics", (), ("statistics_test", "comparison_test")),
    "comparison": ("sim/answers/compare", (), ("comparison_test", "study_test")),
    "study": ("sim/study", (), ("study_test", "comparison_test")),
    "sweep": ("sim/answers/sweep", (), ("sweep_test",)),
    "tune": ("sim/answers/tune", (), ("search_test",)),
    "robust": ("sim/answers/robust", (), ("robust_test",)),
}
SWAPS = {
    "comparison": {" < ": (" <= ",), " <= ": (" < ",), " > ": (" >= ",), " >= ": (" > ",),
                   " == ": (" != ",), " != ": (" == ",)},
    "sign": {" + ": (" - ",), " - ": (" + ",), " += ": (" -= ",), " -= ": (" += ",),
             " * ": (" / ",), " / ": (" * ",)},
    "logic": {" && ": (" || ",), " || ": (" && ",)},
}
NUMBER = re.compile(r"(?<![\w.\"'])(\d+\.\d+(?:e-?\d+)?|\d+e-?\d+|\d+)(?![\w.'])")
# An assignment or a call, alone or after an `if` in the same line; no declaration.
STATEMENT = re.compile(r"^\s+(?:if \(.*\) )?(?!return|throw|using|case|static|const |auto |delete|break|continue)"
                       r"[\w:.\[\]>()*-]+(?: [-+*/|&]?= .*|\(.*\)|\+\+|--);$|^\s+(?:\+\+|--)[\w.\[\]]+;$"
                       r"|^\s+if \(.*\) (?:return|continue|break|throw).*;$")
# TrimSignals() frees memory and changes no result. Ranges of settings are in docs/reference, which a test compares.
SKIPPED = re.compile(r"^\s*(//|#)|GAUNTLET_|TrimSignals|visitor\.(Number|Integer)s?\(|static_assert|\boperator\b|template|R\"")


def code_of(line):
    """The line with its text in quotes and its comment as blanks, so that places stay."""
    line = re.sub(r"\"(?:[^\"\\]|\\.)*\"|'(?:[^'\\]|\\.)'", lambda m: '"' * len(m.group()), line)
    return re.sub(r"//.*", lambda m: " " * len(m.group()), line)


def twice(text):
    return repr(2.0 * float(text)) if "." in text or "e" in text else str(2 * int(text))


def errors_in(line):
    """(kind, the line with the error) of all errors that may be made in it."""
    if SKIPPED.search(line):
        return
    code = code_of(line)
    for kind, swaps in SWAPS.items():
        for old, new in swaps.items():
            for match in re.finditer(re.escape(old), code):
                for text in new:
                    yield kind, line[:match.start()] + text + line[match.end():]
    for match in NUMBER.finditer(code):
        text = match.group()
        for kind, number in ((("constant", twice(text)),) if float(text) != 0.0 else ()) + (
                (("off by one", str(int(text) + 1)),) if text.isdigit() else ()):
            yield kind, line[:match.start()] + number + line[match.end():]
    if STATEMENT.match(code.rstrip()) and code.count("(") == code.count(")"):
        yield "removed", re.match(r"\s*", line).group() + ";"


def known_equivalent():
    known = {}
    with open(EQUIVALENT, encoding="utf-8") as file:
        for line in file:
            if line.strip() and not line.startswith("#"):
                path, before, after, reason = [part.strip() for part in line.split(" | ")]
                assert reason
                known[path, before] = known.get((path, before), ()) + (after,)
    return known


def all_errors(folder, tree):
    """{kind: [(path, index of the line, the line with the error)]}"""
    where, elsewhere, _ = FOLDERS[folder]
    known = known_equivalent()
    errors = {}
    for directory, _, files in sorted(os.walk(os.path.join(tree, where))):
        if any(part in os.path.relpath(directory, tree).split(os.sep) for part in elsewhere):
            continue
        for name in sorted(files):
            if not name.endswith((".cc", ".h")):
                continue
            path = os.path.relpath(os.path.join(directory, name), tree)
            with open(os.path.join(tree, path), encoding="utf-8") as file:
                lines = file.read().split("\n")
            for index, line in enumerate(lines):
                for kind, changed in errors_in(line):
                    if changed.strip() not in known.get((path, line.strip()), ()):
                        errors.setdefault(kind, []).append((path, index, changed))
    return errors


def run(command, log, timeout=None, **options):
    """Whether it succeeds in time."""
    try:
        return subprocess.run(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL,
                              timeout=timeout, check=False, **options).returncode == 0
    except subprocess.TimeoutExpired:
        return False


class Copy:
    """A copy of the tracked files with a build of its own."""

    def __init__(self, work, jobs, cmake_arguments):
        self.tree = os.path.join(work, "tree")
        self.build = os.path.join(self.tree, "build/mutate")
        self.jobs = str(jobs)
        self.log = open(os.path.join(work, "log"), "ab")
        files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True,
                               capture_output=True).stdout.decode().split("\0")
        for name in filter(None, files):
            old, new = os.path.join(ROOT, name), os.path.join(self.tree, name)
            os.makedirs(os.path.dirname(new), exist_ok=True)
            if not os.path.exists(new) or open(old, "rb").read() != open(new, "rb").read():
                shutil.copy(old, new)
        if not run(["cmake", "-S", self.tree, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug",
                    "-DCMAKE_CXX_FLAGS_DEBUG=-O1", "-DGAUNTLET_BUILD_BENCHMARKS=OFF",
                    *cmake_arguments], self.log):
            sys.exit(f"cmake fails: {self.log.name}")

    def makes(self, programs):
        return run(["ninja", "-C", self.build, "-j", self.jobs, *programs], self.log)

    def sees(self, programs, seconds):
        """The first program that fails, or takes much longer than it did without an error."""
        for program in programs:
            path = os.path.join(self.build, "tests", program.split("_")[0], program)
            if not run([path, "--gtest_brief=1", "--gtest_fail_fast"], self.log, 30.0 + 10.0 * seconds.get(program, 1e4),
                       cwd=os.path.dirname(path)):
                return program
        return None


def mutate(folder, copy, options):
    """How many errors were tried, and those that live."""
    programs = FOLDERS[folder][2]
    if not copy.makes(programs):
        print(f"{folder}: the tests do not compile, see {copy.log.name}")
        sys.exit(2)
    os.environ["CCACHE_READONLY"] = "1"  # where ccache is, it has what an error was removed from, and no error
    seconds = {}
    for program in programs:
        begin = time.monotonic()
        if copy.sees([program], {}):
            print(f"{folder}: {program} fails without an error, see {copy.log.name}")
            sys.exit(2)
        seconds[program] = time.monotonic() - begin
    errors = all_errors(folder, copy.tree)
    draw = random.Random(f"{options.seed} {folder}")
    tried = 0
    living = []
    while tried < options.count and errors:
        kind = draw.choice(sorted(errors))
        path, index, changed = errors[kind].pop(draw.randrange(len(errors[kind])))
        errors = {name: places for name, places in errors.items() if places}
        full = os.path.join(copy.tree, path)
        with open(full, encoding="utf-8") as file:
            text = file.read()
        lines = text.split("\n")
        before = lines[index]
        lines[index] = changed
        try:
            with open(full, "w", encoding="utf-8") as file:
                file.write("\n".join(lines))
            if not copy.makes(programs):
                continue
            seen_by = copy.sees(programs, seconds)
        finally:
            with open(full, "w", encoding="utf-8") as file:
                file.write(text)
        tried += 1
        verdict = f"seen by {seen_by}" if seen_by else "LIVES"
        print(f"{path}:{index + 1}: {kind}: {before.strip()} -> {changed.strip()}: {verdict}", flush=True)
        if not seen_by:
            living.append((path, before.strip(), changed.strip()))
    return tried, living


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="*", choices=[[], *FOLDERS], help="by default all")
    parser.add_argument("--count", type=int, default=15, help="errors per folder (default 15)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--most-percent", type=float, default=0.0, help="so many may live (default 0)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="compilers at a time")
    parser.add_argument("--work", help="folder of the copy and its build, which is kept")
    parser.add_argument("--cmake", action="append", default=[], metavar="ARGUMENT", help="further argument of cmake")
    options = parser.parse_args()
    work = options.work or tempfile.mkdtemp(prefix="mutate")
    os.makedirs(work, exist_ok=True)
    try:
        copy = Copy(work, options.jobs, options.cmake)
        results = [mutate(folder, copy, options) for folder in options.folders or FOLDERS]
    finally:
        if not options.work:
            shutil.rmtree(work)
    living = [error for _, some in results for error in some]
    tried = sum(number for number, _ in results)
    print(f"{tried} errors, {len(living)} live")
    for error in living:  # as lines of mutate_equivalent.txt, for those that are
        print(" | ".join(error))
    sys.exit(1 if 100.0 * len(living) > options.most_percent * tried else 0)


if __name__ == "__main__":
    main()
