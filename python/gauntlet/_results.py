"""Results of commands: tables, texts, files."""
from __future__ import annotations

import base64
import csv
import html
import io
import json
import os
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple, Optional, Union

import numpy as np

from . import _lerobot
from ._errors import SettingError


class Column(NamedTuple):
    """A column of a table. `key` is its name in files; empty: for people only."""

    key: str
    heading: str
    unit: str


class Table(Sequence):
    """Rows of a result: each is a dict with the names and values of the CSV file."""

    def __init__(self, columns: list[Column], rows: list[dict[str, Any]], text: str = "", page: str = "") -> None:
        self.columns = columns
        self.rows = rows
        self._text = text
        self._html = page

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index):
        return self.rows[index]

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return iter(self.rows)

    def to_pandas(self):
        """A DataFrame with these rows. Errors: ImportError without pandas."""
        import pandas

        names = list(self.rows[0]) if self.rows else [column.key for column in self.columns if column.key]
        return pandas.DataFrame({name: _series([row[name] for row in self.rows]) for name in names})

    def __str__(self) -> str:
        return self._text or "\n".join(str(row) for row in self.rows)

    def __repr__(self) -> str:
        return f"<gauntlet.Table of {len(self)} rows>"

    def _repr_html_(self) -> str:
        if self._html:
            return self._html
        most = 100
        cells = lambda tag, values: "".join(f"<{tag}>{html.escape(_shown(value))}</{tag}>" for value in values)
        names = list(self.rows[0]) if self.rows else []
        body = "".join(f"<tr>{cells('td', row.values())}</tr>" for row in self.rows[:most])
        more = f"<p>{len(self) - most} more rows</p>" if len(self) > most else ""
        return f"<table><tr>{cells('th', names)}</tr>{body}</table>{more}"


def _series(values: list[Any]) -> list[Any]:
    """A missing number is NaN, so that pandas has a column of numbers."""
    is_words = any(isinstance(value, (str, bool)) for value in values)
    return values if is_words else [np.nan if value is None else value for value in values]


def _shown(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def table_of(described: dict[str, Any]) -> Table:
    columns = [Column(*column) for column in described["columns"]]
    return Table(columns, described["rows"], described["text"], described["html"])


def table_of_csv(text: str) -> Table:
    """The rows of a CSV file of ours: numbers are numbers, an empty field is None."""
    rows = [{key: _value(field) for key, field in row.items()} for row in csv.DictReader(io.StringIO(text))]
    names = next(csv.reader(io.StringIO(text)))
    return Table([Column(name, name, "") for name in names], rows)


def _value(field: str) -> Any:
    if field == "":
        return None
    for kind in (int, float):
        try:
            return kind(field)
        except ValueError:
            pass
    return field


class Result:
    """What a command found. print() shows the text of the terminal, Jupyter the tables of the page.

    data     the JSON of the command as a dict
    tables   all tables of the text, those of --verbose included
    remarks  what was repaired, replaced or ignored; each was also a warning (gauntlet.Remark)
    """

    def __init__(self, found: dict[str, Any], json_text: str, remarks: Sequence[str]) -> None:
        self._text = found["text"]
        self._html = found["html"]
        self.tables = [table_of(table) for table in found["tables"]]
        self.json = json_text
        self.data: dict[str, Any] = json.loads(json_text)
        self.remarks = list(remarks)

    @property
    def verdict(self) -> dict[str, Any]:
        """What is recommended, why, and with which warnings; empty for a command without one."""
        return self.data.get("verdict") or {}

    @property
    def table(self) -> Table:
        """The first table of the text."""
        return self.tables[0]

    def to_pandas(self):
        """`table` as a DataFrame. Errors: ImportError without pandas."""
        return self.table.to_pandas()

    def __str__(self) -> str:
        return self._text

    def _repr_html_(self) -> str:
        return self._html


class Figure:
    """A figure that Jupyter shows. svg: its text, complete as a file."""

    def __init__(self, svg: str) -> None:
        self.svg = svg

    def _repr_html_(self) -> str:
        # As an image, its style sheet does not reach the page around it.
        return f'<img src="data:image/svg+xml;base64,{base64.b64encode(self.svg.encode()).decode()}">'


class SignalArrays(dict):
    """Signals by name, as read-only arrays of ticks x columns that share their memory with the result.

    names    of the columns of each signal
    units    of each signal
    time_s   of each tick
    """

    def __init__(self, signals: dict[str, tuple], rate_hz: float) -> None:
        super().__init__({name: array for name, (array, *_) in signals.items()})
        self.names = {name: list(names) for name, (_, names, *_) in signals.items()}
        self.units = {name: unit for name, (_, _, unit, _) in signals.items()}
        self._columns = {name: column for name, (*_, column) in signals.items()}
        self.rate_hz = rate_hz

    @property
    def time_s(self) -> np.ndarray:
        return np.arange(self._ticks) / self.rate_hz

    @property
    def _ticks(self) -> int:
        return max((len(array) for array in self.values()), default=0)

    def to_xarray(self):
        """A Dataset with a variable per signal, its unit as attribute, over time_s (sample_time_s where it has a row per
        sample of the glove) and the names of its columns. Errors: ImportError without xarray."""
        import xarray

        variables, coordinates = {}, {"time_s": self.time_s}
        for name, array in self.items():
            time = "time_s" if len(array) == self._ticks else "sample_time_s"
            coordinates.setdefault(time, np.arange(len(array)) * round(self._ticks / len(array)) / self.rate_hz)
            coordinates[self._columns[name]] = self.names[name]
            variables[name] = ((time, self._columns[name]), array, {"units": self.units[name]})
        return xarray.Dataset(variables, coordinates)


class StudyResult(Result):
    """The result of run() or compare(); `data` is that of scores.json.

    controllers  names, in the order of the scenario
    folder       the output folder, or None
    """

    def __init__(self, study, remarks: Sequence[str], folder: Optional[str]) -> None:
        super().__init__(study.texts(), study.scores_json(), remarks)
        self._study = study
        self.name: str = study.name
        self.controllers: list[str] = study.controllers
        self.folder = folder

    @property
    def scores(self) -> Table:
        """A row per seed, controller and joint, motor or cable ("summary" for all): scores.csv."""
        return table_of_csv(self._study.scores_csv())

    def summary(self, metric: str) -> dict[str, float]:
        """A score of each controller: its value, or its mean in a comparison."""
        values = {}
        for controller in self.data["controllers"]:
            value = controller["summary"][metric]
            values[controller["name"]] = value["mean"] if isinstance(value, dict) else value
        return values

    def trace(self, controller: str) -> SignalArrays:
        """All signals of a controller in the first seed."""
        place = self.controllers.index(controller)
        return SignalArrays(self._study.trace(place), self._study.tick_rate_hz)

    def to_lerobot(self, folder: Union[str, "os.PathLike[str]"], *, controllers: Optional[Sequence[str]] = None,
                   fps: int = 50) -> None:
        """Writes a LeRobot data set (v3.0) into a new folder: an episode for each controller in the first seed, with its
        name as task. `action` is the joint angles commanded, `observation.state` those of the hand [rad].

        controllers  names; None: all
        fps          frames per second, a part of the tick rate
        Errors: SettingError; ImportError without pandas or pyarrow.
        """
        chosen = list(self.controllers if controllers is None else controllers)
        unknown = [name for name in chosen if name not in self.controllers]
        if unknown or not chosen:
            raise SettingError("controllers", "", f"{unknown[0]!r} is unknown, must be one of {', '.join(self.controllers)}"
                               if unknown else "is empty")
        _lerobot.write(folder, [(name, self.trace(name)) for name in chosen], fps)

    @property
    def glove(self) -> SignalArrays:
        """What all controllers share in the first seed: the glove's counts (a row per sample), the wearer's
        true angles and the reference of the scores (a row per tick)."""
        return SignalArrays(self._study.shared_signals(), self._study.tick_rate_hz)

    @property
    def figure(self) -> Optional[Figure]:
        """Jitter against delay of all controllers; None if no controller has both scores."""
        svg = self._study.figure()
        return Figure(svg) if svg else None

    def _repr_html_(self) -> str:
        figure = self.figure
        return super()._repr_html_() + (figure._repr_html_() if figure else "")

    @property
    def resolved_scenario(self) -> str:
        """YAML with every value used: run() of it repeats the run bit for bit."""
        return self._study.resolved_scenario()

    @property
    def scores_csv(self) -> str:
        """The text of scores.csv."""
        return self._study.scores_csv()

    @property
    def page(self) -> str:
        """report.html: one page that needs no other file."""
        return self._study.report_page()

    def __repr__(self) -> str:
        return f"<gauntlet.StudyResult of {self.name}: {', '.join(self.controllers)}>"


class TuneResult(Result):
    """The result of tune().

    controllers  YAML of each controller that was found, as it stands in a scenario below its name
    settings     a row per setting that was tried: tune.csv
    page         report.html
    """

    def __init__(self, found: dict[str, Any]) -> None:
        super().__init__(found, found["json"], found["remarks"])
        self.controllers: dict[str, str] = found["controllers"]
        self.settings = table_of_csv(found["csv"])
        self.page: str = found["page"]


class SweepResult(Result):
    """The result of sweep().

    cells   a row per setting: cells.csv
    folder  the output folder, or None
    """

    def __init__(self, found: dict[str, Any], folder: Optional[str]) -> None:
        super().__init__(found, found["json"], found["remarks"])
        self.cells = table_of_csv(found["csv"])
        self.folder = folder


class IdentifyResult(Result):
    """The result of identify().

    chain_yaml  the chain, as the key `chain` of a controller takes it
    hand_yaml   the servo with which the simulated hand answers so; empty where the log is not of a hand alone
    page        what was measured beside what the model makes of the same command
    """

    def __init__(self, found: dict[str, Any]) -> None:
        super().__init__(found, found["json"], found["remarks"])
        self.chain_yaml: str = found["chain_yaml"]
        self.hand_yaml: str = found["servo_yaml"]
        self.page: str = found["page"]


class AuditResult(Result):
    """The result of audit().

    page  delays, offsets by episode, and the largest error of each part
    """

    def __init__(self, found: dict[str, Any]) -> None:
        super().__init__(found, found["json"], found["remarks"])
        self.page: str = found["page"]


class InspectResult(Result):
    """The result of inspect().

    question     what has to be answered before the file drives a hand; empty: nothing
    starter_map  the text of a column map, to be checked; empty without sensors
    """

    def __init__(self, found: dict[str, Any]) -> None:
        super().__init__(found, found["json"], found["remarks"])
        self.question: str = found["question"]
        self.starter_map: str = found["starter_map"]
