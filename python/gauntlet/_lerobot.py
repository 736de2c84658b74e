"""Traces as a LeRobot data set, version 3.0."""
from __future__ import annotations

import json
import os
import pathlib
import secrets
import shutil
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from ._errors import SettingError

if TYPE_CHECKING:
    from ._results import SignalArrays

_SIGNALS = {"action": "target_angle_rad", "observation.state": "hand_angle_rad"}
_FILE = "chunk-000/file-000.parquet"


def write(folder: Union[str, "os.PathLike[str]"], episodes: Sequence[tuple[str, SignalArrays]], fps: int) -> None:
    """An episode for each task and trace. Errors: SettingError; ImportError without pandas or pyarrow."""
    folder = pathlib.Path(folder)
    if folder.exists():
        raise SettingError("folder", "", f"{folder} exists; a data set needs a new folder")
    rate_hz = episodes[0][1].rate_hz
    if fps < 1 or fps > rate_hz or rate_hz % fps != 0:
        raise SettingError("fps", "", f"is {fps}, must be 1 or more and divide the {rate_hz:g} ticks per second")
    import pandas

    frames = [_frames(trace, fps) for _, trace in episodes]
    ends = np.cumsum([len(each["timestamp"]) for each in frames])
    names = episodes[0][1].names
    features: dict[str, dict[str, Any]] = {
        key: {"dtype": "float32", "shape": [len(names[signal])], "names": [f"{name}_rad" for name in names[signal]]}
        for key, signal in _SIGNALS.items()}
    rows, about = [], []
    for number, (each, end) in enumerate(zip(frames, ends)):
        count = len(each["timestamp"])
        each.update(frame_index=np.arange(count), episode_index=np.full(count, number), index=np.arange(end - count, end),
                    task_index=np.full(count, number))
        rows.append(pandas.DataFrame({key: list(values) for key, values in each.items()}))
        about.append({"episode_index": number, "tasks": [episodes[number][0]], "length": count, "dataset_from_index": end - count,
                      "dataset_to_index": end, "data/chunk_index": 0, "data/file_index": 0, "meta/episodes/chunk_index": 0,
                      "meta/episodes/file_index": 0,
                      **{f"stats/{key}/{name}": values for key, of in _statistics(each).items() for name, values in of.items()}})
    features["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
    for key in ("frame_index", "episode_index", "index", "task_index"):
        features[key] = {"dtype": "int64", "shape": [1], "names": None}
    info = {"codebase_version": "v3.0", "robot_type": "gauntlet", "total_episodes": len(frames), "total_frames": int(ends[-1]),
            "total_tasks": len(frames), "chunks_size": 1000, "data_files_size_in_mb": 100, "video_files_size_in_mb": 200,
            "fps": fps, "splits": {"train": f"0:{len(frames)}"}, "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
            "video_path": None, "features": features}
    folder.parent.mkdir(parents=True, exist_ok=True)
    unfinished = folder.with_name(f".{folder.name}-{secrets.token_hex(4)}")
    try:
        for part in ("meta/episodes/chunk-000", "data/chunk-000"):
            (unfinished / part).mkdir(parents=True)
        all_rows = pandas.concat(rows, ignore_index=True)
        all_rows.to_parquet(unfinished / "data" / _FILE, index=False)
        pandas.DataFrame(about).to_parquet(unfinished / "meta/episodes" / _FILE, index=False)
        tasks = pandas.DataFrame({"task_index": range(len(frames))}, index=[task for task, _ in episodes])
        tasks.to_parquet(unfinished / "meta/tasks.parquet")
        together = {key: np.concatenate([each[key] for each in frames]) for key in frames[0]}
        for name, content in (("info", info), ("stats", _statistics(together))):
            (unfinished / f"meta/{name}.json").write_text(json.dumps(content, indent=4))
        unfinished.rename(folder)
    except BaseException:
        shutil.rmtree(unfinished, ignore_errors=True)
        raise


def _frames(trace: SignalArrays, fps: int) -> dict[str, np.ndarray]:
    step = round(trace.rate_hz / fps)
    frames = {key: trace[signal][::step].astype(np.float32) for key, signal in _SIGNALS.items()}
    frames["timestamp"] = (np.arange(len(frames["action"])) / fps).astype(np.float32)
    return frames


def _statistics(frames: Mapping[str, np.ndarray]) -> dict[str, dict[str, list]]:
    """As LeRobot has them: a number for each column, and the count of rows."""
    statistics = {}
    for key, values in frames.items():
        columns = values.reshape(len(values), -1).astype(float)
        of = {"min": columns.min(0), "max": columns.max(0), "mean": columns.mean(0), "std": columns.std(0)}
        of |= {f"q{share:02d}": np.quantile(columns, share / 100, axis=0) for share in (1, 10, 50, 90, 99)}
        statistics[key] = {name: value.tolist() for name, value in of.items()} | {"count": [len(values)]}
    return statistics
