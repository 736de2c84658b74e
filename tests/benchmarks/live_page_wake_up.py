#!/usr/bin/env python3
"""Wake-ups of `gauntlet live` with a page and a browser, of two programs (of before and of now) at the same time.

    tests/benchmarks/live_page_wake_up.py BEFORE NOW [SECONDS] [RUNS] [SLOW_CLIENTS]

Both have the same load at every moment, so their difference is that of the programs, also on a busy machine. Run it as
root; 15 s and 10 runs are a measurement. Slow clients send a byte now and then."""
import json
import pathlib
import re
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time


def connect(port):
    return socket.create_connection(("127.0.0.1", port), timeout=1)


def watch(port, token):
    try:
        with connect(port) as stream:
            stream.sendall(f"GET /events?token={token} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
            while stream.recv(65536):
                pass
    except OSError:
        pass


def be_slow(port, clients, ends):
    there = []
    while not ends.is_set():
        try:
            while len(there) < clients:
                there.append(connect(port))
        except OSError:
            pass
        for client in list(there):
            try:
                client.send(b"G")
            except OSError:
                client.close()
                there.remove(client)
        ends.wait(0.1)
    for client in there:
        client.close()


def run(program, seconds, clients, results):
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder) / "live"
        session = subprocess.Popen(
            [program, "live", "random_motion", "--controller", "raw", "--shadow", "tuned_kalman", "--page", "0", "--out",
             place, "--seconds", str(seconds), "--set", f"glove.motion.duration_s={seconds + 5}"],
            stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        address = next(filter(None, (re.search(r":(\d+)/\?token=(\w+)", line) for line in session.stderr)))
        port, token = int(address[1]), address[2]
        ends = threading.Event()
        for work, arguments in ((session.stderr.read, ()), (watch, (port, token)), (be_slow, (port, clients, ends))):
            threading.Thread(target=work, args=arguments, daemon=True).start()
        threading.Timer(seconds - 0.5, ends.set).start()  # some programs do not end before their clients do
        session.wait()
        late = json.loads((place / "live.json").read_text())["loop"]["lateness"]
        results.append([late[key] for key in ("p50_us", "p99_us", "p999_us", "max_us")])


def main():
    programs = [pathlib.Path(program).resolve() for program in sys.argv[1:3]]
    seconds, runs, clients = map(int, sys.argv[3:] + ["15", "10", "0"][len(sys.argv) - 3:])
    results = [[], []]
    for number in range(runs):
        threads = []
        for which in (0, 1) if number % 2 == 0 else (1, 0):
            threads.append(threading.Thread(target=run, args=(programs[which], seconds, clients, results[which])))
            threads[-1].start()
            time.sleep(0.3)
        for thread in threads:
            thread.join()
    for name, rows in zip(("before", "now"), results):
        print(f"{name:6}  medians of {runs} runs: p50 {{:.0f}}, p99 {{:.0f}}, p99.9 {{:.0f}}, max {{:.0f}} us"
              .format(*map(statistics.median, zip(*rows))))


main()
