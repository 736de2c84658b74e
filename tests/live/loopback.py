#!/usr/bin/env python3
"""`gauntlet live` and `gauntlet glove` as whole commands, on this computer's loopback. Encoder and
decoder here are their own. Nothing depends on how fast the machine is."""
import json
import math
import os
import pathlib
import pty
import random
import select
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
import tty

from sessions import COUNTS_PER_RAD, LARGEST_STEP, check, run_tests

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
CHANNELS = ["index_mcp", "middle_mcp"]
SMALL_GLOVE = ["--set", "glove.rate_hz=100", "--set", "glove.channels=[index_mcp,middle_mcp]"]
RETURN_STEP = math.radians(300.0) * 0.02 * COUNTS_PER_RAD + 1.0  # return_deg_s of the watchdog in a command frame


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Motors(threading.Thread):
    """Keeps the command frames that arrive: number, counts; and when each was sent."""

    def __init__(self):
        super().__init__(daemon=True)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(0.1)
        self.address = f"udp:127.0.0.1:{self.socket.getsockname()[1]}"
        self.frames = []
        self.times_s = {}
        self.ends = False
        self.start()

    def run(self):
        while not self.ends:
            try:
                packet = self.socket.recv(65536).decode()
            except socket.timeout:
                continue
            for line in packet.splitlines():
                cells = line.split(",")
                if cells[0] != "frame":
                    self.times_s[int(cells[0])] = float(cells[1])
                    self.frames.append((int(cells[0]), [float(cell) for cell in cells[2:]]))

    def end(self):
        time.sleep(0.3)
        self.ends = True
        self.join()
        self.socket.close()
        return self.frames


def check_commands(frames):
    check(len(frames) > 20, f"only {len(frames)} command frames")
    for (number, before), (next_number, after) in zip(frames, frames[1:]):
        check(next_number > number, "command frames are not in order")
        for a, b in zip(before, after):
            check(0 <= b <= 4095 and b == int(b), f"command {b} is no count of the motor")
            check(abs(b - a) <= LARGEST_STEP * (next_number - number), f"a jump from {a} to {b}")
    first, last = frames[0][1], frames[-1][1]
    check(frames[-3][1] == frames[-2][1] == last, "the motors are not at rest in the end")
    check(all(abs(a - b) <= RETURN_STEP for a, b in zip(first, last)),
          "the motors do not begin and end at rest")


def check_stages(facts):
    total = facts["total"]["mean_us"]
    stages = sum(stage["mean_us"] for stage in facts["stages"].values())
    check(abs(stages / total - 1.0) < 0.01, f"the stages are {stages} us of {total} us")
    check(all(stage["count"] == facts["total"]["count"] for stage in facts["stages"].values()),
          "a stage lacks commands")


def live(place, *arguments):
    return subprocess.Popen([PROGRAM, "live", "random_motion", "--controller", "raw", "--out", place,
                             *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def finish(process, timeout_s=60, exit_code=0, text=None):
    out, err = process.communicate(text, timeout=timeout_s)
    check(process.returncode == exit_code, f"exit code {process.returncode}: {err}")
    return out, err


def facts_in(place):
    return json.loads((place / "live.json").read_text())


def test_glove_of_a_scenario_over_udp(place):
    motors = Motors()
    address = f"udp:127.0.0.1:{free_port()}"
    session = live(place / "live", "--glove", address, "--motors", motors.address, "--seconds", "2",
                   "--shadow", "tuned_kalman", "--record", place / "own.csv")
    glove = subprocess.Popen([PROGRAM, "glove", "random_motion", "--to", address, "--seconds", "30"],
                             stderr=subprocess.DEVNULL)
    out, _ = finish(session)
    glove.send_signal(signal.SIGTERM)
    glove.wait(10)
    check_commands(motors.end())
    facts = facts_in(place / "live")
    check_stages(facts)
    frames = facts["frames"]
    check(frames["has_numbers"] and frames["repeated"] == frames["out_of_order"] == 0,
          "frames of a good link are repeated or out of order")
    check(facts["ended_by"] == "seconds" and facts["commands"]["failed"] == 0, str(facts["commands"]))
    check("The largest stage" in out and "tuned_kalman" in out, out)
    check([c["controller"] for c in facts["controllers"]] == ["raw", "tuned_kalman"],
          "the shadow has no scores")
    before = (place / "own.csv").read_bytes()
    again = subprocess.run([PROGRAM, "live", "random_motion", "--controller", "raw", "--seconds", "1",
                            "--record", place / "own.csv", "--out", place / "not_made"],
                           capture_output=True, text=True)
    check(again.returncode == 2 and "a recording is not replaced" in again.stderr, again.stderr)
    check((place / "own.csv").read_bytes() == before, "the recording was replaced")
    inspected = subprocess.run([PROGRAM, "inspect", place / "own.csv"], capture_output=True,
                               text=True, check=True).stdout
    check("joints  18 by name" in inspected, inspected)
    for recording in (place / "own.csv", place / "live" / "scenario.resolved.yaml"):
        subprocess.run([PROGRAM, "run", recording, "--causes", "none", "--out", place / "again"],
                       check=True, capture_output=True)
    subprocess.run([PROGRAM, "report", place / "live", place / "again", "--out",
                    place / "page.html"], check=True, capture_output=True)


def send_faults(address, seconds=3.0):
    """100 samples a second, with every fault. Returns what was sent."""
    random.seed(1)
    sent = {"lost": 0, "repeated": 0, "garbage": 0}
    way = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    late = []
    start = time.monotonic()
    offset = 0
    for number in range(int(100 * seconds)):
        time.sleep(max(0.0, start + 0.01 * number - time.monotonic()))
        now = time.monotonic() - start
        for due, packet in [entry for entry in late if entry[0] <= now]:
            way.sendto(packet, address)
        late = [entry for entry in late if entry[0] > now]
        if number % 50 == 0:
            way.sendto(b"frame,time_s,index_mcp_counts,middle_mcp_counts\n", address)
        if 150 <= number < 170:
            continue  # a burst, and a watchdog that holds
        if 200 <= number < 240:
            offset = 240  # gone for 0.4 s, and back with numbers from 0 on
            continue
        values = [500.0 + 200.0 * math.sin(2.0 * math.pi * 0.5 * now + c) for c in range(2)]
        if number % 40 == 7:
            values = [1e9, -1e9]
        packet = f"{number - offset},{now:.6f},{values[0]:.3f},{values[1]:.3f}\n".encode()
        if 20 < number < 150 and random.random() < 0.1:
            sent["lost"] += 1
            continue
        if number in (60, 61, 90):
            late.append((now + 0.2, packet))
            continue
        way.sendto(packet, address)
        if number % 30 == 11:
            way.sendto(packet, address)
            sent["repeated"] += 1
        if number % 25 == 13:
            way.sendto(b"\xff\x00boot: rst:0x1\n" if number % 2 else packet[: len(packet) // 2], address)
            sent["garbage"] += 1
    way.close()
    return sent


def test_every_fault_of_a_link(place):
    motors = Motors()
    port = free_port()
    session = live(place, "--glove", f"udp:127.0.0.1:{port}", "--motors", motors.address,
                   "--seconds", "2.6", *SMALL_GLOVE)
    time.sleep(0.5)
    sent = send_faults(("127.0.0.1", port))
    finish(session)
    frames = motors.end()
    check_commands(frames)
    facts = facts_in(place)
    got = facts["frames"]
    check(got["lost"] >= 20, f"lost: {got['lost']}")
    # Of a sender that starts anew, four frames look like repeated ones.
    check(0 < got["repeated"] <= sent["repeated"] + 4, f"repeated: {got['repeated']}, sent {sent}")
    check(got["out_of_order"] >= 3, f"out of order: {got['out_of_order']}")
    check(got["restarts"] == 1, f"restarts: {got['restarts']}")
    check(got["garbage"] + got["half_frames"] > 0, "garbage is not counted")
    check(facts["watchdog"]["hold"]["entered"] >= 1 and facts["watchdog"]["relax"]["entered"] >= 1,
          str(facts["watchdog"]))
    check(facts["untrusted_samples"][0] > 0, "values of 1e9 are trusted")


def test_ctrl_c_brings_motors_to_rest(place):
    motors = Motors()
    session = live(place, "--motors", motors.address)
    time.sleep(1.5)
    deadline = time.monotonic() + 20
    while len(motors.frames) < 30 and time.monotonic() < deadline:
        time.sleep(0.05)
    session.send_signal(signal.SIGINT)
    finish(session)
    check_commands(motors.end())
    check(facts_in(place)["ended_by"] == "stopped", "Ctrl-C is not the reason")


def test_standard_input_ends_the_session(place):
    rows = "index_mcp_deg,middle_mcp_deg\n" + "".join(f"{20 + i % 9},30\n" for i in range(50))
    session = live(place, "--glove", "stdin", "--motors", "none", *SMALL_GLOVE)
    finish(session, text=rows)
    facts = facts_in(place)
    check(facts["ended_by"] == "glove ended" and facts["frames"]["frames"] == 50, str(facts["frames"]))


def test_motors_without_a_listener_do_not_end_it(place):
    session = live(place, "--motors", f"udp:127.0.0.1:{free_port()}", "--seconds", "1.5")
    finish(session)
    facts = facts_in(place)
    check(facts["commands"]["failed"] > 0, str(facts["commands"]))
    # A busy machine notices late that no program listens. Until then motors go as fast as they return.
    step = facts["commands"]["largest_step_counts"]
    check(step <= RETURN_STEP, f"motors without a sink move by {step} counts")


def test_bytes_that_are_no_frames_are_named(place):
    """As of another baud rate."""
    place.parent.mkdir(exist_ok=True)
    device = SerialDevice(place.parent / "glove", False)
    session = live(place, "--glove", f"serial:{place.parent / 'glove'}", "--motors", "none", "--seconds", "5", *SMALL_GLOVE)
    noise = random.Random(1)
    while session.poll() is None:
        os.write(device.end, bytes(noise.choice(b"\x80\xe6\xf8\xfexy~") for _ in range(50)))
        time.sleep(0.02)
    _, err = finish(session, exit_code=1)
    device.unplug()
    for line in err.splitlines()[-2:]:
        check("bytes arrived, and none is a frame" in line and "another baud rate" in line and "they begin with '" in line,
              err)
    check("no frame yet" in err.splitlines()[-2] and all(letter.isprintable() or letter == "\n" for letter in err), err)


def test_a_return_is_slow_whatever_watches_the_link(place):
    for watchdog in ("tiers", "none"):
        motors = Motors()
        port = free_port()
        more = ["--set", "link.glove.watchdog.kind=none"] if watchdog == "none" else []
        session = live(place / watchdog, "--glove", f"udp:127.0.0.1:{port}", "--motors", motors.address, *SMALL_GLOVE, *more)
        way = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

        def send(counts, seconds):
            for number in range(int(100 * seconds)):
                way.sendto(b"index_mcp_counts,middle_mcp_counts\n%d,%d\n" % (counts, counts), ("127.0.0.1", port))
                time.sleep(0.01)

        send(200, 2.0)
        time.sleep(0.6)
        back = len(motors.frames)
        send(900, 2.0)
        session.send_signal(signal.SIGINT)
        finish(session)
        frames = motors.end()
        way.close()
        moved = 0
        for (number, before), (following, after) in zip(frames[back:], frames[back + 1:]):
            step = max(abs(b - a) for a, b in zip(before, after))
            # On a busy machine the loop skips ticks: a frame is late by them, and moves for as long.
            elapsed_s = motors.times_s[following] - motors.times_s[number] + 0.002
            most = RETURN_STEP * max(following - number, elapsed_s / 0.02)
            check(step <= most, f"{watchdog}: {step} counts in {1e3 * elapsed_s:.1f} ms after a gap")
            moved = max(moved, max(abs(b - a) for a, b in zip(frames[back][1], after)))
        check(moved > 300, f"{watchdog}: the motors did not follow again")


def test_columns_that_are_not_the_glove_are_asked_for(place):
    session = live(place, "--glove", "stdin", *SMALL_GLOVE)
    _, err = finish(session, exit_code=2, text="1,2,3\n4,5,6\n7,8,9\n")
    check("3 values" in err and "--map" in err, err)
    check(not place.exists(), "a session that failed left its folder")


class SerialDevice(threading.Thread):
    """A microcontroller on a serial line: sends two channels as labels, 100 times a second, and keeps what it gets. Its
    name stays when it is plugged in again, as names below /dev/serial/by-id do."""

    def __init__(self, name, sends):
        super().__init__(daemon=True)
        self.end, device = pty.openpty()
        tty.setraw(device)
        self.device = device
        self.got = b""
        self.sends = sends
        self.ends = False
        if name.is_symlink():
            name.unlink()
        name.symlink_to(os.ttyname(device))
        self.start()

    def run(self):
        begin = time.monotonic()
        number = 0
        while not self.ends:
            time.sleep(max(0.0, begin + 0.01 * number - time.monotonic()))
            if self.sends:
                phase = math.pi * 0.01 * number
                os.write(self.end, b"index_mcp_counts:%d middle_mcp_counts:%d\r\n" %
                         (500 + 200 * math.sin(phase), 500 + 200 * math.cos(phase)))
            while select.select([self.end], [], [], 0)[0]:
                self.got += os.read(self.end, 65536)
            number += 1

    def unplug(self):
        self.ends = True
        self.join()
        os.close(self.device)
        os.close(self.end)
        return self.got


def test_own_glove_over_a_serial_line_in_each_format(place):
    place.mkdir()

    def pair(name):
        end, device = pty.openpty()
        tty.setraw(device)
        (place / name).symlink_to(os.ttyname(device))
        return end, device

    def relay(begin, end, ends):
        while not ends.is_set():
            if select.select([begin], [], [], 0.05)[0]:
                os.write(end, os.read(begin, 65536))

    runs = []
    for text in ("csv", "labels", "json", "binary"):
        (begin, near), (end, far) = pair(text + "_glove"), pair(text + "_live")
        ends = threading.Event()
        way = threading.Thread(target=relay, args=(begin, end, ends), daemon=True)
        way.start()
        glove = subprocess.Popen([PROGRAM, "glove", "random_motion", "--to", f"serial:{place / text}_glove", "--format", text,
                                  "--seconds", "30", "--set", "glove.rate_hz=100"], stderr=subprocess.DEVNULL)
        session = live(place / text, "--glove", f"serial:{place / text}_live", "--motors", "none", "--seconds", "3", "--set",
                       "glove.rate_hz=100")
        runs.append((text, glove, session, way, ends, (begin, near, end, far)))
    for text, glove, session, way, ends, files in runs:
        finish(session)
        glove.send_signal(signal.SIGTERM)
        glove.wait(10)
        ends.set()
        way.join(1.0)  # it waits until there is room, of which none comes behind the session
        for file in files[1::2]:
            os.close(file)
        frames = facts_in(place / text)["frames"]
        check(frames["frames"] > 200 and frames["lost"] == 0 and frames["garbage"] == 0, f"{text}: {frames}")
        rows = (place / text / "recording.csv").read_text().splitlines()
        check(len(rows) > 200 and all(len(row.split(",")) == 19 and ",," not in row for row in rows), f"{text}: {rows[:2]}")
        angles = [float(row.split(",")[5]) for row in rows[1:]]
        check(-45 < min(angles) < max(angles) - 5 < 115, f"{text}: {min(angles)} to {max(angles)} deg")


def commands_of_lines(text):
    frames = []
    for line in text.decode().splitlines():
        cells = line.split(",")
        if cells[0].isdigit() and cells[-1]:
            frames.append((int(cells[0]), [float(cell) for cell in cells[2:]]))
    return frames


def test_serial_devices_that_are_unplugged(place):
    place.parent.mkdir(exist_ok=True)
    glove_name, motors_name = place.parent / "glove", place.parent / "motors"
    glove, motors = SerialDevice(glove_name, True), SerialDevice(motors_name, False)
    session = live(place, "--glove", f"serial:{glove_name}", "--motors", f"serial:{motors_name}", *SMALL_GLOVE)

    def wait_for_commands(device, count):
        deadline = time.monotonic() + 20
        while device.got.count(b"\n") < count and time.monotonic() < deadline:
            time.sleep(0.02)

    wait_for_commands(motors, 60)
    glove.unplug()
    time.sleep(0.5)
    glove = SerialDevice(glove_name, True)
    begun = motors.got.count(b"\n")
    wait_for_commands(motors, begun + 60)
    frames = commands_of_lines(motors.unplug())
    time.sleep(0.5)
    motors = SerialDevice(motors_name, False)
    wait_for_commands(motors, 60)
    session.send_signal(signal.SIGINT)
    finish(session)
    glove.unplug()
    check_commands(frames + commands_of_lines(motors.unplug()))
    facts = facts_in(place)
    check(facts["frames"]["reopened"] == 1, f"the glove was opened again {facts['frames']['reopened']} times")
    check(facts["watchdog"]["hold"]["entered"] >= 1, "the watchdog slept")
    check(facts["ended_by"] == "stopped", facts["ended_by"])


def osc_message(address, values):
    def padded(text):
        return text + b"\0" * (4 - len(text) % 4)
    return padded(address) + padded(b"," + b"f" * len(values)) + struct.pack(f">{len(values)}f", *values)


def test_osc_at_both_ends(place):
    motors = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    motors.bind(("127.0.0.1", 0))
    motors.settimeout(0.5)
    port = free_port()
    session = live(place, "--glove", f"osc:127.0.0.1:{port}/hand", "--motors",
                   f"osc:127.0.0.1:{motors.getsockname()[1]}/motors", "--seconds", "1", *SMALL_GLOVE)
    way = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    number = 0
    while session.poll() is None and number < 3000:
        phase = math.pi * 0.01 * number
        values = [500 + 200 * math.sin(phase), 500 + 200 * math.cos(phase)]
        way.sendto(osc_message(b"/hand", values), ("127.0.0.1", port))
        way.sendto(osc_message(b"/other", [1e6]), ("127.0.0.1", port))
        number += 1
        time.sleep(0.01)
    finish(session)
    commands = []
    try:
        while True:
            packet = motors.recv(65536)
            at = packet.find(b"/motors")
            check(at >= 0, f"a message to another address: {packet[:40]}")
            types = packet[at + 8:packet.index(b"\0", at + 8)].decode()
            begin = at + 8 + len(types) + 4 - len(types) % 4
            commands.append((types, packet[begin:]))
    except socket.timeout:
        pass
    check(len(commands) > 20, f"only {len(commands)} commands")
    check(len({types for types, _ in commands}) == 1 and commands[0][0].startswith(","), str(commands[0]))
    check(all(len(values) == 4 * (len(types) - 1) for types, values in commands), str(commands[0]))
    facts = facts_in(place)
    # A busy sender leaves out samples; with the other address every second one would be out of range.
    frames = facts["frames"]["frames"]
    check(frames > 50 and max(facts["untrusted_samples"]) < 0.3 * frames, f"{facts['untrusted_samples']} of {frames}")


if __name__ == "__main__":
    sys.exit(run_tests(globals(), "".join(sys.argv[2:3])))
