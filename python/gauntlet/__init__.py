"""Gauntlet in Python: controllers and filters on arrays, and the commands of the program.

Settings are a file, the text of a YAML file, or a dict. They are the same as those of the program, and so are
the results, to the last bit. A mistake is a SettingError with place and key. In a dict, a filter can also be a class or
a function of yours: see PythonFilter.
"""
from __future__ import annotations

import concurrent.futures
import os
import pathlib
import sys
import tempfile
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Optional, Union

try:
    import numpy as np
except ModuleNotFoundError:
    raise ImportError("gauntlet needs numpy: pip install numpy") from None

from . import _core
from ._errors import Remark, RunError, SettingError
from ._executors import Parts
from ._filters import Filters as _Filters, PythonFilter
from ._results import (AuditResult, Column, Figure, IdentifyResult, InspectResult, Result, SignalArrays, StudyResult,
                       SweepResult, Table, TuneResult)
from ._settings import Settings, overrides as _overrides, source as _source, to_yaml

__version__: str = _core.__version__
__all__ = ["AuditResult", "Column", "Controller", "Figure", "Filter", "IdentifyResult", "InspectResult", "PythonFilter", "Remark", "Result",
           "RunError", "SettingError", "Settings", "SignalArrays", "StudyResult", "SweepResult", "Table", "TuneResult", "audit",
           "check_robot", "compare", "filter", "filter_kinds", "identify", "inspect", "run", "sweep", "to_yaml", "tune"]

#: None: a line on standard error if that is a terminal. True, False: with or without it. Or a function of
#: what is done and what there is in all, called about twenty times per second.
Progress = Union[None, bool, Callable[[float, float], object]]
Overrides = Union[None, Mapping[str, Any], Sequence[str]]


def _find_data() -> None:
    """Gauntlet's own files: in share/gauntlet of the package, or of a folder above it."""
    package = pathlib.Path(__file__).parent.absolute()
    for folder in (above / "share" / "gauntlet" for above in [package, *package.parents]):
        if (folder / "scenarios").is_dir():
            _core.set_data_folder(str(folder.resolve()))
            return


_find_data()


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
        _remark([f"filter: {held} missing values held at the last good one"])
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


def run(scenario: Settings, *, set: Overrides = None, controllers: Sequence[str] = (), jobs: int = 0,
        causes: str = "auto", out: Union[None, str, "os.PathLike[str]"] = None, csv: bool = False, mcap: bool = False,
        allow_programs: bool = False, progress: Progress = None) -> StudyResult:
    """Every controller of a scenario once, on the same glove signal and the same hand.

    set          values over those of the scenario: {"glove.motion.duration_s": 2}, or texts as of --set
    controllers  only these; empty: all
    jobs         trials at a time; 0: one per processor
    causes       seeds whose causes of the error are found: none, first, all, or auto: as much of the first seed as
                 takes a quarter of the time
    out          folder for the files of `gauntlet run`; None: no files
    allow_programs  run the programs that the scenario names as filters (kind external), with all rights of yours
    Errors: SettingError, RunError; KeyboardInterrupt leaves no half-written file.
    """
    return _run(False, scenario, set, controllers, 1, jobs, causes, out, csv, mcap, allow_programs, progress)


def compare(scenario: Settings, *, set: Overrides = None, controllers: Sequence[str] = (), seeds: int = 0,
            jobs: int = 0, causes: str = "auto", out: Union[None, str, "os.PathLike[str]"] = None, csv: bool = False,
            mcap: bool = False, allow_programs: bool = False, executor: Optional[concurrent.futures.Executor] = None,
            progress: Progress = None) -> StudyResult:
    """The same over several seeds: means with confidence intervals, ranking, verdict.

    seeds     number of them; 0: 8, or one for each repetition of the scenario
    executor  computes all seeds but the first, one trial at a time per worker; the result has the same bytes
    With `out`, finished trials are kept there, and the same call continues after an interruption.
    """
    if seeds < 0:
        raise SettingError("seeds", "", f"is {seeds}, must be 1 or more, or 0 for the usual number")
    return _run(True, scenario, set, controllers, seeds, jobs, causes, out, csv, mcap, allow_programs, progress, executor)


def tune(scenario: Settings, *, controller: str = "", free: Union[Mapping[str, str], Sequence[str]] = (),
         minimise: str = "tracking_rmse_deg", subject_to: Sequence[str] = (), set: Overrides = None, seeds: int = 8,
         held_out: int = 8, evaluations: int = 100, all: bool = False, filter_only: bool = False, jobs: int = 0,
         allow_programs: bool = False, executor: Optional[concurrent.futures.Executor] = None,
         progress: Progress = None) -> TuneResult:
    """Finds the best settings of a controller, or with `all` the best kind of filter.

    free        settings and their ranges: {"filter.q": "1e-6:10:log"}, or texts as of --free
    minimise    score to optimise
    subject_to  bounds of scores: ["jitter_rms_deg<=0.2"]
    seeds, held_out  seeds of the search, and further ones for the verdict; recordings are divided instead
    executor    computes the seeds of each setting but the first, with `all` whole kinds, one trial at a time per worker;
                the result has the same bytes. One recording, divided by time, is one trial per setting: that is not sent
    """
    for name, value in (("seeds", seeds), ("held_out", held_out), ("evaluations", evaluations)):
        if value < 1:
            raise SettingError(name, "", f"is {value}, must be 1 or more")
    ranges = [f"{key}={value}" for key, value in free.items()] if isinstance(free, Mapping) else _texts(free, "free")
    filters = _Filters()
    file, text = _source(scenario, "scenario", filters)
    overrides = _overrides(set, filters)
    core = filters.core()
    bounds = _texts(subject_to, "subject_to")
    arguments = ((file, text, overrides, controller, minimise, bounds, seeds, held_out, evaluations, filter_only, allow_programs)
                 if all else (file, text, overrides, controller, ranges, filter_only, allow_programs))
    with (_Line(progress, "tune") as told,
          Parts(executor, "run_kinds" if all else "run_setting", arguments, filters, core) as parts):
        found = _core.tune(file, text, overrides, controller, ranges, minimise, bounds, seeds, held_out, evaluations, all,
                           filter_only, _jobs(jobs), allow_programs, core, parts, told)
        found["remarks"] += parts.remarks if parts else []
    _remark(found["remarks"])
    return TuneResult(found)


def sweep(study: Settings, *, set: Overrides = None, seeds: Optional[int] = None, filter_only: bool = False,
          jobs: int = 0, out: Union[None, str, "os.PathLike[str]"] = None,
          allow_programs: bool = False, executor: Optional[concurrent.futures.Executor] = None,
          progress: Progress = None) -> SweepResult:
    """Runs a study file: many settings of a scenario.

    seeds     number of them; None: as in the study file
    out       folder for the files of `gauntlet sweep`, which the same call continues; None: no files
    executor  computes the settings, one trial at a time per worker; the result has the same bytes
    """
    if seeds is not None and seeds < 1:
        raise SettingError("seeds", "", f"is {seeds}, must be 1 or more")
    if out is None:
        with tempfile.TemporaryDirectory(prefix="gauntlet-") as folder:
            return _sweep(study, set, seeds, filter_only, jobs, folder, None, allow_programs, executor, progress)
    return _sweep(study, set, seeds, filter_only, jobs, os.fspath(out), os.fspath(out), allow_programs, executor,
                  progress)


def identify(log: Union[str, "os.PathLike[str]"], *, source: str = "wearer", controller: str = "", array: str = "",
             topic: str = "", map: Union[str, "os.PathLike[str]"] = "", unit: str = "", episode: Optional[int] = None,
             rate_hz: float = 0.0, command: str = "", state: str = "", held: bool = False,
             progress: Progress = None) -> IdentifyResult:
    """Delay, lag and hysteresis of a hand from a log of commands and angles, or from an output folder.

    source      of an output folder: the chain from the wearer's angles ("wearer") or from the targets ("target")
    controller  of an output folder; empty: the scenario's first
    array, topic, map, unit, episode, rate_hz, command, state, held  as of `gauntlet identify`
    """
    if source not in ("wearer", "target"):
        raise SettingError("source", "", f"is {source}, must be wearer or target")
    if unit not in ("", "deg", "rad"):
        raise SettingError("unit", "", f"is {unit}, must be deg or rad")
    with _Line(progress, "identify") as told:
        found = _core.identify(os.fspath(log), controller, source == "wearer", _array(array, topic), os.fspath(map), unit,
                               episode, rate_hz, command, state, held, told)
    _remark(found["remarks"])
    return IdentifyResult(found)


def audit(log: Union[str, "os.PathLike[str]"], *, array: str = "", topic: str = "", command: str = "", state: str = "",
          map: Union[str, "os.PathLike[str]"] = "", unit: str = "", episode: Optional[int] = None,
          rate_hz: float = 0.0, progress: Progress = None) -> AuditResult:
    """What the commands of a data set are, and the delay and offset of each part. Arguments as of `gauntlet audit`."""
    if unit not in ("", "deg", "rad"):
        raise SettingError("unit", "", f"is {unit}, must be deg or rad")
    with _Line(progress, "audit") as told:
        found = _core.audit(os.fspath(log), _array(array, topic), command, state, os.fspath(map), unit, episode, rate_hz,
                            told)
    _remark(found["remarks"])
    return AuditResult(found)


def inspect(file: Union[str, "os.PathLike[str]"], *, rate_hz: float = 0.0, array: str = "", topic: str = "",
            preset: str = "", hand: str = "", map: Union[str, "os.PathLike[str]"] = "",
            unit: str = "", time_unit: str = "", columns: Optional[tuple[int, int]] = None) -> InspectResult:
    """What a recording is: format, rate, unit, joints, defects. Arguments as of `gauntlet inspect`."""
    if hand not in ("", "left", "right"):
        raise SettingError("hand", "", f"is {hand}, must be left or right")
    for name, value, choices in (("unit", unit, ("deg", "rad", "counts", "share", "percent", "volts")),
                                 ("time_unit", time_unit, ("s", "ms", "us", "ns"))):
        if value and value not in choices:
            raise SettingError(name, "", f"is {value}, must be one of: {', '.join(choices)}")
    found = _core.inspect(os.fspath(file), rate_hz, _array(array, topic), preset, hand, os.fspath(map), unit, time_unit,
                          columns, None)
    _remark(found["remarks"])
    return InspectResult(found)


def _run(comparison, scenario, set, controllers, seeds, jobs, causes, out, csv, mcap, allow_programs, progress,
         executor=None) -> StudyResult:
    folder = None if out is None else os.fspath(out)
    if folder == "":
        raise SettingError("out", "", "is empty, must be a folder")
    filters = _Filters()
    file, text = _source(scenario, "scenario", filters)
    overrides, chosen = _overrides(set, filters), _texts(controllers, "controllers")
    core = filters.core()
    arguments = (file, text, overrides, chosen, seeds, causes, allow_programs)
    with _Line(progress, "compare" if comparison else "run") as told, Parts(executor, "run_trials", arguments, filters, core) as parts:
        study, remarks = _core.run_study(file, text, overrides, chosen, comparison, seeds, _jobs(jobs), causes, folder or "",
                                         csv, mcap, allow_programs, core, parts, told)
        remarks += parts.remarks if parts else []
    _remark(remarks)
    return StudyResult(study, remarks, folder)


def _sweep(study, set, seeds, filter_only, jobs, folder, shown, allow_programs, executor, progress) -> SweepResult:
    filters = _Filters()
    file, text = _source(study, "study", filters)
    overrides = _overrides(set, filters)
    core = filters.core()
    arguments = (file, text, overrides, seeds, filter_only, allow_programs)
    with _Line(progress, "sweep") as told, Parts(executor, "run_cells", arguments, filters, core) as parts:
        found = _core.sweep(file, text, overrides, seeds, filter_only, _jobs(jobs), folder, allow_programs, core, parts, told)
        found["remarks"] += parts.remarks if parts else []
    _remark(found["remarks"])
    return SweepResult(found, shown)


def _texts(texts: Union[str, Sequence[str]], name: str) -> list[str]:
    if isinstance(texts, str):
        raise SettingError(name, "", f"is a text, must be a list: [{texts!r}]")
    return [str(text) for text in texts]


def _array(array: str, topic: str) -> str:
    if array and topic:
        raise SettingError("topic", "", "excludes array: a file has either")
    return array or topic


def _jobs(jobs: int) -> int:
    if not 0 <= jobs <= 1024:
        raise SettingError("jobs", "", f"is {jobs}, must be 1 to 1024, or 0 for one per processor")
    return jobs


def _remark(lines: Sequence[str]) -> None:
    for line in lines:
        warnings.warn(line.removeprefix("warning: "), Remark, stacklevel=4)


class _Line:
    """Progress as one line on standard error; inside a `with`, what the core calls, or None."""

    def __init__(self, progress: Progress, name: str) -> None:
        self._name = name
        self._is_drawn = False
        if progress is None:
            progress = sys.stderr is not None and sys.stderr.isatty()
        self._told = self._draw if progress is True else None if progress is False else progress

    def __enter__(self) -> Optional[Callable[[float, float], object]]:
        return self._told

    def __exit__(self, *error: object) -> None:
        if self._is_drawn:
            print(file=sys.stderr)

    def _draw(self, done: float, total: float) -> None:
        self._is_drawn = True
        share = 100 * done / total if total > 0 else 0
        print(f"\r{self._name}: {share:3.0f} %", end="", file=sys.stderr, flush=True)
