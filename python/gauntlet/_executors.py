"""Calls whose parts other processes compute: an executor of concurrent.futures, or one like it."""
from __future__ import annotations

import concurrent.futures
import concurrent.futures.process
import os
import pathlib
import secrets
import tempfile
from collections.abc import Mapping
from typing import Any, Optional

from . import _core
from ._errors import RunError, SettingError
from ._filters import Filters as _Filters


class Parts:
    """Sends parts of a call to an executor, and those again that are lost. The core asks it about 20 times per second:
    see python/elsewhere.h. Without an executor the `with` gives None."""

    MOST_TRIES = 3

    def __init__(self, executor: Optional[concurrent.futures.Executor], function: str, arguments: tuple, filters: _Filters,
                 core: Mapping[str, tuple[Any, str]]) -> None:
        if executor is not None and not callable(getattr(executor, "submit", None)):
            raise TypeError(f"executor must be a concurrent.futures.Executor, not {type(executor).__name__}")
        self._executor = executor
        file, text, *rest = arguments
        if text is not None or os.path.exists(file):
            file = os.path.abspath(file)  # a worker may be in another folder
        self.call = secrets.token_hex(16)
        identities = {name: identity for name, (_, identity) in core.items()}
        self._task = (function, (file, text, *rest), filters, identities, self.call)
        workers = getattr(executor, "_max_workers", 0) or getattr(executor, "num_workers", 0)
        self.most_parts = 4 * workers if isinstance(workers, int) and workers > 0 else 64
        self.remarks: list[str] = []
        self._parts: list[tuple[int, int]] = []
        self._about: list[str] = []
        self._tries: list[int] = []
        self._running: dict[concurrent.futures.Future, int] = {}

    def __enter__(self) -> Optional[Parts]:
        if self._executor is None:
            return None
        if isinstance(self._executor, concurrent.futures.ProcessPoolExecutor):
            self._executor.submit(os.getpid)  # so that it forks now, while no other thread works
        self._folder = tempfile.TemporaryDirectory(prefix="gauntlet-")
        return self

    def __exit__(self, *error: object) -> None:
        if self._executor is None:
            return
        for future in self._running:
            future.cancel()
        self._folder.cleanup()

    def begin(self, parts: list[tuple[int, int]], about: list[str]) -> None:
        self._parts = parts
        self._about = about
        self._tries = [0] * len(parts)
        for number in range(len(parts)):
            self._send(number)

    def finished(self) -> list[tuple[int, Optional[str]]]:
        """Parts that have come since: number and file; None for one that the caller has to compute."""
        came: list[tuple[int, Optional[str]]] = []
        for future in [future for future in self._running if future.done()]:
            number = self._running.pop(future)
            try:
                content = future.result()
            except (SettingError, RunError, KeyboardInterrupt):
                raise
            except concurrent.futures.process.BrokenProcessPool as lost:
                if not self.remarks:
                    self.remarks.append(f"executor: {_of_one_line(lost)} The rest is computed in this process.")
                came.append((number, None))
            except BaseException as lost:  # whatever the executor raises for a worker that is gone
                if self._tries[number] == self.MOST_TRIES:
                    raise RunError(f"executor: part {number + 1} of {len(self._parts)} failed {self.MOST_TRIES} times, at last "
                                   f"with {type(lost).__name__}: {_of_one_line(lost)}") from lost
                self._send(number)
            else:
                file = os.path.join(self._folder.name, f"{number}.db")
                pathlib.Path(file).write_bytes(content)
                came.append((number, file))
        return came

    def _send(self, number: int) -> None:
        self._tries[number] += 1
        try:
            future = self._executor.submit(_run_part, *self._task, self._about, *self._parts[number])
        except concurrent.futures.process.BrokenProcessPool as broken:
            future = concurrent.futures.Future()
            future.set_exception(broken)
        except Exception as refused:
            raise RunError(f"executor: takes no work: {_of_one_line(refused)}") from refused
        self._running[future] = number


def _run_part(function: str, arguments: tuple, filters: _Filters, identities: Mapping[str, str], call: str, about: list[str],
              first: int, end: int) -> bytes:
    """What a worker does: a study.db with some trials or cells. `about` is for functions that are asked more than once."""
    with tempfile.TemporaryDirectory(prefix="gauntlet-") as folder:
        file = os.path.join(folder, "study.db")
        asked = (about,) if about else ()
        getattr(_core, function)(*arguments, *asked, filters.core(identities), call, first, end, file)
        return pathlib.Path(file).read_bytes()


def _of_one_line(error: BaseException) -> str:
    return " ".join(str(error).split())
