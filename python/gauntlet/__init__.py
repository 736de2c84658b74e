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
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Optional, Union

try:
    import numpy as _numpy
except ModuleNotFoundError:
    raise ImportError("gauntlet needs numpy: pip install numpy") from None

from . import _core
from ._errors import Remark, RunError, SettingError
from ._executors import Parts
from ._filters import Filters as _Filters, PythonFilter
from ._results import (AuditResult, Column, Figure, IdentifyResult, InspectResult, Result, SignalArrays, StudyResult,
                       SweepResult, Table, TuneResult)
from ._robot import Controller, Filter, check_robot, filter, filter_kinds, remark as _remark
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
