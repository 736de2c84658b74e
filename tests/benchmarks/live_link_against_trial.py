#!/usr/bin/env python3
"""The law of the live loop behind a link: a scenario whose glove comes by WiFi has the same delay (within 2 ms) and
jitter (within 10 %) in a trial, where the link is simulated, and live, where `gauntlet glove` delays and loses the
frames on this computer's loopback.

    tests/benchmarks/live_link_against_trial.py build/release/sim/cli/gauntlet [SECONDS]

Live knows the way of a frame only relative to its fastest one. So this script matches the rows of the recording with
the samples of the glove by their values, and takes the median of the preset, P50_MS, as that of the session. Both
delays are the shift of the true motion that fits best to the hand. Needs python3-h5py and python3-scipy."""
import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy
import scipy.optimize

SCENARIO = "random_motion"
CONTROLLER = "raw"
P50_MS = 13.3  # of the preset wifi
TICK_HZ = 1000
TICKS_PER_SAMPLE = 10


def scores(folder):
    return json.loads((folder / "scores.json").read_text())["controllers"][0]["summary"]


def signals(folder):
    """True motion, linearised samples and hand, row by row per tick [rad]."""
    with h5py.File(folder / "trace.h5") as file:
        controller = file["controllers"][CONTROLLER]
        return [signal[()] for signal in (file["glove/true_angle_rad"], controller["linearised_angle_rad"],
                                          controller["hand_angle_rad"])]


def delay_ms(truth_rad, hand_rad, offset_ms):
    """Shift of the truth that fits best to the hand, both row by row per ms; the truth begins `offset_ms` late."""
    time_ms = numpy.arange(1000, len(hand_rad))
    truth_ms = numpy.arange(len(truth_rad))

    def error(shift_ms):
        at_ms = time_ms - offset_ms - shift_ms
        inside = (at_ms >= 0) & (at_ms <= truth_ms[-1])
        return sum(numpy.mean((numpy.interp(at_ms[inside], truth_ms, truth) - hand[time_ms[inside]]) ** 2)
                   for truth, hand in zip(truth_rad.T, hand_rad.T))

    coarse = min(range(0, 400, 5), key=error)
    return scipy.optimize.minimize_scalar(error, bounds=(coarse - 5, coarse + 5), method="bounded").x


def way_ms(linearised_rad, recording_deg):
    """Of each row of the recording: its arrival after the sample's own time on the glove."""
    samples_deg = numpy.degrees(linearised_rad[::TICKS_PER_SAMPLE, :6])
    ways = []
    for arrival_s, *values in recording_deg:
        distance = numpy.abs(samples_deg - values[:6]).max(axis=1)
        sample = int(distance.argmin())
        if distance[sample] < 2e-3:
            ways.append(1e3 * arrival_s - sample * TICKS_PER_SAMPLE)
    return numpy.array(ways)


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    seconds = int(sys.argv[2]) if len(sys.argv) > 2 else 40
    glove = ["--set", f"glove.motion.duration_s={seconds}", "--set", "glove.rate_hz=100"]
    link = ["--set", "link.glove.preset=wifi"]
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        for name, settings in (("cable", glove), ("trial", glove + link)):
            subprocess.run([program, "run", SCENARIO, "--controllers", CONTROLLER, "--causes", "none", *settings,
                            "--out", place / name], check=True, capture_output=True)
        address = "udp:127.0.0.1:9417"
        live = subprocess.Popen([program, "live", SCENARIO, "--controller", CONTROLLER, "--glove", address,
                                 "--seconds", str(seconds - 2), *glove, *link, "--out", place / "live"],
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        next(line for line in live.stderr if "waiting for frames" in line)
        subprocess.run([program, "glove", SCENARIO, "--to", address, *glove, *link], check=True, capture_output=True)
        live.communicate(timeout=60)
        _, linearised, cable_hand = signals(place / "cable")
        truth, _, hand = signals(place / "trial")
        _, _, live_hand = signals(place / "live")
        recording = numpy.genfromtxt(place / "live" / "recording.csv", delimiter=",", skip_header=1)
        trial_scores, live_scores = scores(place / "trial"), scores(place / "live")
        loop = json.loads((place / "live" / "live.json").read_text())["loop"]
    ways = way_ms(linearised, recording)
    offset_ms = numpy.median(ways) - P50_MS
    spread = numpy.percentile(ways - offset_ms, [50, 95, 99])
    print(f"{SCENARIO}, {CONTROLLER}: {len(ways)} of {len(recording)} rows matched; way p50, p95, p99: "
          f"{spread[0]:.1f}, {spread[1]:.1f}, {spread[2]:.1f} ms; skipped ticks {loop['skipped_ticks']} of {loop['ticks']}")
    delays = delay_ms(truth, hand, 0.0), delay_ms(truth, live_hand, offset_ms)
    jitters = trial_scores["jitter_rms_deg"], live_scores["jitter_rms_deg"]
    print(f"delay: trial {delays[0]:.1f}, live {delays[1]:.1f} ms (score of the trial: {trial_scores['delay_ms']:.1f}; "
          f"without the link: {delay_ms(truth, cable_hand, 0.0):.1f})")
    print(f"jitter: trial {jitters[0]:.4g}, live {jitters[1]:.4g} deg RMS")
    is_kept = (len(ways) > 0.95 * len(recording) and abs(delays[1] - delays[0]) <= 2.0
               and abs(jitters[1] / jitters[0] - 1.0) <= 0.1)
    print("the law holds" if is_kept else "the law does NOT hold")
    return 0 if is_kept else 1


if __name__ == "__main__":
    sys.exit(main())
