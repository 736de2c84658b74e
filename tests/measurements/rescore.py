#!/usr/bin/python3
"""Recomputes the scores of a run from its trace, without any code of Gauntlet.

    gauntlet run scenarios/random_motion.yaml --out out/random_motion
    tests/measurements/rescore.py out/random_motion [--tolerance 0.001] [--rows]

Written from the definitions in docs/explanation/scores.md and `gauntlet list metrics`. Every value of
scores.json, of each joint, motor and cable and of the summary, is held against what trace.h5 says of
it, and the largest relative difference of each metric is printed. A score that exists on one side only
differs by inf. What the motors of the project's hand pull and turn is read from docs/evidence/hand.md, its
kinematics from models/.

Needs numpy, scipy and h5py (python3-h5py and python3-scipy of Debian). Exit code: 0 all within the
tolerance; 1 one is beyond, a metric is unknown to this script, or a library is missing; 2 the folder
cannot be used (a comparison of several seeds has the trace of the first only).
"""
import argparse
import json
import os
import re
import sys
from xml.etree import ElementTree

import h5py
import numpy as np
from scipy import signal

NAN = float("nan")
# Differences up to this count as none, in the metric's own unit. Angles in the trace are 32-bit floats: one of
# 2 rad is known to 7e-6 deg.
FLOOR = 1e-5
# The same for what is split by thresholds of the wearer's angle and speed (60 deg/s, the turning point of a slow
# movement): a 32-bit float passes them some ticks earlier or later.
FLOOR_OF_SPLIT_DEG = 0.003
# The same for a part of the error: such a float times an error of some deg.
FLOOR_OF_PART_DEG2 = 1e-4
# What the trials in which one cause of the error after the other is taken away are called in the trace.
WITHOUT = {"noise": "noise_free_hand_angle_rad", "glove": "without_glove_hand_angle_rad",
           "link_loss": "without_link_loss_hand_angle_rad", "link_jitter": "without_link_jitter_hand_angle_rad",
           "link": "without_link_hand_angle_rad", "saturation": "without_saturation_hand_angle_rad",
           "friction": "without_friction_hand_angle_rad", "servo": "without_servo_hand_angle_rad",
           "rest": "asked_angle_rad"}
# The trials in which one cause alone is switched off; they may be the first seconds of the motion.
ALONE = {"noise": "noise_free_hand_angle_rad"} | {cause: f"without_{cause}_alone_hand_angle_rad" for cause in (
    "glove", "link", "saturation", "friction", "servo")}
ERROR_PARTS = [f"error_{cause}_deg2" for cause in (*WITHOUT, "controller")]
NO_SUMMARY = {"tension_peak_n"}  # a finger's cable and a shoulder's are not alike
SPLIT = re.compile("(rest|slow|fast|onset|reversal)_.*_deg|overshoot_deg")


# Building blocks


def rms(x):
    return np.sqrt(np.mean(np.square(x))) if len(x) else NAN


def half_up(x):
    """To the nearest whole number; halves away from 0."""
    return int(np.copysign(np.floor(abs(x) + 0.5), x))


def fast_size(least):
    """The smallest 4^a 3^b 5^c that is not below `least`."""
    best = None
    five = 1
    while best is None or five < best:
        size = five
        while best is None or size < best:
            candidate = size
            while candidate < least:
                candidate *= 4
            best = candidate if best is None else min(best, candidate)
            size *= 3
        five *= 5
    return best


def low_pass(cutoff_hz, transition_hz, rate_hz):
    """Weights of a sinc in a Kaiser window of 80 dB, at offsets -reach .. reach; sum 1."""
    reach = int(np.ceil(0.5 * (80 - 7.95) / (2.285 * 2 * np.pi * transition_hz / rate_hz)))
    n = np.arange(-reach, reach + 1)
    weights = np.sinc(2 * cutoff_hz * n / rate_hz) * np.kaiser(len(n), 0.1102 * (80 - 8.7))
    return weights / weights.sum()


def high_passed(x, edge_hz, rate_hz):
    """x above an edge, and the number of samples that are left out at each end."""
    transition_hz = 0.4 * edge_hz
    if rate_hz <= 2 * edge_hz + transition_hz:
        return np.empty(0), 0
    weights = low_pass(edge_hz, transition_hz, rate_hz)
    reach = len(weights) // 2
    if len(x) - 2 * reach < rate_hz / edge_hz:
        return np.empty(0), 0
    return x[reach:-reach] - signal.fftconvolve(x, weights, mode="valid"), reach


def inner(counted, reach, least):
    """Of each range of at least so many ticks what is farther than the reach of a filter from its ends."""
    return [(b + reach, e - reach) for b, e in counted if e - b >= least]


STILL = np.radians(0.1)


def correlations(x, y, counted, bound):
    """Pearson's coefficient of x(n) and y(n + lag), |lag| up to a bound, over all ranges; NaN says nothing."""
    x = x - within(x, 0, counted).mean()
    y = y - within(y, 0, counted).mean()
    if not (rms(within(x, 0, counted)) > STILL and rms(within(y, 0, counted)) > STILL):
        return None
    # Per lag: overlap, sums of x, x^2, y, y^2, x y over all ranges.
    total = np.zeros((2 * bound + 1, 6))
    for b, e in counted:
        px, py, count = x[b:e], y[b:e], e - b
        products = signal.correlate(py, px, mode="full", method="fft")  # lag 0 at count - 1
        sums = [np.concatenate(([0.0], np.cumsum(values))) for values in (px, px * px, py, py * py)]
        for lag in range(max(-bound, 1 - count), min(bound, count - 1) + 1):
            first, last = max(0, -lag), count - max(0, lag)  # of x; y is later by lag
            total[lag + bound] += [last - first] + [s[last] - s[first] for s in sums[:2]] + [
                s[last + lag] - s[first + lag] for s in sums[2:]] + [products[count - 1 + lag]]
    whole = [np.sum(within(v * v, 0, counted)) for v in (x, y)]
    found = np.full(2 * bound + 1, NAN)
    for place, (overlap, sx, sxx, sy, syy, sxy) in enumerate(total):
        if overlap == 0:
            continue
        vx, vy = sxx - sx * sx / overlap, syy - sy * sy / overlap
        if vx >= 0.1 * whole[0] and vy >= 0.1 * whole[1]:
            found[place] = (sxy - sx * sy / overlap) / np.sqrt(vx * vy)
    return found


def repeat_period(motion, rate_hz, counted):
    """Seconds after which a motion repeats: the first side peak of its autocorrelation; None without one."""
    begin, end = max(counted, key=lambda r: r[1] - r[0])
    step = max(1, half_up(rate_hz / 100.0))
    means = block_means(motion[begin:end], step)
    most = len(means) // 4
    bound = min(len(means) - 1, int(2.15 * most) + 1)
    found = correlations(means, means, [(0, len(means))], bound) if most >= 2 else None
    if found is None:
        return None
    found = found[bound:]
    all_high = np.nan_to_num(found, nan=-2.0) > 0.5
    high = all_high[:most + 1]
    fallen = np.flatnonzero(~high)
    again = np.flatnonzero(high[fallen[0]:]) + fallen[0] if len(fallen) else []
    if not len(again):
        return None
    stop = np.flatnonzero(~high[again[0]:])
    stop = again[0] + stop[0] if len(stop) else len(high)
    peak = again[0] + int(np.argmax(found[again[0]:stop]))
    if peak + 1 == len(high) or not all_high[int(np.ceil(1.85 * peak)):int(np.floor(2.15 * peak)) + 1].any():
        return None
    return peak * step / rate_hz


def delay_samples(reference, hand, rate_hz, earliest_s, counted):
    """The lag of the largest correlation, refined by a parabola; None if there is none."""
    if not counted:
        return None
    most = max(e - b for b, e in counted) // 4
    period = repeat_period(reference, rate_hz, counted)
    first, last = ((earliest_s - 0.1, earliest_s + 1.0) if period is None
                   else (earliest_s - 0.01, earliest_s - 0.01 + period))
    first, last = (int(np.clip(half_up(t * rate_hz), -most, most)) for t in (first, last))
    if last - first < 2:
        return None
    bound = max(abs(first), abs(last))
    found = correlations(reference, hand, counted, bound)
    if found is None:
        return None
    r = np.nan_to_num(found[first + bound : last + bound + 1], nan=-2.0)
    peak = int(np.argmax(r))
    if peak in (0, len(r) - 1) or r[peak] < 0.5 or -2.0 in (r[peak - 1], r[peak + 1]):
        return None
    near = np.flatnonzero(r >= r[peak] - 1e-4)
    if near[-1] - near[0] > 0.06 * rate_hz:
        return None
    if any(i != peak and r[i] >= r[peak] - 0.02 and r[i] >= r[i - 1] and r[i] > r[i + 1] and
           min(r[min(i, peak) : max(i, peak)]) < r[peak] - 0.02 for i in range(1, len(r) - 1)):
        return None
    left, middle, right = r[peak - 1 : peak + 2]
    curvature = left - 2 * middle + right
    return first + peak + (0.5 * (left - right) / curvature if curvature < 0 else 0.0)


def aligned_error(reference, hand, delay, counted):
    whole = int(np.floor(delay))
    parts = []
    for begin, end in counted:
        n = np.arange(begin, end)
        n = n[(n + whole >= begin) & (n + whole + 1 < end)]
        moved = hand[n + whole] + (delay - whole) * (hand[n + whole + 1] - hand[n + whole])
        parts.append(moved - reference[n])
    return np.concatenate(parts)


# What the wearer does


def stretches(mask):
    """[begin, end) of every run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], mask.astype(np.int8), [0]))))
    return list(zip(edges[0::2], edges[1::2]))


def turning_points(angle, begin, end):
    """Where the direction changes by more than 5 deg, with both ends of the motion."""
    reach = np.radians(5.0)
    points, direction = [begin], 0
    lowest = highest = begin
    for n in range(begin, end):
        if angle[n] < angle[lowest]:
            lowest = n
        if angle[n] > angle[highest]:
            highest = n
        if direction >= 0 and angle[n] < angle[highest] - reach:
            if highest > points[-1]:
                points.append(highest)
            direction, lowest = -1, n
        elif direction <= 0 and angle[n] > angle[lowest] + reach:
            if lowest > points[-1]:
                points.append(lowest)
            direction, highest = 1, n
    points.append(highest if direction > 0 else lowest if direction < 0 else end - 1)
    return points


class Movement:
    def __init__(self, angle, begin, end, from_rest):
        self.begin, self.end, self.from_rest = begin, end, from_rest
        self.to = angle[end]
        self.direction = 1.0 if angle[end] > angle[begin] else -1.0
        self.amplitude = abs(angle[end] - angle[begin])


class Wearer:
    """Regimes as lists of [begin, end), and the movements of one joint, of each counted range by itself."""

    def __init__(self, angle, rate_hz, segments, counted):
        self.movements, self.regimes = [], {}
        for begin, end in counted:
            labels = [(name, max(0, b - begin), max(0, e - begin)) for name, b, e in segments]
            part = WearerOfRange(angle[begin:end], rate_hz, labels)
            for movement in part.movements:
                movement.begin += begin
                movement.end += begin
                movement.within = (begin, end)
                self.movements.append(movement)
            for name, ranges in part.regimes.items():
                self.regimes.setdefault(name, []).extend((b + begin, e + begin) for b, e in ranges)


class WearerOfRange:
    def __init__(self, angle, rate_hz, segments):
        count = len(angle)
        reach = max(1, round(0.005 * rate_hz))
        n = np.arange(count)
        before, after = np.maximum(0, n - reach), np.minimum(count - 1, n + reach)
        speed = np.abs(angle[after] - angle[before]) * rate_hz / np.maximum(1, after - before)
        rest = speed < np.radians(5.0)
        for begin, end in stretches(rest):
            if end - begin < round(0.3 * rate_hz):
                rest[begin:end] = False
        self.movements = []
        for begin, end in stretches(~rest):
            points = turning_points(angle, begin, end)
            for i, (a, b) in enumerate(zip(points, points[1:])):
                movement = Movement(angle, a, b, i == 0 and begin > 0)
                if movement.amplitude >= np.radians(5.0):
                    self.movements.append(movement)

        kind = np.where(rest, "rest", np.where(speed >= np.radians(60.0), "fast", "slow"))
        for label, begin, end in segments:
            if label in ("rest", "slow", "fast"):
                kind[begin:end] = label
        settling = round(0.5 * rate_hz)
        self.regimes = {
            "rest": [(b + settling, e) for b, e in stretches(kind == "rest") if b + settling < e],
            "slow": stretches(kind == "slow"),
            "fast": stretches(kind == "fast"),
            "onset": [(m.begin, min(count, m.begin + round(0.3 * rate_hz)))
                      for m in self.movements if m.from_rest],
            "reversal": self.reversals(round(0.15 * rate_hz), count),
        }
        for label in ("onset", "reversal"):
            labelled = [(b, e) for name, b, e in segments if name == label and e > b]
            if labelled:
                self.regimes[label] = labelled

    def reversals(self, reach, count):
        ranges = []
        for last, movement in zip(self.movements, self.movements[1:]):
            if movement.begin != last.end:
                continue  # a rest or a small turn lies between
            begin = max(0, movement.begin - reach, ranges[-1][1] if ranges else 0)
            ranges.append((begin, min(count, movement.begin + reach)))
        return ranges


def within(values, first, ranges):
    """The values inside the ranges; values[0] belongs to sample `first`."""
    parts = [values[max(0, b - first) : max(0, e - first)] for b, e in ranges]
    return np.concatenate(parts) if parts else np.empty(0)


def overlap(ranges, others):
    return [(max(a, c), min(b, d)) for a, b in ranges for c, d in others if max(a, c) < min(b, d)]


# Single movements


def smoothness(hand, rate_hz, movements, delay):
    """SPARC and LDLJ, means over movements."""
    if rate_hz <= 60:
        return NAN, NAN
    weights = low_pass(20.0, 20.0, rate_hz)
    reach = len(weights) // 2 + 1
    smooth = signal.fftconvolve(hand, weights, mode="valid")
    velocity = 0.5 * rate_hz * (smooth[2:] - smooth[:-2])  # velocity[0] belongs to sample `reach`
    step = max(1, round(rate_hz / 100.0))
    rate = rate_hz / step
    found = []
    for movement in movements:
        first, last = movement.within
        begin = movement.begin + half_up(delay) - reach
        at = begin + step * np.arange(half_up((movement.end - movement.begin) / step))
        if begin < first or len(at) < int(0.2 * rate) or at[-1] + 2 * reach >= last:
            continue
        both = sparc(velocity[at], rate), ldlj(velocity[at], rate)
        if np.all(np.isfinite(both)):
            found.append(both)
    return tuple(np.mean(found, axis=0)) if found else (NAN, NAN)


def sparc(velocity, rate_hz):
    size = 16 * 2 ** int(np.ceil(np.log2(len(velocity))))
    amplitude = np.abs(np.fft.rfft(velocity, size))
    amplitude /= amplitude.max()
    amplitude = amplitude[np.arange(len(amplitude)) * rate_hz / size <= 10.0]
    large = np.flatnonzero(amplitude >= 0.05)
    band = amplitude[large[0] : large[-1] + 1]
    return -np.sum(np.hypot(1.0 / (len(band) - 1), np.diff(band))) if len(band) > 1 else NAN


def ldlj(velocity, rate_hz):
    jerk = np.diff(velocity, 2) * rate_hz**2
    duration = len(velocity) / rate_hz
    integral = np.sum(jerk**2) / rate_hz
    return -np.log(duration**3 / np.max(np.abs(velocity)) ** 2 * integral)


def overshoot(reference, hand, rate_hz, movements, delay, counted):
    offset = np.mean(within(hand - reference, 0, counted)) if counted else NAN
    late = half_up(max(0.0, delay or 0.0))
    found = []
    for i, movement in enumerate(movements):
        if movement.end + late + 1 >= movement.within[1]:
            continue
        end = movement.end + int(1.0 * rate_hz)
        if i + 1 < len(movements):
            after = movements[i + 1]
            end = min(end, after.begin if after.direction == movement.direction else after.end)
        stretch = hand[movement.begin : min(end + late, movement.within[1])]
        found.append(max(0.0, np.max(movement.direction * (stretch - offset - movement.to))))
    return np.mean(found) if found else NAN


def time_before_onset(angle, movement, baseline, end):
    """Samples that the angle spends below 10 % of the amplitude before it reaches 50 %."""
    travel = movement.direction * (angle[movement.begin : end] - baseline)
    moving = np.flatnonzero(travel >= 0.5 * movement.amplitude)
    moving = moving[moving < len(travel) - 1]
    if len(moving) == 0:
        return None
    now, then = travel[: moving[0]], travel[1 : moving[0] + 1]
    level = 0.1 * movement.amplitude
    low, high = np.minimum(now, then), np.maximum(now, then)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(high < level, 1.0, np.where(low >= level, 0.0, (level - low) / (high - low)))
    return np.sum(share)


def onset_delay(reference, hand, rate_hz, movements):
    first, last = int(0.3 * rate_hz), min(int(0.3 * rate_hz) - 1, int(0.2 * rate_hz))
    found = []
    for movement in movements:
        if not movement.from_rest or movement.begin - movement.within[0] < first:
            continue
        end = min(movement.within[1], movement.end + int(1.0 * rate_hz))
        times = [time_before_onset(angle, movement,
                                   angle[movement.begin - first : movement.begin - last].mean(), end)
                 for angle in (reference, hand)]
        if None not in times:
            found.append(times[1] - times[0])
    return np.mean(found) if found else NAN


# Motors, cables, grip


def centroid(speed, rate_hz, counted):
    size = fast_size(int(rate_hz))
    hop, power, frequency = size // 2, 0.0, None
    for begin, end in counted:
        if end - begin < size:
            continue
        frequency, mean_power = signal.welch(speed[begin:end] - within(speed, 0, counted).mean(), rate_hz,
                                             window="hann", nperseg=size, noverlap=size - hop, detrend=False)
        power = power + mean_power * ((end - begin - size) // hop + 1)
    if frequency is None:
        return NAN
    power[-1] *= 2 if size % 2 == 0 else 1  # one-sided densities halve neither end
    total = power[1:].sum()
    return np.sum(frequency[1:] * power[1:]) / total if total > 1e-24 else NAN


def reversals_per_s(counts, rate_hz, counted):
    reversals = ticks = 0
    for begin, end in counted:
        steps = np.sign(np.diff(counts[begin:end]))
        steps = steps[steps != 0]
        reversals += np.sum(steps[1:] != steps[:-1])
        ticks += end - begin
    return reversals * rate_hz / ticks if ticks else NAN


def grip_ripple(force, edge_hz, rate_hz, counted):
    ripple = [high_passed(force[begin + b : begin + e], edge_hz, rate_hz)[0]
              for begin, end in counted for b, e in stretches(force[begin:end] >= 0.1)]
    return rms(np.concatenate(ripple)) if ripple else NAN


def largest(values):
    return np.max(values) if len(values) else NAN


def held_ranges(grip, support, rate_hz):
    """While the support carries the object no more, from a tick on at which the hand touches it, until it falls.

    Returns these ranges and the tick from which it falls, the number of ticks if it does not."""
    least = half_up(0.1 * rate_hz)
    held = [(b, e) for b, e in stretches(support < 0.1) if e - b >= least and grip[b] >= 0.1]
    free = (grip < 0.1) & (support < 0.1)
    free[: held[0][0] if held else len(free)] = False
    fall = next((b for b, e in stretches(free) if e - b >= least), len(grip))
    return [(b, min(e, fall)) for b, e in held if b < fall], fall


def axis_of(pose):
    """The z axis of an attitude, per row of place and quaternion (w, x, y, z)."""
    w, x, y, z = (pose[:, 3:] / np.linalg.norm(pose[:, 3:], axis=1, keepdims=True)).T
    return np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)


def angles_to(axes, axis):
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(axes, axis), axis=1), axes @ axis))


def grasp_scores(grip, forces, pose, in_palm, friction, rate_hz, counted):
    """Object slip, tilt, grip force ratio and lost contact of the whole hand."""
    if grip is None:
        return dict.fromkeys(("object_slip_mm", "object_tilt_deg", "grip_force_ratio", "lost_contact_share",
                              "object_dropped_share"), NAN)
    held, fall = held_ranges(grip, forces[:, 1], rate_hz)
    counts, window = ticks_of(counted, len(grip)), half_up(0.02 * rate_hz)
    slips, tilts, ratios, lost = [], [], [], []
    standing = counts.copy()
    standing[fall:] = False
    lost.extend([True] * int(counts[fall:].sum()))
    for begin, end in held:
        standing[begin:end] = False
        ticks = np.arange(begin, end)[counts[begin:end]]
        lost.extend(grip[ticks] < 0.1)
        touching = ticks[grip[ticks] >= 0.1]
        slips.extend(1000 * np.linalg.norm(in_palm[touching, :3] - in_palm[begin, :3], axis=1))
        tilts.extend(angles_to(axis_of(in_palm[touching]), axis_of(in_palm[begin : begin + 1])[0]))
        for b, e in overlap([(begin, end)], counted):
            for n in range(b, e - window + 1, window):
                ratios.append(friction * grip[n : n + window].sum() / forces[n : n + window, 0].sum())
    tilts.extend(angles_to(axis_of(pose[standing]), np.array([0.0, 0.0, 1.0])))
    return {"object_slip_mm": largest(slips), "object_tilt_deg": largest(tilts),
            "grip_force_ratio": np.min(ratios) if ratios else NAN,
            "lost_contact_share": np.mean(lost) if lost else NAN, "object_dropped_share": float(fall < len(grip))}


# Fingertips, by kinematics that are read from the model's files


def turned(axis, angles):
    """Rotation matrices by Rodrigues' formula, one per angle."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angles = np.asarray(angles)[:, None, None]
    return np.eye(3) + np.sin(angles) * cross + (1 - np.cos(angles)) * (cross @ cross)


class Fingertips:
    """The project's hand: its tips in the frame of the palm, the outer ends of the axes of the last capsules."""

    NAMES = ("thumb", "index", "middle", "ring", "little")

    def __init__(self):
        self.models = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "models")
        palm = next(b for b in self.tree("parts/carpus.xml").iter("body") if b.get("name") == "palm")
        self.chains = {name: self.chain(palm, name) for name in self.NAMES}
        self.leaders = {joint.get("joint1"): (joint.get("joint2"), float(joint.get("polycoef").split()[1]))
                        for joint in self.tree("parts/couplings.xml").iter("joint") if joint.get("joint1")}

    def tree(self, name):
        """A part, with those that it includes."""
        root = ElementTree.parse(os.path.join(self.models, name)).getroot()
        for parent in list(root.iter()):
            for include in parent.findall("include"):
                parent.extend(list(self.tree(include.get("file"))))
        return root

    def chain(self, palm, digit):
        """Bodies from the palm to the last phalanx: place, attitude, axes and names of joints; then the tip."""
        links, body = [], palm
        while True:
            inner = [b for b in body.findall("body") if b.get("name").startswith(digit) and
                     not b.get("name").endswith("_spool")]
            if not inner:
                return links, self.tip(body)
            body = inner[0]
            frame = np.eye(3)
            if body.get("xyaxes"):
                x, y = np.array(body.get("xyaxes").split(), float).reshape(2, 3)
                frame = np.stack([x, y, np.cross(x, y)], axis=1)
            joints = [(j.get("name"), np.array(j.get("axis").split(), float)) for j in body.findall("joint")]
            links.append((np.array(body.get("pos").split(), float), frame, joints))

    @staticmethod
    def tip(body):
        capsules = [g for g in body.findall("geom") if g.get("class", "").endswith("_skin")]
        ends = np.array(capsules[0].get("fromto").split(), float).reshape(2, 3)
        return ends[np.argmax(np.linalg.norm(ends, axis=1))]

    def places(self, angles, digit):
        """Ticks x 3 [m]; angles: joint -> rad per tick."""
        links, tip = self.chains[digit]
        count = len(next(iter(angles.values())))
        place, attitude = np.zeros((count, 3)), np.broadcast_to(np.eye(3), (count, 3, 3))
        for pos, frame, joints in links:
            place = place + attitude @ pos
            attitude = attitude @ frame
            for joint, axis in joints:
                leader, factor = self.leaders.get(joint, (joint, 1.0))
                attitude = attitude @ turned(axis, factor * angles[leader])
        return place + attitude @ tip

    def moved_by(self, digit, measured_joints):
        names = [joint for _, _, joints in self.chains[digit][0] for joint, _ in joints]
        return any(self.leaders.get(joint, (joint,))[0] in measured_joints for joint in names)


def fingertip_scores(tips, reference, hand, measured_joints, rate_hz, counted):
    """Errors of fingertips and of pinches, every 10 ms."""
    step = max(1, half_up(rate_hz / 100.0))
    counts = ticks_of(counted, len(next(iter(hand.values()))))[::step]
    count = len(counts)
    at = [{name: tips.places({joint: x[::step][:count] for joint, x in angles.items()}, name)[counts]
           for name in tips.NAMES} for angles in (hand, reference)]
    measured = [name for name in tips.NAMES if tips.moved_by(name, measured_joints)]
    errors = [np.linalg.norm(at[0][name] - at[1][name], axis=1) for name in measured]
    pinches = []
    for finger in tips.NAMES[1:]:
        if "thumb" not in measured and finger not in measured:
            continue
        ours, theirs = (np.linalg.norm(places["thumb"] - places[finger], axis=1) for places in at)
        pinches.extend((ours - theirs)[theirs < 0.04])
    return {"fingertip_error_mm": 1000 * rms(np.concatenate(errors)) if errors else NAN,
            "pinch_distance_error_mm": 1000 * rms(pinches)}


# The jitter of fingers, wrist and arm


GROUPS = {"arm": ("elbow", "shoulder"), "wrist": ("wrist", "forearm")}  # of the project's hand; others are fingers


def group_of(joint):
    return next((group for group, names in GROUPS.items() if joint.startswith(names)), "finger")


def group_scores(jitter_deg, beside_rest_deg, at_rest_deg, palm_m_s, context, counted):
    """jitter_deg, at_rest_deg: joint -> jitter, of the trial and of the one with the arm at rest; beside_rest_deg: of
    the trial in the time of that one."""
    scores = {}

    def of_fingers(jitter):
        return [x for name, x in jitter.items() if group_of(name) == "finger" and not np.isnan(x)]
    for group in ("finger", "wrist", "arm"):
        values = [x for name, x in jitter_deg.items() if group_of(name) == group and not np.isnan(x)]
        scores[group + "_jitter_rms_deg"] = np.mean(values) if values else NAN
    at_rest = of_fingers(at_rest_deg)
    scores["arm_share_of_finger_jitter"] = 1 - np.mean(at_rest) / np.mean(of_fingers(beside_rest_deg)) if at_rest else NAN
    if palm_m_s is None:
        return scores | {"palm_acceleration_m_s2": NAN}
    acceleration = context.rate_hz * np.diff(palm_m_s, axis=0)
    acceleration = np.vstack([acceleration[:1], acceleration])
    squares = sum(jitter_of(acceleration[:, i], context, counted) ** 2 for i in range(3))
    return scores | {"palm_acceleration_m_s2": np.sqrt(squares)}


# The error by its cause


def block_means(values, step):
    count = len(values) // step
    return values[: count * step].reshape(count, step).mean(axis=1)


def ticks_of(ranges, count):
    ticks = np.zeros(count, bool)
    for begin, end in ranges:
        ticks[begin:end] = True
    return ticks


def error_parts(reference, hand, without, counted):
    """The mean square error by its cause [deg^2]: mean(signal of the cause times the error). `without`: cause ->
    the hand without it and all before, where there is such a trial."""
    counts = ticks_of(counted, len(hand))
    error = np.degrees(hand - reference)
    parts, last = dict.fromkeys(ERROR_PARTS, NAN), hand
    if "rest" not in without or not counts.any():
        return parts
    for cause, angle in (*without.items(), ("controller", reference)):
        parts[f"error_{cause}_deg2"] = np.mean((np.degrees(last - angle[: len(hand)]) * error)[counts])
        last = angle[: len(hand)]
    return parts


def errors_without(reference, hand, alone, ticks, counted):
    """The tracking error with all causes, and without each. `alone`: cause -> the hand without it, where there is
    such a trial; ticks: of these trials, 0 without any."""
    def error(angle):
        if angle is None or ticks == 0:
            return NAN
        return rms(np.degrees(angle[:ticks] - reference[:ticks])[ticks_of(counted, len(hand))[:ticks]])

    return {"error_with_all_deg": error(hand)} | {
        f"error_without_{cause}_deg": error(alone.get(cause)) for cause in ALONE}


# The project's hand, as its model card says


class ModelCard:
    """What no trace tells of the project's hand: the motors that turn a joint, and pulls at stall."""

    def __init__(self):
        here = os.path.dirname(os.path.abspath(__file__))
        with open(os.path.join(here, "..", "..", "docs", "evidence", "hand.md"), encoding="utf-8") as file:
            card = file.read()
        number = r" *([-\d.]+) *\|"
        rows = re.findall(rf"^\| `(\w+)` \| [-\d]+ \.\. \d+ \|{number * 4}", card, re.MULTILINE)
        # stall torque [N m] over radius of the drum [mm]
        self.stall_n = {name: 1000 * float(torque) / float(drum) for name, _, drum, torque, _ in rows}
        coupling = re.findall(r"^ *\d+ (\w+) +((?: +(?:[\d.]+))+)$", card, re.MULTILINE)
        joints = [name for name, _ in coupling]
        self.motors_of = {joint: [motor for motor, row in coupling if row.split()[i] != "."]
                          for i, joint in enumerate(joints)}


# All scores of one part


def jitter_of(values, context, counted):
    trembling, first = high_passed(values, context.jitter_above_hz, context.rate_hz)
    trembles = inner(counted, first, 2 * first + int(np.ceil(context.rate_hz / context.jitter_above_hz)))
    return rms(within(trembling, first, trembles))


def joint_scores(reference, hand, quiet_hand, without, alone, ticks, context, earliest_s, counted):
    """quiet_hand: of the noise-free trial, None if there is none; without: see error_parts; alone, ticks: see
    errors_without."""
    rate_hz = context.rate_hz
    wearer = Wearer(reference, rate_hz, context.segments, counted)
    error = np.degrees(hand - reference)
    all_error = within(error, 0, counted)
    trembling, first = high_passed(np.degrees(hand), context.jitter_above_hz, rate_hz)
    # Ticks in whose trembling only ticks that count have a share.
    trembles = inner(counted, first, 2 * first + int(np.ceil(rate_hz / context.jitter_above_hz)))
    delay = delay_samples(reference, hand, rate_hz, earliest_s, counted)
    rests = [error[b:e] for b, e in wearer.regimes["rest"]]
    hand_rests = [np.degrees(hand[b:e]) for b, e in wearer.regimes["rest"]]
    scores = {
        "tracking_rmse_deg": rms(all_error),
        "delay_ms": NAN if delay is None else 1000 * delay / rate_hz,
        "aligned_rmse_deg": rms(all_error if delay is None
                                else np.degrees(aligned_error(reference, hand, delay, counted))),
        "peak_error_deg": np.max(np.abs(all_error)) if len(all_error) else NAN,
        "jitter_rms_deg": rms(within(trembling, first, trembles)),
        "rest_jitter_deg": rms(np.concatenate([x - x.mean() for x in hand_rests])) if rests else NAN,
        "rest_offset_deg": np.mean([abs(x.mean()) for x in rests]) if rests else NAN,
        "overshoot_deg": np.degrees(overshoot(reference, hand, rate_hz, wearer.movements, delay,
                                               counted)),
        "onset_delay_ms": 1000 / rate_hz * onset_delay(reference, hand, rate_hz, wearer.movements),
    }
    scores["sparc"], scores["ldlj"] = smoothness(hand, rate_hz, wearer.movements, delay or 0.0)
    for regime, ranges in wearer.regimes.items():
        scores[regime + "_tracking_rmse_deg"] = rms(within(error, 0, ranges))
        if regime != "rest":
            scores[regime + "_jitter_rms_deg"] = rms(within(trembling, first, overlap(ranges, trembles)))
    quiet = quiet_hand is not None
    noise = np.degrees(hand - quiet_hand) if quiet else np.empty(0)
    noise = high_passed(noise, context.jitter_above_hz, rate_hz)[0]
    scores["noise_jitter_rms_deg"] = rms(within(noise, first, trembles)) if quiet else NAN
    return scores | error_parts(reference, hand, without, counted) | errors_without(reference, hand, alone, ticks, counted)


def motor_scores(counts, speed, at_limit, quiet_speed, context, counted):
    noise = speed - quiet_speed if quiet_speed is not None else None
    share = within(at_limit, 0, counted)
    return {
        "motor_noise_rms_deg_s": NAN if noise is None else rms(np.degrees(within(noise, 0, counted))),
        "motor_noise_centroid_hz": NAN if noise is None else centroid(noise, context.rate_hz, counted),
        "command_reversals_per_s": reversals_per_s(counts, context.rate_hz, counted),
        "motor_speed_rms_deg_s": rms(np.degrees(within(speed, 0, counted))),
        "motor_speed_centroid_hz": centroid(speed, context.rate_hz, counted),
        "saturation_share": np.mean(share) if len(share) else NAN,
    }


def command_jump(counts, deg_per_count, counted):
    """Largest change of the command from one tick to the next, as an angle of the spool."""
    jumps = [np.max(np.abs(np.diff(counts[b:e]))) for b, e in counted if e - b > 1]
    return deg_per_count * max(jumps) if jumps else NAN


def link_scores(age_s, tier, rate_hz, period, counted):
    """What the links do to the commands; nothing without them."""
    if age_s is None:
        return {}
    ages = np.sort(within(age_s, 0, counted))
    capture = np.round(np.arange(len(age_s)) - age_s * rate_hz)
    same = [capture[b + period:e] == capture[b:e - period] for b, e in counted if e - b > period]
    tiers = within(tier, 0, counted)
    scores = {f"sample_age_{name}_ms": 1000 * ages[int(share * (len(ages) - 1))]
              for name, share in (("p50", 0.5), ("p99", 0.99), ("max", 1.0))}
    scores["frozen_share"] = np.mean(np.concatenate(same)) if same else NAN
    for number, name in enumerate(("hold", "relax", "off"), 1):
        scores[f"watchdog_{name}_share"] = np.mean(tiers == number)
    return scores


def cable_scores(tension, stall_n, counted):
    tension = within(tension, 0, counted)
    if len(tension) == 0:
        return dict.fromkeys(("slack_share", "tension_peak_n", "tension_peak_share"), NAN)
    return {"slack_share": np.mean(tension <= 0.01), "tension_peak_n": np.max(tension),
            "tension_peak_share": np.max(tension) / stall_n}


# The folder


class Context:
    """What holds for all parts: clocks, labels and the settings that a definition names."""

    def __init__(self, folder, trace):
        with open(os.path.join(folder, "scenario.resolved.yaml"), encoding="utf-8") as file:
            text = file.read()

        def setting(name, default=NAN):
            found = re.findall(rf"^\s+{name}: (\S+)$", text, re.MULTILINE)
            return max(map(float, found)) if found else default

        self.rate_hz = float(trace["glove/reference_angle_rad"].attrs["rate_hz"])
        self.jitter_above_hz = setting("jitter_above_hz", 10.0)
        friction = re.search(r"^  object:\n(?:    .*\n)*?    friction: (\S+)", text, re.MULTILINE)
        self.friction = float(friction[1]) if friction else NAN
        self.card = ModelCard()
        self.fingertips = Fingertips()
        self.recovery = half_up(setting("recovery_s", 1.0) * self.rate_hz)
        self.masked = []
        if "masked" in trace["glove"]:
            self.masked = [(row["reason"].decode(), row["channel"].decode(), int(row["begin_sample"]),
                            int(row["end_sample"])) for row in trace["glove/masked"][()]]
        self.segments = [(row["label"].decode(), int(row["begin_sample"]), int(row["end_sample"]))
                         for row in trace["glove/segments"][()]]


        self.text = text
        self.period = int(np.ceil(float(re.search(r"^event:\n  period_ms: (\S+)", text, re.MULTILINE)[1])
                                  / 1000 * self.rate_hz - 1e-9))
        self.deg_per_count = {
            servo: float(re.search(rf"^  {servo}:\n(?:    .*\n)*?    travel_deg: (\S+)", text, re.MULTILINE)[1])
            / (2 ** int(re.search(rf"^  {servo}:\n(?:    .*\n)*?    resolution_bits: (\S+)", text, re.MULTILINE)[1]) - 1)
            for servo in ("servo", "arm_servo")}
        self.link_s = half_up(float(re.search(r"^event:\n(?:  .*\n)*?  delay_ms: (\S+)", text, re.MULTILINE)[1])
                              / 1000 * self.rate_hz) / self.rate_hz

    def earliest_s(self, controller):
        """The hand cannot be late by less: the link's delay less the horizon of the prediction."""
        block = re.search(rf"^  {re.escape(controller)}:\n((?:    .*\n)+)",
                          self.text[self.text.index("\ncontrollers:"):], re.MULTILINE)[1]
        if re.search(r"model_predictive:\n\s+kind: (?!none)", block):
            return 0.0
        horizons = re.search(r"horizon_ms: (.*)", block)
        return self.link_s - (max(map(float, re.findall(r"[\d.e+-]+", horizons[1]))) / 1000 if horizons else 0.0)

    def counted(self, channels, count):
        """Ranges of ticks that count for what follows these channels."""
        ticks = np.ones(count, bool)
        for reason, channel, begin, end in self.masked:
            if channel in channels:
                ticks[begin : end + (0 if reason == "clipped" else self.recovery)] = False
        return [(int(b), int(e)) for b, e in stretches(ticks)]

    def channels_of(self, motor, measured_joints):
        return [joint for joint in measured_joints if motor in self.card.motors_of[joint]]


def columns_of(group, name):
    """Column name -> 64-bit signal."""
    if name not in group:
        return {}
    names = group[name].attrs["columns"]
    values = np.asarray(group[name][()], dtype=float)
    return {str(column): values[:, i] for i, column in enumerate(names)}


def rescore(trace, controller, measured_joints, context):
    """Row name -> metric -> value, and the scores of the whole hand."""
    group = trace["controllers"][controller]
    reference = columns_of(trace["glove"], "reference_angle_rad")
    hand = columns_of(group, "hand_angle_rad")
    quiet_hand = columns_of(group, "noise_free_hand_angle_rad")
    quiet_speed = columns_of(group, "noise_free_spool_speed_rad_s")
    without = {cause: columns_of(group, name) for cause, name in WITHOUT.items() if name in group}
    alone = {cause: columns_of(group, name) for cause, name in ALONE.items() if name in group}
    ticks = min((len(next(iter(angles.values()))) for cause, angles in alone.items() if cause != "noise"), default=0)
    rows = {}
    for name in measured_joints:
        count = len(hand[name])
        quiet = quiet_hand[name][:count] if quiet_hand else None
        rows.setdefault(name, {}).update(
            joint_scores(reference[name][:count], hand[name], quiet,
                         {cause: angles[name] for cause, angles in without.items()},
                         {cause: angles[name] for cause, angles in alone.items()}, ticks, context,
                         context.earliest_s(controller),
                         context.counted([name], count)))
    speed, at_limit = (columns_of(group, s) for s in ("spool_speed_rad_s", "motor_at_limit"))
    for name, counts in columns_of(group, "command_counts").items():
        quiet = quiet_speed[name][: len(counts)] if quiet_speed else None
        rows.setdefault(name, {}).update(
            motor_scores(counts, speed[name], at_limit[name], quiet, context,
                         context.counted(context.channels_of(name, measured_joints), len(counts))))
        if "sample_age_s" in group:
            servo = "arm_servo" if name.startswith(("elbow", "shoulder")) else "servo"
            rows[name]["command_jump_deg"] = command_jump(
                counts, context.deg_per_count[servo],
                context.counted(context.channels_of(name, measured_joints), len(counts)))
    for name, tension in columns_of(group, "tension_n").items():
        motor = re.sub("_(flexor|extensor)$", "", name)
        counted = context.counted(context.channels_of(motor, measured_joints), len(tension))
        rows.setdefault(name, {}).update(cable_scores(tension, context.card.stall_n[motor], counted))
    force = columns_of(group, "grip_force_n")
    ripple = [grip_ripple(x, context.jitter_above_hz, context.rate_hz,
                          context.counted(measured_joints, len(x))) for x in force.values()]
    deep = [within(x > 2e-3, 0, context.counted(measured_joints, len(x)))
            for x in columns_of(group, "digit_overlap_m").values()]
    count = len(next(iter(hand.values())))
    counted = context.counted(measured_joints, count)

    def whole(name):
        return np.asarray(group[name][()], dtype=float) if name in group else None

    grip = whole("grip_force_n")
    at_rest = columns_of(group, "arm_at_rest_hand_angle_rad")
    rest_ticks = len(next(iter(at_rest.values()))) if at_rest else 0
    jitter_deg, beside_rest_deg, at_rest_deg = (
        {name: jitter_of(np.degrees(angles[name][:ticks]), context, context.counted([name], ticks))
         for name in measured_joints if angles}
        for angles, ticks in ((hand, count), (hand if at_rest else {}, rest_ticks), (at_rest, rest_ticks)))
    return rows, {**grasp_scores(None if grip is None else grip[:, 0], whole("object_force_n"), whole("object_pose"),
                                 whole("object_in_palm"), context.friction, context.rate_hz, counted),
                  **fingertip_scores(context.fingertips, reference, hand, measured_joints, context.rate_hz, counted),
                  **link_scores(*(None if x is None else x[:, 0] for x in map(whole, ("sample_age_s", "watchdog_tier"))),
                                context.rate_hz, context.period, counted),
                  **group_scores(jitter_deg, beside_rest_deg, at_rest_deg, whole("palm_velocity_m_s"), context, counted),
                  "grip_force_ripple_n": ripple[0] if ripple else NAN,
                  "digit_overlap_share": np.mean(deep[0]) if deep and len(deep[0]) else NAN}


def difference(metric, theirs, ours):
    """Relative; none up to the floor."""
    theirs = NAN if theirs is None else theirs
    if np.isnan(theirs) or np.isnan(ours):
        return 0.0 if np.isnan(theirs) and np.isnan(ours) else float("inf")
    floor = FLOOR_OF_SPLIT_DEG if SPLIT.fullmatch(metric) else FLOOR
    if metric in ERROR_PARTS:
        floor = FLOOR_OF_PART_DEG2
    return abs(theirs - ours) / max(abs(theirs), abs(ours)) if abs(theirs - ours) > floor else 0.0


def common_rows(metric, scored, measured):
    """The measured rows in which all controllers have a value that have any."""
    having = [{row for row in measured if not np.isnan(rows[row].get(metric, NAN))}
              for rows, _ in scored.values()]
    return sorted(set.intersection(*filter(None, having))) if any(having) else []


def compare(folder):
    """Metric -> list of (difference, place, their value, ours); and the metrics nobody knows."""
    with open(os.path.join(folder, "scores.json"), encoding="utf-8") as file:
        scores = json.load(file)
    if "seed" not in scores:
        raise ValueError("a comparison of several seeds; its trace is of the first only")
    results, unknown = {}, set()
    with h5py.File(os.path.join(folder, "trace.h5"), "r") as trace:
        context = Context(folder, trace)
        scored = {c["name"]: rescore(trace, c["name"], scores["measured_joints"], context)
                  for c in scores["controllers"] if c["health"] == "ok"}
        for controller in scores["controllers"]:
            name = controller["name"]
            if controller["health"] != "ok":
                print(f"{folder}: {name} was stopped early and has no scores")
                continue
            rows, of_hand = scored[name]
            for row, theirs in controller["channels"].items():
                for metric, value in theirs.items():
                    if metric not in rows[row]:
                        unknown.add(metric)
                        continue
                    ours = rows[row][metric]
                    results.setdefault(metric, []).append(
                        (difference(metric, value, ours), f"{name}, {row}", value, ours))
            for metric, value in controller["summary"].items():
                if value is None and metric in NO_SUMMARY:
                    continue
                values = [rows[row][metric] for row in common_rows(metric, scored, controller["channels"])]
                if all(np.isnan(values_of[metric]) for row, values_of in rows.items() if row in controller["channels"] and metric in values_of):
                    values = []
                ours = of_hand.get(metric, np.mean(values) if values else NAN)
                results.setdefault(metric, []).append(
                    (difference(metric, value, ours), f"{name}, summary", value, ours))
    return results, unknown


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="+", help="output folder of `gauntlet run`")
    parser.add_argument("--tolerance", type=float, default=1e-3, help="relative [0.001]")
    parser.add_argument("--rows", action="store_true", help="list every value beyond the tolerance")
    arguments = parser.parse_args()
    bad = False
    for folder in arguments.folder:
        try:
            results, unknown = compare(folder)
        except (OSError, KeyError, ValueError) as problem:
            print(f"{folder}: {problem}", file=sys.stderr)
            return 2
        count = sum(len(values) for values in results.values())
        print(f"{folder}: {count} values; largest relative difference of each metric:")
        for metric, values in results.items():
            worst = max(values, key=lambda result: result[0])
            flag = " " if worst[0] <= arguments.tolerance else "!"
            bad |= flag == "!"
            print(f"{flag} {metric:28} {worst[0]:8.1e}  of {len(values):4}", end="")
            print(f"  {worst[1]}: {worst[2]} is {worst[3]:.9g}" if flag == "!" else "")
            for result in values if arguments.rows else []:
                if result[0] > arguments.tolerance:
                    print(f"    {result[1]}: {result[2]} is {result[3]:.9g}")
        for metric in sorted(unknown):
            print(f"! {metric:28} is unknown here: define it in this script, too")
            bad = True
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
