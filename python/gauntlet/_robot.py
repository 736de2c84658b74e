"""Filters and controllers on samples: the part of the module that needs no simulation. gauntlet_controller has it, too."""
from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Union

import numpy as np

from . import _core
from ._errors import Remark
from ._settings import Settings, source as _source, to_yaml


def filter(array: Any, kind: Union[str, Mapping[str, Any]], *, rate_hz: Optional[float] = None,
           out: Optional[np.ndarray] = None, **settings: Any) -> np.ndarray:
    """Filters samples (n) or samples x channels, as a controller would, one after the other.

    kind     kind of filter, or its settings as a dict: {"kind": "one_euro", "min_cutoff_hz": 1}
    rate_hz  sampling rate, needed by filters with settings in Hz or s
    out      array of float64 for the result, which may be `array` itself
    A value that is masked, NaN, infinite or beyond 1e100 is the last good one of its channel again (with a Remark);
    before the first good one the result is NaN. Errors: SettingError.
    """
    chosen = {**kind, **settings} if isinstance(kind, Mapping) else {"kind": kind, **settings}
    result, held = _core.filter(array, to_yaml(chosen), rate_hz, out)
    if held:
        remark([f"filter: {held} missing values held at the last good one"])
    return result


class Filter:
    """A filter that takes one sample at a time, with the numbers of filter() bit for bit.

    kind     kind of filter, or its settings as a dict: {"kind": "one_euro", "min_cutoff_hz": 1}
    rate_hz  sampling rate, needed by filters with settings in Hz or s, and for the times of step()
    Errors: SettingError.
    """

    def __init__(self, kind: Union[str, Mapping[str, Any]], *, rate_hz: Optional[float] = None, **settings: Any) -> None:
        chosen = {**kind, **settings} if isinstance(kind, Mapping) else {"kind": kind, **settings}
        self._core = _core.Filter(to_yaml(chosen), rate_hz)
        setattr(self, "step", self._core.bound_step())  # in place of the method: a call less for each sample

    def step(self, x: Any, t: Optional[float] = None, out: Optional[np.ndarray] = None) -> Any:
        """The filtered sample: a number for a number, an array for an array with a value for each channel.

        t    time of the sample in s. All filters take samples at equal times: one that is more than half an interval
             early or late, and a mean rate that is 5 % off, are a SettingError
        out  array of float64 for the result, which may be `x` itself
        A value that is missing is held as in filter(), without a Remark.
        """
        return self._core.bound_step()(x, t, out)

    def reset(self) -> None:
        """The next sample is the first one, and tells the number of channels."""
        self._core.reset()

    @property
    def held(self) -> int:
        """Missing values since the last reset."""
        return self._core.held

    def __reduce__(self) -> Any:
        raise TypeError("a Filter cannot be copied or sent to another process: make a new one")


def filter_kinds() -> list[str]:
    """Names of all kinds of filters."""
    return _core.filter_kinds()


def check_robot(robot: Settings) -> list[str]:
    """All problems of a robot's settings, a line each; warnings begin with "warning: " behind their place.

    robot: as of Controller. Of a file that cannot be read, or has values outside their ranges: the first error.
    """
    return _core.problems_of_robot(*_source(robot, "controller"))


class Controller:
    """What runs on the robot, from glove to motors: see controller/README.md.

    robot: a file of `gauntlet export` (YAML, or .txt of --text), the text of a YAML file, or its settings as a dict.
    One thread at a time may use a controller; another gets a RunError. Errors: SettingError.
    """

    def __init__(self, robot: Settings) -> None:
        self._core = _core.Controller(*_source(robot, "controller"))

    def __copy__(self) -> Controller:
        raise TypeError("a controller cannot be copied: make another one of the same robot")

    def __deepcopy__(self, memo: object) -> Controller:
        return self.__copy__()

    def step(self, sample: Any = None, *, number: Optional[int] = None,
             elapsed_ms: Optional[float] = None) -> np.ndarray:
        """One tick, with a sample (counts per channel; NaN or masked: missing) or without: motor counts.

        number: that of the glove's frame, if the glove counts its frames.
        elapsed_ms: time since the last step, as the loop measured it: see `loop_status` and `overruns`.
        """
        return self._core.step(sample, number, elapsed_ms)

    def prepare(self, robot: Settings) -> Controller:
        """A controller with other settings for the same glove, hand, joint map and timing, for swap()."""
        prepared = Controller.__new__(Controller)
        prepared._core = self._core.prepare(*_source(robot, "controller"))
        return prepared

    def swap(self, prepared: Controller) -> None:
        """Takes over the settings of a prepared controller from the next sample on; that one has the old ones then.

        Filters of the same kind, unit and step keep their state; others start at the joint's angle.
        """
        self._core.swap(prepared._core)

    def record(self, steps: int) -> None:
        """Keeps the last so many steps from now on (0: none), to find the cause of a fault afterwards.

        They are those of this object, also across a swap(): `recorded_steps`, `recorded_columns`, recorded_csv().
        """
        self._core.record(steps)

    @property
    def recorded_columns(self) -> list[str]:
        """Names of the columns of `recorded_steps`; controller/step_recorder.h has their meaning."""
        return self._core.recorded_columns

    @property
    def recorded_steps(self) -> np.ndarray:
        """Kept steps x columns, the oldest first."""
        return self._core.recorded_steps()

    def recorded_csv(self) -> str:
        """The same as CSV, with names of states and reasons."""
        return self._core.recorded_csv()

    @property
    def loop_status(self) -> str:
        """Of the loop by `elapsed_ms`: in_time, overrun (half a tick late or more) or wrong_rate (by more than 5 %)."""
        return self._core.loop_status

    @property
    def overruns(self) -> int:
        """Steps since the last reset that came half a tick late or more."""
        return self._core.overruns

    @property
    def measured_tick_rate_hz(self) -> float:
        """Rate of the loop over the last 256 steps with `elapsed_ms`; NaN before."""
        return self._core.measured_tick_rate_hz

    def steps(self, samples: Any) -> np.ndarray:
        """The same for samples x channels: a tick with each sample, and those without one up to the next.

        Returns ticks x motors; there are `ticks_per_sample` ticks for each sample.
        """
        return self._core.steps(samples)

    def reset(self, motor_counts: Any = None) -> None:
        """Resets filters, counters and clocks; the motors are at the last command, or at these counts."""
        self._core.reset(motor_counts)

    def take_joint_angles(self, measured_rad: Any) -> None:
        """Measured angles of the hand's joints (NaN: not measured), for the joint loop."""
        self._core.take_joint_angles(measured_rad)

    def set_channel_active(self, channel: str, active: bool) -> None:
        """An inactive channel holds its joint at the present angle."""
        self._core.set_channel_active(channel, active)

    def sample_age_ms(self, channel: str) -> float:
        """Time since the last trusted value of a channel, in ticks of the loop."""
        return self._core.sample_age_ms(channel)

    @property
    def event(self) -> bool:
        """A command frame was due at the last tick: its counts are new and are to be sent."""
        return self._core.event

    @property
    def status(self) -> str:
        """Of the glove: good, held, too_often or lost."""
        return self._core.status

    @property
    def channel_names(self) -> list[str]:
        return self._core.channel_names

    @property
    def joint_names(self) -> list[str]:
        return self._core.joint_names

    @property
    def motor_names(self) -> list[str]:
        return self._core.motor_names

    @property
    def tick_rate_hz(self) -> float:
        return self._core.tick_rate_hz

    @property
    def ticks_per_sample(self) -> int:
        return self._core.ticks_per_sample

    @property
    def event_period_ms(self) -> float:
        """Time from one command frame to the next."""
        return self._core.event_period_ms

    @property
    def linearised_angle_rad(self) -> np.ndarray:
        """Angle of each channel before the filter, after the last tick."""
        return self._core.linearised_angle_rad

    @property
    def filtered_angle_rad(self) -> np.ndarray:
        """Angle of each channel after the filter."""
        return self._core.filtered_angle_rad

    @property
    def predicted_angle_rad(self) -> np.ndarray:
        """Angle of each channel after the prediction."""
        return self._core.predicted_angle_rad

    @property
    def target_angle_rad(self) -> np.ndarray:
        """Angle of each joint: the command to the hand."""
        return self._core.target_angle_rad

    @property
    def untrusted_samples(self) -> np.ndarray:
        """Number of untrusted samples of each channel since the last reset."""
        return self._core.untrusted_samples


def remark(lines: Sequence[str]) -> None:
    for line in lines:
        warnings.warn(line.removeprefix("warning: "), Remark, stacklevel=4)
