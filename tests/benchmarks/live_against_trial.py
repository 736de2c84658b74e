#!/usr/bin/env python3
"""The law of the live loop: the same scenario as a trial and live, with the glove over UDP on this
computer, has a delay within 2 ms and a jitter within 10 %.

    tests/benchmarks/live_against_trial.py build/release/sim/cli/gauntlet [SCENARIO CONTROLLER]

Live runs first. The trial plays the recording of the session, so both have the same samples and the
same reference."""
import json
import pathlib
import socket
import subprocess
import sys
import tempfile


def scores(folder):
    controllers = json.loads((folder / "scores.json").read_text())["controllers"]
    return controllers[0]["summary"]


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    scenario, controller = sys.argv[2:4] if len(sys.argv) > 3 else ("door_opening", "raw")
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        address = f"udp:127.0.0.1:{free_port()}"
        with subprocess.Popen([program, "glove", scenario, "--to", address, "--seconds", "30"],
                              stderr=subprocess.DEVNULL) as glove:
            subprocess.run([program, "live", scenario, "--controller", controller, "--glove", address,
                            "--seconds", "20", "--out", place / "live"], check=True,
                           capture_output=True)
            glove.terminate()
        subprocess.run([program, "run", place / "live" / "scenario.resolved.yaml", "--causes", "none",
                        "--out", place / "trial"], check=True, capture_output=True)
        live, trial = scores(place / "live"), scores(place / "trial")
        facts = json.loads((place / "live" / "live.json").read_text())
    loop = facts["loop"]
    print(f"{scenario}, {controller}: skipped ticks {loop['skipped_ticks']} of {loop['ticks']}, "
          f"wake-up p99 {loop['lateness']['p99_us']:.0f} us, "
          f"age of a sample p99 {facts['total']['p99_us']:.0f} us")
    for key in ("delay_ms", "jitter_rms_deg", "tracking_rmse_deg"):
        print(f"{key}: trial {trial[key]:.4g}, live {live[key]:.4g}")
    is_kept = (abs(live["delay_ms"] - trial["delay_ms"]) <= 2.0
               and abs(live["jitter_rms_deg"] / trial["jitter_rms_deg"] - 1.0) <= 0.1)
    print("the law holds" if is_kept else "the law does NOT hold")
    return 0 if is_kept else 1


if __name__ == "__main__":
    sys.exit(main())
