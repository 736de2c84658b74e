#!/usr/bin/env python3
"""What a person did stays: `gauntlet live` is killed, its disk is full, calls of it fail. What is left is compared with
what was sent. Arguments: the program, failing_calls.so, and a part of a test's name. GAUNTLET_SEED repeats a run,
GAUNTLET_KILLS says how many sessions are killed."""
import csv
import errno
import http.client
import json
import os
import pathlib
import random
import re
import resource
import subprocess
import sys
import threading
import time

from sessions import check, run_tests

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
FAILING_CALLS = pathlib.Path(sys.argv[2]).resolve()
SEED = int(os.environ.get("GAUNTLET_SEED", random.randrange(2**32)))
KILLS = int(os.environ.get("GAUNTLET_KILLS", "6"))
RATE_HZ = 200
MOST_MISSING_S = 1.0
MOST_GROWN_KB = 1500  # in 6 s; histograms have pages that are used late, and so has the heap of running scores; a trace has 10 MB
CLOSE_DEG = 2e-4  # six digits


def sent_deg(number):
    """Another value in each sample."""
    return 10.0 + 0.01 * (number % 5000), 60.0 - 0.01 * (number % 5000)


class Session:
    """A session with a glove behind standard input."""

    def __init__(self, out, *arguments, seconds=None, environment=None, most_bytes=None):
        self.out = out
        more = ["--seconds", str(seconds)] if seconds else []
        self.process = subprocess.Popen(
            [PROGRAM, "live", "random_motion", "--controller", "raw", "--shadow", "mean_20", "--glove", "stdin",
             "--motors", "none", "--set", f"glove.rate_hz={RATE_HZ}",
             "--set", "glove.channels=[index_mcp,middle_mcp]", "--out", out, *more, *arguments],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            env={**os.environ, **(environment or {})},
            preexec_fn=most_bytes and (lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))))
        self.times_s = []  # at which samples were sent
        self.err = b""
        self.err_lines = threading.Thread(target=self.read_err, daemon=True)
        self.err_lines.start()
        self.sender = threading.Thread(target=self.send, daemon=True)
        self.sender.start()

    def read_err(self):
        for line in self.process.stderr:
            self.err += line

    def send(self):
        try:
            self.process.stdin.write(b"index_mcp_deg,middle_mcp_deg\n")
            begin_s = time.monotonic()
            while True:
                number = len(self.times_s)
                time.sleep(max(0.0, begin_s + number / RATE_HZ - time.monotonic()))
                self.process.stdin.write(b"%.2f,%.2f\n" % sent_deg(number))
                self.process.stdin.flush()
                self.times_s.append(time.monotonic())
        except OSError:
            pass

    def wait_for_samples(self, file):
        deadline_s = time.monotonic() + 30
        while not (file.exists() and file.stat().st_size > 0):
            check(time.monotonic() < deadline_s and self.process.poll() is None, self.err.decode())
            time.sleep(0.01)

    def wait(self, exit_code):
        out = self.process.stdout.read().decode()
        self.process.wait(30)
        self.err_lines.join()
        self.sender.join()
        check(self.process.returncode == exit_code, f"exit code {self.process.returncode}: {self.err.decode()}")
        return out, self.err.decode()

    def kill(self):
        """When it was killed."""
        killed_s = time.monotonic()
        self.process.kill()
        self.process.wait(30)
        self.sender.join()
        self.process.stdout.close()
        return killed_s


def samples(file, unit="deg"):
    """The numbers of the samples in a recording: each with its values, in order, and none twice."""
    text = file.read_text()
    lines = text.split("\n")
    whole = lines[:-1]  # behind the last line end is nothing, or a line that was cut
    rows = list(csv.reader(whole))
    check(rows and rows[0] == ["time_s", f"index_mcp_{unit}", f"middle_mcp_{unit}"], f"{file}: {text[:80]}")
    numbers = []
    times_s = [float(row[0]) for row in rows[1:]]
    check(times_s[:1] == [0.0], f"{file}: begins {times_s[:1]} s after the session: its scores would be of other moments")
    check(all(a < b for a, b in zip(times_s, times_s[1:])), f"{file}: times do not rise")
    for row in rows[1:]:
        if unit != "deg":
            numbers.append(float(row[1]))
            continue
        number = round((float(row[1]) - 10.0) / 0.01)
        for value, sent in zip(row[1:], sent_deg(number), strict=True):
            check(abs(float(value) - sent) < CLOSE_DEG, f"{file}: {row} is no sample that was sent")
        numbers.append(number)
    return numbers


def gauntlet(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=60)


def files_of(folder):
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def check_nothing_missing(numbers, what):
    check(numbers == list(range(numbers[0], numbers[0] + len(numbers))), f"{what}: samples are missing within")


def test_kills_leave_all_but_the_last_second(place):
    moments = random.Random(SEED)
    print(f"seed {SEED}")
    killed = []
    for k in range(KILLS):
        recording = place / f"{k}" / "recording.csv"
        session = Session(place / f"{k}")
        killed.append((session, recording, moments.uniform(0.05, 4.0)))

    def kill(session, recording, after_s, ends):
        session.wait_for_samples(recording)
        time.sleep(after_s)
        ends[recording] = session.kill()

    ends = {}
    threads = [threading.Thread(target=kill, args=(*one, ends)) for one in killed]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    check(len(ends) == KILLS, "a session ended before it was killed")
    for session, recording, after_s in killed:
        numbers = samples(recording)
        what = f"killed {after_s:.2f} s after its first sample was on the disk"
        check_nothing_missing(numbers, what)
        missing_s = ends[recording] - session.times_s[numbers[-1] + 1]
        check(missing_s <= MOST_MISSING_S, f"{what}: the last {missing_s:.2f} s are missing")
        inspected = gauntlet("inspect", recording)
        check(inspected.returncode == 0, inspected.stderr)
        said = " ".join(inspected.stdout.split())
        check("at most the last second of it is missing" in said, said)
        check(f"{len(numbers)} rows" in said or f"{len(numbers) + 1} rows" in said, said)
        before = files_of(recording.parent)
        again = gauntlet("live", "random_motion", "--controller", "raw", "--glove", "stdin", "--motors", "none", "--out",
                         recording.parent)
        check(again.returncode == 2 and "a recording is not replaced" in again.stderr, again.stderr)
        check(files_of(recording.parent) == before, "another session changed what was left")


def test_marks_and_counts_are_left_too(place):
    session = Session(place, "--page", "0")
    session.wait_for_samples(place / "recording.csv")
    port, token = re.search(r"127\.0\.0\.1:(\d+)/\?token=(\w+)", session.err.decode()).groups()
    connection = http.client.HTTPConnection("127.0.0.1", int(port), timeout=10)
    for body in ("still", "moving"):
        connection.request("POST", "/mark?token=" + token, body=body)
        check(connection.getresponse().read() is not None, "no answer")
        time.sleep(0.6)
    connection.request("POST", "/switch?token=" + token, body="mean_20")
    connection.getresponse().read()
    time.sleep(1.2)
    session.kill()
    mark = (place / "recording.csv.unfinished").read_text().split("\n")
    check([line.split(" s: ")[1] for line in mark[1:-1]] ==
          ["the hand is marked still", "the hand moves again", "mean_20 drives"], str(mark))
    begin_s, end_s = (float(line.split(" s: ")[0]) for line in mark[1:3])
    check(0.3 < end_s - begin_s < 5.0, str(mark))
    counts = samples(place / "counts.unfinished.csv", "counts")
    check(abs(len(counts) - len(samples(place / "recording.csv"))) < RATE_HZ, "counts are missing")
    noise = gauntlet("calibrate", place / "counts.unfinished.csv", "--still", f"{begin_s:.2f}:{end_s:.2f}", "--out",
                     place / "noise.yaml")
    check(noise.returncode == 0, noise.stderr)


def disturbed(folder, **settings):
    return {"LD_PRELOAD": str(FAILING_CALLS), "ASAN_OPTIONS": "verify_asan_link_order=0",
            "GAUNTLET_FAIL_BELOW": str(folder), "GAUNTLET_FAIL_LOG": str(folder.parent / "log"),
            "GAUNTLET_FAIL_ERROR": str(errno.ENOSPC), **{f"GAUNTLET_FAIL_{k}": v for k, v in settings.items()}}


def check_other_results(place, err):
    facts = json.loads((place / "live.json").read_text())
    check(facts["ended_by"] == "seconds" and facts["frames"]["frames"] > 2 * RATE_HZ, str(facts["frames"]))
    check((place / "report.html").exists() and (place / "trace.h5").exists(), f"no report, or no trace: {err}")


def test_a_full_disk_of_the_recording_costs_the_recording_alone(place):
    disk = place.parent / "disk"
    disk.mkdir()
    session = Session(place, "--record", disk / "own.csv", seconds=3,
                      environment=disturbed(disk, CALL="16", FULL="1"))
    out, err = session.wait(exit_code=1)
    line = err.splitlines()[-1]
    numbers = samples(disk / "own.csv")
    check_nothing_missing(numbers, "full disk")
    kept = re.fullmatch(r"gauntlet: \S+own\.csv: cannot write: No space left on device; (\d+) of (\d+) samples are "
                        r"kept, until ([0-9.]+) s", line)
    check(kept and int(kept[1]) == len(numbers) < int(kept[2]) and 0.4 < float(kept[3]) < 3.0, err)
    check("the session goes on" in err and "The largest stage" in out, err + out)
    check_other_results(place, err)
    check([file.name for file in disk.iterdir()] == ["own.csv"], "a session that ended is marked as unfinished")


def test_a_limit_of_the_size_of_files_is_a_full_disk(place):
    session = Session(place, seconds=4, most_bytes=16384)
    out, err = session.wait(exit_code=1)
    check("recording.csv: cannot write: File too large" in err and "The largest stage" in out, err)
    numbers = samples(place / "recording.csv")
    check_nothing_missing(numbers, "limit of size")
    check(f"; {len(numbers)} of " in err and (place / "recording.csv").stat().st_size <= 16384, err)


def test_a_call_that_fails_once_costs_nothing(place):
    for call, what in (("write", "5"), ("write", "2"), ("ftruncate", "1")):
        disk = place.parent / f"disk_{call}_{what}"
        disk.mkdir()
        session = Session(place / f"{call}_{what}", "--record", disk / "own.csv", seconds=3,
                          environment=disturbed(disk, CALL=what, ONLY=call, ERROR=str(errno.EIO)))
        _, err = session.wait(exit_code=0)
        numbers = samples(disk / "own.csv")
        check_nothing_missing(numbers, f"{call} {what} failed")
        check(len(numbers) > 2 * RATE_HZ, f"only {len(numbers)} samples")
        check_other_results(place / f"{call}_{what}", err)


def test_a_disk_that_fails_to_flush_is_said(place):
    disk = place.parent / "disk"
    disk.mkdir()
    session = Session(place, "--record", disk / "own.csv", seconds=3,
                      environment=disturbed(disk, CALL="2", ONLY="fdatasync", ERROR=str(errno.EIO)))
    _, err = session.wait(exit_code=1)
    check("cannot write to the disk: Input/output error" in err.splitlines()[-1], err)
    check_nothing_missing(samples(disk / "own.csv"), "fdatasync failed")
    check_other_results(place, err)


def test_results_that_find_no_room_leave_the_measurements(place):
    """A trace is large, live.json is not."""
    session = Session(place, seconds=2, environment=disturbed(place, CALL="1", ONLY="pwrite"))
    out, _ = session.wait(exit_code=1)
    check("The largest stage" in out and (place / "live.json").exists(), "no measurements")
    check(not (place / "trace.h5").exists() and samples(place / "recording.csv"), "no recording")


def resident_kb(process):
    return int(re.search(r"VmRSS:\s+(\d+)", pathlib.Path(f"/proc/{process.pid}/status").read_text())[1])


def test_memory_does_not_grow(place):
    if os.environ.get("GAUNTLET_SANITIZE"):
        print("left out: a sanitizer keeps freed memory")
        return
    session = Session(place, "--page", "0")
    session.wait_for_samples(place / "recording.csv")
    time.sleep(3.0)
    grown_kb = []  # what is kept grows in each stretch; what is used late, as on a busy machine, in one
    while len(grown_kb) < 4 and (not grown_kb or grown_kb[-1] >= MOST_GROWN_KB):
        begin_kb = resident_kb(session.process)
        time.sleep(6.0)
        grown_kb.append(resident_kb(session.process) - begin_kb)
    session.kill()
    check(grown_kb[-1] < MOST_GROWN_KB, f"{grown_kb} KB in 6 s each")


if __name__ == "__main__":
    sys.exit(run_tests(globals(), "".join(sys.argv[3:4])))
