#!/usr/bin/env python3
"""The page of `gauntlet live` as a whole command: who may see it, what switches the controller, and what browsers that
do not read cost a session. In Chromium, too, where there is one."""
import http.client
import json
import pathlib
import re
import signal
import socket
import subprocess
import sys
import threading
import time

import chromium
from sessions import LARGEST_STEP, check, run_tests

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
PAPER_R_COUNTS2 = [21.18, 12.52, 10.62, 9.86, 26.94, 10.08, 9.71, 17.58, 6.05, 9.91, 47.19, 11.04, 7.56, 23.94, 26.82,
                   28.82, 27.69, 31.49]


class Session:
    """A running session, and requests as they should not be."""

    def __init__(self, place, *arguments, motion="glove.motion.duration_s=120"):
        self.place = place
        self.process = subprocess.Popen(
            [PROGRAM, "live", "random_motion", "--controller", "raw", "--shadow", "tuned_kalman",
             "--page", "0", "--out", place, "--set", motion, *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for line in self.process.stderr:
            found = re.search(r"page at (http://127\.0\.0\.1:(\d+)/\?token=([0-9a-f]{32}))$", line)
            if found:
                break
        else:
            raise AssertionError("no address was printed")
        self.address, self.port, self.token = found[1], int(found[2]), found[3]

    def ask(self, method="GET", path="/", token=None, body=None, headers=()):
        """Status and body. The headers replace those of a browser."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=10)
        token = self.token if token is None else token
        connection.putrequest(method, path + ("?token=" + token if token else ""), skip_host=True)
        for name, value in {"Host": f"127.0.0.1:{self.port}", "Connection": "close",
                            **({"Content-Length": str(len(body))} if body is not None else {}),
                            **dict(headers)}.items():
            connection.putheader(name, value)
        connection.endheaders(body.encode() if body is not None else None)
        response = connection.getresponse()
        answer = response.status, response.read().decode(), response
        connection.close()
        return answer

    def events(self):
        """A stream of moments."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=10)
        connection.request("GET", "/events?token=" + self.token)
        response = connection.getresponse()
        check(response.status == 200, f"events: {response.status}")
        check(response.getheader("Content-Type").startswith("text/event-stream"), "no event stream")
        for line in response:
            if line.startswith(b"data: {"):
                moment = json.loads(line[6:])
                if "has_ended" in moment:
                    return
                yield moment

    def end(self, exit_code=0):
        self.process.send_signal(signal.SIGINT)
        out, err = self.process.communicate(timeout=30)
        check(self.process.returncode == exit_code, f"exit code {self.process.returncode}: {err}")
        return out, err, json.loads((self.place / "live.json").read_text())


def test_only_the_address_that_was_printed_shows_the_page(place):
    session = Session(place / "live")
    status, page, response = session.ask()
    check(status == 200 and "<h1>random_motion</h1>" in page, f"page: {status}")
    policy = response.getheader("Content-Security-Policy")
    check("default-src 'none'" in policy and "unsafe-eval" not in policy, policy)
    nonce = re.search(r"script-src 'nonce-([0-9a-f]{32})'", policy)[1]
    check(f'nonce="{nonce}"' in page and session.token not in page, "nonce or token of the page")
    check(not re.search(r'(?:src|href)="(?!data:|#)', page), "the page loads something")
    check(response.getheader("Access-Control-Allow-Origin") is None, "other pages may read it")
    own = f"http://127.0.0.1:{session.port}"
    wrong = "0" * 32 if session.token != "0" * 32 else "1" * 32
    for method, path in (("GET", "/"), ("GET", "/events"), ("POST", "/switch"), ("POST", "/mark"), ("GET", "/nothing")):
        body = {"/switch": "tuned_kalman", "/mark": "still"}.get(path)
        for what, changes in {
                "no token": {"token": ""}, "a wrong token": {"token": wrong},
                "a part of the token": {"token": session.token[:31]},
                "another host": {"headers": {"Host": f"evil.test:{session.port}"}},
                "another port": {"headers": {"Host": f"127.0.0.1:{session.port + 1}"}},
                "no port": {"headers": {"Host": "127.0.0.1"}},
                "another origin": {"headers": {"Origin": "http://evil.test"}},
                "no origin of a page": {"headers": {"Origin": "null"}},
                "another scheme": {"headers": {"Origin": own.replace("http", "https")}}}.items():
            status, answer, _ = session.ask(method, path, body=body, **changes)
            check(status == 403, f"{method} {path} with {what}: {status} {answer[:80]}")
    check(session.ask(headers={"Origin": own})[0] == 200, "its own origin is refused")
    check(session.ask(headers={"Host": f"localhost:{session.port}"})[0] == 200, "localhost is refused")
    check(session.ask(path="/nothing")[0] == 404, "an unknown path")
    check(session.ask(path="/switch")[0] == 404, "a GET switches")
    for method in ("PUT", "DELETE", "OPTIONS"):
        check(session.ask(method, "/switch")[0] in (400, 404), f"{method} is answered")
    check(session.ask("POST", "/switch", body="x" * 100000)[0] == 413, "a large body")
    check(session.ask("POST", "/switch", body="one_euro")[0] == 400, "a controller of no session")
    check(session.ask("POST", "/switch", body="")[0] == 400, "no controller")
    check(session.ask("POST", "/mark", body="asleep")[0] == 400, "a mark that there is not")
    time.sleep(0.3)
    check(next(session.events())["driving"] == 0, "a refused request switched the controller")
    _, _, facts = session.end()
    check("still" not in facts and not (place / "live" / "counts.csv").exists(), "a refused mark counts")
    check("switches" not in facts, str(facts.get("switches")))


def largest_difference_deg(moment):
    return max(abs(a - b) for a, b in zip(moment["glove_deg"], moment["command_deg"]))


def test_switch_changes_the_controller_without_a_jump(place):
    motors = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    motors.bind(("127.0.0.1", 0))
    motors.settimeout(2)
    session = Session(place / "live", "--motors", f"udp:127.0.0.1:{motors.getsockname()[1]}")
    events = session.events()
    next(event for event in events if event["time_s"] > 1.0)
    check(session.ask("POST", "/switch", body="tuned_kalman")[0] == 202, "the switch is refused")
    status, _, response = session.ask("POST", "/switch", body="raw")
    check(status == 429 and response.getheader("Retry-After"), f"no limit of the rate: {status}")
    next(event for event in events if event["driving"] == 1)
    filtered = [event for _, event in zip(range(60), events)]
    check(all(event["driving"] == 1 for event in filtered), "it switched back by itself")
    check(session.ask("POST", "/switch", body="raw")[0] == 202, "the way back is refused")
    next(event for event in events if event["driving"] == 0)
    raw = [event for _, event in zip(range(60), events)]
    # Without a filter the command is the glove's sample; the joints have the names of the channels.
    check(max(map(largest_difference_deg, raw)) < 0.02, "the command of raw is not the glove's sample")
    check(sum(largest_difference_deg(event) > 0.1 for event in filtered) > 50,
          "the command of the filter is the glove's sample")
    out, err, facts = session.end()
    check([switch["controller"] for switch in facts["switches"]["first"]] == ["tuned_kalman", "raw"],
          str(facts["switches"]))
    check(facts["switches"]["count"] == 2 and "Switches of the controller: 2" in out, out)
    first_s = facts["switches"]["first"][0]["time_s"]
    check(f"until the first switch after {first_s:.2f} s" in err, err)
    frames = []
    motors.settimeout(0.2)
    try:
        while True:
            for line in motors.recv(65536).decode().splitlines():
                if not line.startswith("frame"):
                    cells = line.split(",")
                    frames.append((int(cells[0]), [float(cell) for cell in cells[2:]]))
    except socket.timeout:
        pass
    check(len(frames) > 100, f"only {len(frames)} commands")
    for (number, before), (following, after) in zip(frames, frames[1:]):
        for a, b in zip(before, after):
            check(abs(b - a) <= LARGEST_STEP * (following - number), f"a jump from {a} to {b}")
    trace = (place / "live" / "scores.csv").read_text()
    check("raw" in trace and "tuned_kalman" not in trace, "scores of another controller")


def test_session_scores_are_those_of_the_report(place):
    session = Session(place / "live", "--seconds", "9.6", motion="glove.motion.duration_s=12")
    shown = []
    try:
        for event in session.events():
            check([len(angles) for angles in event["asked_deg"]] == 2 * [len(event["hand_deg"])], "angles of two controllers")
            if "scores" in event:
                shown.append(event["scores"])
    except http.client.IncompleteRead:
        pass
    session.process.communicate(timeout=30)
    facts = json.loads((place / "live" / "live.json").read_text())
    check(len(shown) > 5, f"only {len(shown)} scores in 9 s")
    check(shown[0]["controllers"][0][0] < 1.3 and shown[0]["controllers"][0][1] is None, f"jitter of too little: {shown[0]}")
    last = shown[-1]
    check(last["time_s"] > 7.5, str(last))
    for numbers, scored in zip(last["controllers"], facts["controllers"], strict=True):
        over_s, jitter_deg, delay_ms = numbers
        check(abs(over_s - last["time_s"]) < 0.01, str(last))
        # The report's are of the last second, too.
        check(abs(jitter_deg / scored["jitter_rms_deg"] - 1) < 0.1, f"{numbers} beside {scored}")
        check(abs(delay_ms - scored["delay_ms"]) < 4, f"{numbers} beside {scored}")
    raw, filtered = last["controllers"]
    check(filtered[1] < 0.8 * raw[1], f"a filter does not lower the jitter: {last}")


def test_outage_is_in_every_moment(place):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    way = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    ends = threading.Event()
    silent = threading.Event()

    def send():
        while not ends.wait(0.01):
            if not silent.is_set():
                way.sendto(b"index_mcp_counts,middle_mcp_counts\n500,600\n", ("127.0.0.1", port))

    threading.Thread(target=send, daemon=True).start()
    session = Session(place / "live", "--glove", f"udp:127.0.0.1:{port}", "--set", "glove.channels=[index_mcp,middle_mcp]",
                      motion="glove.rate_hz=100")
    page = chromium.Page(session.address, 390, 900) if chromium.has_browser() else None
    events = session.events()
    try:
        first = next(event for event in events if event["time_s"] > 1.0)
        check(first["silent_s"] < 0.5, f"silent with samples: {first['silent_s']}")
        silent.set()
        longest_s, tier = 0.0, 0
        for event in events:
            check(event["silent_s"] < longest_s + 1.0, f"{event['silent_s']} s after {longest_s} s")
            longest_s, tier = max(longest_s, event["silent_s"]), max(tier, event["tier"])
            if longest_s > 1.5:
                break
        check(tier == 3, f"the watchdog reached tier {tier} only")
        banner = 'document.getElementById("live-banner")'
        if page:
            page.wait_for(f"!{banner}.hidden && {banner}.innerText.startsWith('No samples from the glove. No commands are sent.')")
            seconds = page.value("Number(document.getElementById('live-banner-time').textContent.split(' ')[0])")
            check(1.0 < seconds < 60, f"silent for {seconds} s")
        silent.clear()
        next(event for event in events if event["tier"] == 0 and event["silent_s"] < 0.5)
        if page:
            page.wait_for(f"{banner}.innerText.startsWith('The glove was silent. Its samples are back.')")
            page.wait_for(f"{banner}.hidden")
    finally:
        if page:
            page.close()
        ends.set()
    session.end()


def test_marks_give_calibrate_the_noise(place):
    session = Session(place / "live",
                      motion="glove.motion={kind: moves, postures: [rest, open], move_s: 0.2, hold_s: 60}")
    events = session.events()
    next(event for event in events if event["time_s"] > 0.5)
    for body, is_still in (("still", True), ("moving", False), ("still", True)):
        check(session.ask("POST", "/mark", body=body)[0] == 202, f"{body} is refused")
        begin_s = next(event["time_s"] for event in events if event["is_still"] == is_still)
        next(event for event in events if event["time_s"] > begin_s + 1.0)
    out, _, facts = session.end()
    still = facts["still"]
    check(len(still) == 2 and all(stretch["end_s"] - stretch["begin_s"] > 0.9 for stretch in still), str(still))
    command = re.search(r"gauntlet (calibrate \S+/counts\.csv(?: --still \S+){2})", " ".join(out.split()))
    check(command, out)
    run = subprocess.run([PROGRAM, *command[1].split(), "--json", "--out", place / "noise.yaml"],
                         capture_output=True, text=True, timeout=30)
    check(run.returncode == 0, run.stderr)
    ratios = [channel["variance_counts2"] / r for channel, r in
              zip(json.loads(run.stdout)["channels"], PAPER_R_COUNTS2, strict=True)]
    check(0.8 < min(ratios) and max(ratios) < 1.25, f"noise of the simulated glove: {ratios} times what it is")


def test_browsers_that_do_not_read_cost_a_session_nothing(place):
    def deaf(session, request):
        connection = socket.create_connection(("127.0.0.1", session.port))
        connection.sendall(request.encode())
        return connection

    session = Session(place / "live")
    events = session.events()
    before = next(events)
    stream = (f"GET /events?token={session.token} HTTP/1.1\r\n"
              f"Host: 127.0.0.1:{session.port}\r\n\r\n")
    connections = [deaf(session, "") for _ in range(20)] + [deaf(session, stream) for _ in range(20)]
    connections += [deaf(session, stream[:40]) for _ in range(20)]
    moments = []
    for event in events:
        moments.append(event)
        if event["time_s"] > before["time_s"] + 4.0:
            break
    # A busy machine leaves out moments and ticks, and with a tick its command; browsers do neither.
    check(len(moments) > 20, f"the page got {len(moments)} moments in 4 s")
    first, last = moments[0], moments[-1]
    expected = 50.0 * (last["time_s"] - first["time_s"])
    missing = expected - (last["commands"] - first["commands"])
    check(abs(missing) <= 2 + last["skipped"] - first["skipped"], f"{missing} of {expected} commands are missing")
    check(missing < 0.5 * expected, f"{missing} of {expected} commands are missing")
    begin = time.monotonic()
    _, _, facts = session.end()
    check(time.monotonic() - begin < 15, "the end waits for browsers")
    check(facts["duration_s"] > 4.0, str(facts["duration_s"]))
    for connection in connections:
        connection.close()


def test_port_of_another_is_one_line(place):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        for arguments, words in ((["--page", port], f"--page {port}: cannot be had"),
                                 (["--page", "70000"], "65535"), (["--listen", "127.0.0.1"], "--page"),
                                 (["--page", "0", "--listen", "localhost"], "IPv4"),
                                 (["--page", "0", "--listen", "192.0.2.1"], "not of this computer")):
            run = subprocess.run([PROGRAM, "live", "random_motion", "--controller", "raw", "--seconds",
                                  "1", "--out", place / "none", *arguments], capture_output=True,
                                 text=True, timeout=30)
            check(run.returncode == 2 and words in run.stderr and run.stderr.count("\n") == 1,
                  f"{arguments}: {run.returncode} {run.stderr}")
    check(not (place / "none").exists(), "a folder was left")


def test_page_in_a_browser(place):
    if not chromium.has_browser():
        print("skipped: no chromium")
        return
    session = Session(place / "live", "--seconds", "120")
    page = chromium.Page(session.address, 390, 900, dark=True)
    try:
        page.wait_for("window.livePage?.moments.length > 20 && document.querySelector('#live-stages td')")
        shown = page.value("""({state: document.getElementById("live-state").textContent,
          lines: document.querySelectorAll("#live-plot path").length,
          buttons: [...document.querySelectorAll("#live-choice button")].map((b) => b.textContent),
          wide: document.documentElement.scrollWidth > innerWidth})""")
        check(shown["lines"] == 4 and shown["buttons"] == ["raw", "tuned_kalman"], str(shown))
        check(not shown["wide"], "the page is wider than a phone")
        for hand, angles in (("hand", "last.hand_deg"), ("other", "last.asked_deg[1]"), ("ghost", "gloveAngles(livePage.last)")):
            angle = page.value(f"livePage.{hand}.angleOf(0) - livePage.{angles}[0]")
            check(abs(angle) < 0.01, f"{hand} is off by {angle} deg")
        # The joints have the names of the channels.
        angle = page.value("Math.max(...livePage.gloveAngles(livePage.last).map((a, j) => Math.abs(a - livePage.last.glove_deg[j])))")
        check(angle < 0.01, f"the wearer is off by {angle} deg")
        names = "document.getElementById('live-names').innerText.split('\\n').join(' ')"
        check(page.value(names) == "Solid: raw tuned_kalman wearer", page.value(names))
        scores = "[...document.querySelectorAll('#live-choice td')].map((cell) => Number(cell.textContent))"
        page.wait_for(f"{scores}.every((number) => number > 0)")
        # The scores of the moment, rounded; newer ones are drawn a little later.
        page.wait_for(f"((cells, newest) => cells.length === newest.length && "
                      f"cells.every((cell, i) => Math.abs(cell / newest[i] - 1) < 0.005))"
                      f"({scores}, livePage.scores.controllers.flatMap((c) => c.slice(1)))")
        page.value("document.querySelectorAll('#live-choice button')[0].focus()")
        page.press("Tab")
        page.press("Enter")
        page.wait_for(f"isNaN({scores}[3])")  # for 4 s: a controller that has just taken over has no delay
        page.wait_for("document.querySelectorAll('#live-choice button')[1].ariaPressed === 'true'")
        page.wait_for("document.getElementById('live-state').textContent.startsWith('tuned_kalman drives')")
        page.wait_for(f"{names} === 'Solid: tuned_kalman raw wearer'")
        dots = page.value("[...document.querySelectorAll('#live-names .dot')].map((dot) => dot.style.getPropertyValue('--colour'))")
        check(dots == ["var(--second)", "var(--wearer)"], f"raw is grey before the grey hand: {dots}")
        answer, still = "document.getElementById('live-answer')", "document.getElementById('live-still')"
        page.wait_for(f"{answer}.textContent === ''")
        page.value(f"{still}.click()")
        page.wait_for(f"{still}.textContent === 'Hand moves again' && {answer}.textContent === 'Marked still.'")
        page.value(f"{still}.click()")
        page.wait_for(f"{still}.textContent === 'Hand is still' && {answer}.textContent === ''")
        session.process.send_signal(signal.SIGINT)
        page.wait_for("document.getElementById('live-state').textContent === 'The report is in the terminal.'")
        check(page.value("document.getElementById('live-banner-text').textContent").startswith("The session has ended"), "the end")
        problems = [text for text in page.problems if '"level": "warning"' not in text]
        check(not problems, "\n".join(problems))
    finally:
        page.close()
    session.process.communicate(timeout=30)


if __name__ == "__main__":
    sys.exit(run_tests(globals(), "".join(sys.argv[2:3])))
