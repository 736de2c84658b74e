#!/usr/bin/env python3
"""The process of the page of `gauntlet live`: whatever a client sends, however long it takes, and however that process
ends, the session goes on. All sizes here are small: 16 KB, 1 MB, 200 connections. Arguments: the program, and a part of
a test's name."""
import os
import pathlib
import re
import signal
import socket
import sys
import threading
import time

from page import Session
from sessions import check, run_tests

IS_SANITIZED = bool(os.environ.get("GAUNTLET_SANITIZE"))
SOON_S = 5.0 if IS_SANITIZED else 1.0
MOST_GROWN_KB = 1024  # of the process of the session
MOST_OF_PAGE_KB = 8192  # of what the process of the page has of its own
FOR_REQUEST_S = 2.0
MOST_CONNECTIONS = 256
MOST_STARTS = 4


def status_of(process, key):
    found = re.search(rf"^{key}:\s+(\d+)", pathlib.Path(f"/proc/{process}/status").read_text(), re.M)
    return int(found[1]) if found else 0


def children_of(process):
    return [int(child) for task in pathlib.Path(f"/proc/{process}/task").iterdir()
            for child in (task / "children").read_text().split()]


def processes_of(session):
    """That which starts the server, and the server."""
    keeper, = wait_for(lambda: children_of(session.process.pid), "no process of the page")
    server, = wait_for(lambda: children_of(keeper), "no server")
    return keeper, server


def is_there(process):
    """Not as one that has ended and that nobody has waited for."""
    try:
        return not re.search(r"^State:\s+[ZX]", pathlib.Path(f"/proc/{process}/status").read_text(), re.M)
    except (FileNotFoundError, ProcessLookupError):
        return False


def wait_for(find, problem, seconds=10.0):
    deadline_s = time.monotonic() + seconds
    while True:
        try:
            found = find()
        except (OSError, AssertionError):
            found = None
        if found:
            return found
        check(time.monotonic() < deadline_s, problem)
        time.sleep(0.02)


def watch(session):
    """Lines of standard error behind the address, as they come."""
    lines = []
    threading.Thread(target=lambda: lines.extend(iter(session.process.stderr.readline, "")), daemon=True).start()
    return lines


def end(session):
    session.process.send_signal(signal.SIGINT)
    code = session.process.wait(30)
    check(code == 0, f"exit code {code}")


def connect(session):
    return socket.create_connection(("127.0.0.1", session.port), timeout=10)


def answer_to(session, request):
    """All that comes back, for bytes of which the last may no longer be read."""
    with connect(session) as connection:
        try:
            connection.sendall(request)
        except OSError:
            pass
        answer = b""
        try:
            while part := connection.recv(65536):
                answer += part
        except OSError:
            pass
    return answer


def head(session, path="/", more=""):
    return f"GET {path}?token={session.token} HTTP/1.1\r\nHost: 127.0.0.1:{session.port}\r\n{more}\r\n".encode()


def commands(session):
    return next(session.events())["commands"]


def settled_kb(session):
    """Memory of the process of a session whose loop runs."""
    commands(session)
    time.sleep(1.0)
    return status_of(session.process.pid, "VmRSS")


def check_it_runs(session):
    before = commands(session)
    wait_for(lambda: commands(session) > before, "the session stands still")


def test_requests_of_more_than_8_kb_are_refused(place):
    session = Session(place / "live")
    _, server = processes_of(session)
    check(answer_to(session, head(session, more="A: " + "a" * 7900 + "\r\n")).startswith(b"HTTP/1.1 200"), "8 KB")
    own_kb, page_kb = settled_kb(session), status_of(server, "VmRSS")
    for size in (16 << 10, 1 << 20):
        for what, request in {"no end": b"GET /?" + b"a" * size,
                              "no line": b"a" * size,
                              "zeros": b"\0" * size,
                              "a field": head(session, more="A: " + "a" * size + "\r\n"),
                              "fields": head(session, more="A: b\r\n" * (size // 6)),
                              "a body": head(session, more=f"Content-Length: {size}\r\n") + b"a" * size,
                              "chunks": head(session, more="Transfer-Encoding: chunked\r\n")
                                        + b"a\r\n0123456789\r\n" * (size // 15)}.items():
            answer = answer_to(session, request)
            # Who sends on and on may be cut off before it has read.
            check(re.match(rb"HTTP/1\.1 4(00|13|31) |$", answer), f"{what} of {size}: {answer[:80]}")
            check(session.ask()[0] == 200, f"after {what} of {size}")
    for request in (b"GET /?" + b"a" * 8192, b"GET / HTTP/1.1\r\nA: " + b"a" * 8192):
        check(answer_to(session, request).startswith(b"HTTP/1.1 431"), "no 431")
    for size, expected in ((256, 400), (257, 413)):  # 256 letters are no controller's name
        check(session.ask("POST", "/switch", body="a" * size)[0] == expected, f"a body of {size}")
    check(processes_of(session)[1] == server, "the server was started again")
    if not IS_SANITIZED:
        grown_kb = status_of(session.process.pid, "VmRSS") - own_kb
        check(grown_kb < MOST_GROWN_KB, f"the session takes {grown_kb} KB more")
        grown_kb = status_of(server, "VmRSS") - page_kb
        check(grown_kb < MOST_OF_PAGE_KB, f"the page takes {grown_kb} KB more")
    check_it_runs(session)
    end(session)


def test_a_request_in_pieces_has_two_seconds(place):
    session = Session(place / "live")
    request = head(session)
    with connect(session) as connection:
        for byte in request:
            connection.send(bytes([byte]))
        check(connection.recv(12) == b"HTTP/1.1 200", "single bytes are not put together")
    with connect(session) as connection:
        body = b"still"
        connection.sendall(f"POST /mark?token={session.token} HTTP/1.1\r\nHost: 127.0.0.1:{session.port}\r\n"
                           f"Content-Length: {len(body)}\r\n\r\n".encode() + body[:2])
        time.sleep(0.2)
        connection.sendall(body[2:])
        check(connection.recv(12) == b"HTTP/1.1 202", "a body in two pieces")
    for parts in (b"", b"G", request[:-1]):
        begin_s = time.monotonic()
        with connect(session) as connection:
            connection.sendall(parts)
            check(connection.recv(1) == b"", "an answer to no request")
            passed_s = time.monotonic() - begin_s
            check(FOR_REQUEST_S - 0.2 < passed_s < FOR_REQUEST_S + 2 * SOON_S, f"closed after {passed_s:.1f} s")
    end(session)


def test_200_slow_clients_delay_no_good_request(place):
    session = Session(place / "live")
    _, server = processes_of(session)
    stream = session.events()
    own_kb = settled_kb(session)
    begin_s = next(stream)["time_s"]
    ends = threading.Event()

    def be_slow():
        """50 connections at a time that send a byte now and then; those that are closed come again."""
        clients = []
        while not ends.is_set():
            try:
                while len(clients) < 50:
                    clients.append(connect(session))
            except OSError:
                pass
            still = []
            for client in clients:
                try:
                    client.send(b"G")
                    still.append(client)
                except OSError:
                    client.close()
            clients = still
            time.sleep(0.1)
        for client in clients:
            client.close()

    threads = [threading.Thread(target=be_slow) for _ in range(4)]
    for thread in threads:
        thread.start()
    longest_s = 0.0
    try:
        for _ in range(20):
            time.sleep(0.2)
            asked_s = time.monotonic()
            status, page, _ = session.ask()
            longest_s = max(longest_s, time.monotonic() - asked_s)
            check(status == 200 and page.rstrip().endswith("</html>"), f"{status}, {len(page)} letters")
        check(session.ask("POST", "/switch", body="tuned_kalman")[0] == 202, "no switch")
        check(next(moment for moment in stream if moment["driving"] == 1)["time_s"] > begin_s + 3.0, "an old moment")
    finally:
        ends.set()
        for thread in threads:
            thread.join()
    check(longest_s < SOON_S, f"a good request took {longest_s:.2f} s")
    grown_kb = status_of(session.process.pid, "VmRSS") - own_kb
    check(IS_SANITIZED or grown_kb < MOST_GROWN_KB, f"the session takes {grown_kb} KB more")
    check(processes_of(session)[1] == server, "the server was started again")
    end(session)


def test_four_browsers_watch_until_the_end(place):
    session = Session(place / "live")
    streams = [connect(session) for _ in range(4)]
    for stream in streams:
        stream.sendall(head(session, "/events"))
        check(stream.recv(12) == b"HTTP/1.1 200", "no stream")
    fifth = answer_to(session, head(session, "/events"))
    check(fifth.startswith(b"HTTP/1.1 503") and b"\r\nRetry-After: 5\r\n" in fifth, fifth.decode())
    streams.pop().close()
    wait_for(lambda: next(session.events()), "no stream in place of another")
    received = [b""] * len(streams)

    def read(i):
        while part := streams[i].recv(65536):
            received[i] += part

    threads = [threading.Thread(target=read, args=(i,)) for i in range(len(streams))]
    for thread in threads:
        thread.start()
    time.sleep(0.5)
    end(session)
    for thread in threads:
        thread.join()
    for text in received:
        check(text.count(b'"commands":') > 10 and text.endswith(b'\n\ndata: {"has_ended":true}\n\n'), str(text[-200:]))


def test_a_connection_too_many_ends_the_oldest(place):
    session = Session(place / "live")
    stream = session.events()
    next(stream)
    begin_s = time.monotonic()
    clients = [connect(session) for _ in range(MOST_CONNECTIONS + 40)]
    check(session.ask()[0] == 200, "no room for a good request")
    clients[0].settimeout(SOON_S)
    ended = clients[0].recv(1)
    passed_s = time.monotonic() - begin_s
    if passed_s < FOR_REQUEST_S - 0.2:  # else its time is over
        check(ended == b"", "the oldest connection is still there")
        clients[-1].settimeout(0.1)
        try:
            check(clients[-1].recv(1) != b"", "the newest connection was ended")
        except socket.timeout:
            pass
        clients[-1].sendall(head(session))
        clients[-1].settimeout(SOON_S)
        check(clients[-1].recv(12) == b"HTTP/1.1 200", "no answer to the newest")
    next(stream)
    for client in clients:
        client.close()
    end(session)


def has_two_sockets(process):
    """Beside the standard streams: that of the session, and the one that listens."""
    try:
        files = [os.readlink(file) for file in pathlib.Path(f"/proc/{process}/fd").iterdir()]
    except PermissionError:  # only root sees them
        return True
    others = [file for file in files if file != "/dev/null"]
    return len(files) == 5 and len(others) == 2 and all(file.startswith("socket:") for file in others)


def test_the_process_has_limits(place):
    session = Session(place / "live")
    check(session.ask()[0] == 200, "no page")
    for process in processes_of(session):
        limits = pathlib.Path(f"/proc/{process}/limits").read_text()
        check(re.search(r"Max core file size +0 +0 ", limits) and re.search(r"Max file size +0 +0 ", limits), limits)
        check(int(re.search(r"Max open files +(\d+)", limits)[1]) < 300, limits)
        address_space = re.search(r"Max address space +(\S+)", limits)[1]
        check(IS_SANITIZED or int(address_space) < (status_of(process, "VmSize") << 10) + (40 << 20), limits)
        check(status_of(process, "VmLck") == 0, "the memory of the page is locked")
        check(status_of(process, "Threads") == 1 or IS_SANITIZED, "threads")
        check(status_of(process, "NoNewPrivs") == 1, "new rights")
        wait_for(lambda: has_two_sockets(process), f"open files of {process}")
    end(session)


def test_a_page_that_ends_starts_again(place):
    session = Session(place / "live")
    lines = watch(session)
    first = commands(session)
    for start in range(1, MOST_STARTS):
        keeper, server = processes_of(session)
        os.kill(server, signal.SIGKILL)
        wait_for(lambda: children_of(keeper) not in ([], [server]), "no other server")
        check(wait_for(session.ask, "no page again")[0] == 200, "another token")
        wait_for(lambda: len(lines) == start, str(lines))
        check("ended by signal 9 (Killed); it starts again" in lines[-1], str(lines))
    check(commands(session) > first, "the session did not go on")
    check(session.ask("POST", "/switch", body="tuned_kalman")[0] == 202, "no switch")
    wait_for(lambda: next(session.events())["driving"] == 1, "no switch by another server")
    keeper, server = processes_of(session)
    os.kill(server, signal.SIGKILL)
    wait_for(lambda: "no page any more" in lines[-1], str(lines))
    wait_for(lambda: not is_there(keeper), "a process is left")
    time.sleep(0.2)
    check(len(lines) == MOST_STARTS and session.process.poll() is None, str(lines))
    try:
        connect(session).close()
        check(False, "someone listens at the address")
    except ConnectionRefusedError:
        pass
    end(session)
    check((place / "live" / "live.json").exists(), "no results")


def test_a_session_goes_on_without_all_of_it(place):
    session = Session(place / "live")
    lines = watch(session)
    keeper, server = processes_of(session)
    os.kill(keeper, signal.SIGKILL)
    wait_for(lambda: lines, "nothing is said")
    wait_for(lambda: not is_there(server), "the server is left")
    time.sleep(0.5)
    check(len(lines) == 1 and "the process of the page is gone" in lines[0], str(lines))
    end(session)


def test_a_page_that_stands_still_delays_nothing(place):
    session = Session(place / "live")
    _, server = processes_of(session)
    events = session.events()
    begin = next(events)
    os.kill(server, signal.SIGSTOP)
    time.sleep(6.0)  # longer than moments have room for
    os.kill(server, signal.SIGCONT)
    wait_for(lambda: next(session.events())["time_s"] > begin["time_s"] + 5.0, "old moments alone")
    after = next(session.events())
    commands_s = (after["commands"] - begin["commands"]) / 50.0
    skipped_s = (after["skipped"] - begin["skipped"]) / 1000.0
    check(commands_s > after["time_s"] - begin["time_s"] - skipped_s - 0.2, "commands are missing")
    os.kill(server, signal.SIGSTOP)
    begin_s = time.monotonic()
    end(session)
    check(time.monotonic() - begin_s < 10 + 4 * SOON_S, "the end waits for it")
    check(not is_there(server), "the server is left")


def test_nothing_is_left_of_a_session_that_is_killed(place):
    for number in (signal.SIGKILL, signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        session = Session(place / f"{number}")
        processes = processes_of(session)
        stream = session.events()
        next(stream)
        session.process.send_signal(number)
        session.process.wait(30)
        wait_for(lambda: not any(map(is_there, processes)), f"signal {number} left a process", 2.0 * SOON_S)
        try:
            connect(session).close()
            check(False, "someone listens at the address")
        except ConnectionRefusedError:
            pass


if __name__ == "__main__":
    sys.exit(run_tests(globals(), "".join(sys.argv[2:3])))
