"""What the tests of live sessions share: limits of a command frame, and the run of a file's tests."""
import math
import pathlib
import subprocess
import tempfile
import time

COUNTS_PER_RAD = 4096 / (2 * math.pi)  # the servo of the default hand
LARGEST_STEP = 20.0 * 0.02 * COUNTS_PER_RAD + 1.0  # motor.speed_limit_rad_s in a command frame


def check(is_right, what):
    if not is_right:
        raise AssertionError(what)


def run_tests(names, part=""):
    """Each function `test_..` of the names, with a folder that is not there yet; all run, also behind a failure.
    Returns the exit code."""
    failed = 0
    for name, test in list(names.items()):
        if not name.startswith("test_") or part not in name:
            continue
        begin_s = time.monotonic()
        with tempfile.TemporaryDirectory() as place:
            try:
                test(pathlib.Path(place) / "out")
                print(f"passed {name}, {time.monotonic() - begin_s:.1f} s", flush=True)
            except (AssertionError, OSError, subprocess.SubprocessError) as error:
                failed += 1
                print(f"FAILED {name}: {error}", flush=True)
    return 1 if failed else 0
