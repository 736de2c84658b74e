"""Filters of your own as objects of Python, in place of those of Gauntlet."""
from __future__ import annotations

import hashlib
import inspect
import os
import pathlib
import secrets
import sys
import time
import traceback
import types
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Optional

import numpy as np

from ._errors import SettingError

_PREFIX = "python:"
_FACTS = ("rate_hz", "channels")


class PythonFilter:
    """A filter of your own, with settings, in a dict of a scenario: {"filter": PythonFilter(Mine, parameters={"a": 0.1})}.

    make           class or function; make(rate_hz=.., channels=[..], **parameters) returns an object for one filter of
                   one trial. Its step(sample) gets an array with a value for each channel and returns as many. If it
                   has start_channel(index), this is called where the samples of a channel were not trusted for a
                   while: its next sample is as its first one. Else it gets the last good value meanwhile.
    parameters     numbers by name, which tune() and sweep() can change: "filter.parameters.a"
    deterministic  the answers depend on samples and parameters alone: finished trials are kept if `make` is at the
                   top level of a file that has not changed since Python started
    channels       names or numbers (from 1) of the channels that it filters; empty: all
    array          `make` is a function over arrays: make(samples, rate_hz=.., **parameters) returns an array of the
                   shape of `samples` (samples x channels). It is called with all samples up to the present one, so the
                   time grows with the square of the length. A value that changes by more than 1e-9 of the largest
                   when later samples come is refused: the function looks ahead.
    """

    def __init__(self, make: Callable[..., Any], *, parameters: Optional[Mapping[str, float]] = None,
                 deterministic: bool = False, channels: Sequence[Any] = (), array: bool = False) -> None:
        if not callable(make):
            raise TypeError(f"make must be a class or a function, not {type(make).__name__}")
        self.make = make
        self.parameters = dict(parameters or {})
        self.deterministic = bool(deterministic)
        self.channels = [channels] if isinstance(channels, str) else list(channels)
        self.array = bool(array)
        for name in _FACTS:
            if name in self.parameters:
                raise SettingError("PythonFilter", f"parameters.{name}", "is given by Gauntlet, must have another name")

    def __repr__(self) -> str:
        return f"<gauntlet.PythonFilter of {_name(self.make)}>"


class LooksAhead(ValueError):
    """A function over arrays changes earlier values when later samples come."""


class Filters:
    """The objects among the settings of one call, and the names that stand for them."""

    def __init__(self) -> None:
        self._known: dict[str, PythonFilter] = {}

    def replace(self, value: Any) -> Any:
        """The value with settings of kind `external` in place of objects."""
        if isinstance(value, Mapping):
            return {key: self.replace(item) for key, item in value.items()}
        if isinstance(value, (list, tuple)):
            return [self.replace(item) for item in value]
        if isinstance(value, PythonFilter):
            return self._settings(value)
        return self._settings(PythonFilter(value)) if callable(value) else value

    def core(self, identities: Optional[Mapping[str, str]] = None) -> dict[str, tuple[Callable[..., Any], str]]:
        """As the core takes them. `identities`: those that another process found."""
        known = identities or {name: _identity(given) for name, given in self._known.items()}
        return {name: (_maker(given), known[name]) for name, given in self._known.items()}

    def _settings(self, given: PythonFilter) -> dict[str, Any]:
        settings: dict[str, Any] = {"kind": "external", "command": _PREFIX + self._name_of(given)}
        if given.deterministic:
            settings["deterministic"] = True
        if given.parameters:
            settings["parameters"] = given.parameters
        if given.channels:
            settings["channels"] = given.channels
        return settings

    def _name_of(self, given: PythonFilter) -> str:
        name, number = _name(given.make), 1
        while name in self._known:
            other = self._known[name]
            if other.make is given.make and other.array == given.array:
                return name
            number += 1
            name = f"{_name(given.make)}_{number}"
        self._known[name] = given
        return name


def reason(error: BaseException, trace: Optional[types.TracebackType]) -> str:
    """An exception of a filter as the end of a sentence, with its line outside of this package."""
    text = str(error)
    if isinstance(error, LooksAhead):
        return text
    text = f"{type(error).__name__}: {text}" if text else type(error).__name__
    package = os.path.dirname(os.path.abspath(__file__)) + os.sep
    for frame in reversed(traceback.extract_tb(trace)):
        if not os.path.abspath(frame.filename).startswith(package):
            return f"{text} ({os.path.basename(frame.filename)}:{frame.lineno})"
    return text


class _ArrayFilter:
    """A function over arrays as a filter: the last row of its answer to all samples so far."""

    TOLERANCE = 1e-9  # of the largest value

    def __init__(self, function: Callable[..., Any], rate_hz: float, channels: list[str], parameters: dict[str, float]) -> None:
        self._function = function
        self._settings = {"rate_hz": rate_hz, **parameters}
        self._channels = channels
        self._samples = np.empty((1024, len(channels)))
        self._answers = np.empty_like(self._samples)
        self._count = 0
        self._largest = 0.0

    def step(self, sample: np.ndarray) -> np.ndarray:
        if self._count == len(self._samples):
            self._samples = np.concatenate([self._samples, np.empty_like(self._samples)])
            self._answers = np.concatenate([self._answers, np.empty_like(self._answers)])
        self._samples[self._count] = sample
        self._count += 1
        answer = np.asarray(self._function(self._samples[:self._count].copy(), **self._settings))
        if answer.shape != (self._count, len(self._channels)):
            raise ValueError(f"returned an array of shape {answer.shape}, must be {(self._count, len(self._channels))}")
        last = answer[-1]
        self._answers[self._count - 1] = last
        self._largest = max(self._largest, float(np.abs(last).max()))
        self._check_earlier(answer[:-1])
        return last

    def _check_earlier(self, answer: np.ndarray) -> None:
        change = np.abs(answer - self._answers[:self._count - 1])
        wrong = ~(change <= self.TOLERANCE * self._largest)
        if not wrong.any():
            return
        row = int(np.argmax(wrong.any(axis=1)))
        column = int(np.argmax(np.where(wrong[row], change[row], -1)))
        raise LooksAhead(f"{_PREFIX}{_name(self._function)} looks ahead: its value of {self._channels[column]} at sample "
                         f"{row + 1} changes by {change[row, column]:.3g} when sample {self._count} comes, must not change "
                         f"by more than {self.TOLERANCE:g} of the largest value")


def _maker(given: PythonFilter) -> Callable[[float, list[str], dict[str, float]], Any]:
    if given.array:
        return lambda rate_hz, channels, parameters: _ArrayFilter(given.make, rate_hz, channels, parameters)
    return lambda rate_hz, channels, parameters: given.make(rate_hz=rate_hz, channels=channels, **parameters)


def _name(make: Callable[..., Any]) -> str:
    """For messages and files: letters, digits and underscores."""
    name = getattr(make, "__name__", type(make).__name__)
    return "".join(letter if letter.isalnum() and letter.isascii() else "_" for letter in name).strip("_") or "filter"


def _identity(given: PythonFilter) -> str:
    """Of the code: equal for equal bytes of its files. Another one at each call where they are not known for sure."""
    files = _files(given.make)
    if not files:
        return secrets.token_hex(16)
    code = hashlib.sha256(f"{given.make.__qualname__} {given.array}\n".encode())
    for file in files:
        code.update(file.read_bytes())
    return code.hexdigest()


def _files(make: Callable[..., Any]) -> list[pathlib.Path]:
    """The files of a class with its bases or of a function at the top level of a module; none where one of them is
    not known, or was written since Python started: what was imported may be older."""
    module = sys.modules.get(getattr(make, "__module__", None) or "")
    if getattr(module, getattr(make, "__qualname__", ""), None) is not make:
        return []
    files = []
    for part in inspect.getmro(make)[:-1] if isinstance(make, type) else [make]:
        try:
            file = pathlib.Path(inspect.getsourcefile(part) or "")
            if isinstance(part, type) and not part.__flags__ & _MADE_BY_PYTHON or not file.is_file() or file.stat().st_mtime >= _STARTED_S:
                return []
        except (TypeError, OSError):  # built in, or not there
            return []
        files.append(file)
    return files


def _start_s() -> float:
    """When this process started, in seconds as of files."""
    fields = pathlib.Path("/proc/self/stat").read_text().rpartition(")")[2].split()
    since_boot_s = int(fields[19]) / os.sysconf("SC_CLK_TCK")
    return time.time() - time.clock_gettime(time.CLOCK_BOOTTIME) + since_boot_s - 0.02  # of clock ticks


_STARTED_S = _start_s()
_MADE_BY_PYTHON = 1 << 9  # Py_TPFLAGS_HEAPTYPE
