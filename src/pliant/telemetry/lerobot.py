"""Logs as a data set of LeRobot, layout v2.1: an episode a log, Parquet and JSON, without pictures."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError, OutputError
from pliant.spatial import Array
from pliant.telemetry.log import Log
from pliant.telemetry.output import output_folder, write_text

if TYPE_CHECKING:
    import pyarrow as pa

_Numbers = npt.NDArray[Any]
_CHUNK = 1000  # episodes in a folder, as LeRobot has it
_DATA = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"
_COUNTERS = ("frame_index", "episode_index", "index", "task_index")
_STATE = ("measurement/q", "measurement/v", "measurement/torque")
ACTION = ("command/torque",)


@dataclass(frozen=True)
class _Feature:
    """A column of the data set: which channels stand in it, one after the other."""

    channels: tuple[str, ...]
    names: tuple[str, ...]
    """of its entries, with units"""


def export_lerobot(logs: Sequence[Log], folder: Path, *, fps: int = 50, action: Sequence[str] = ACTION) -> Path:
    """Writes logs as one data set.

    `observation.state` holds the measured joint angles, velocities and torques, `observation.wrench` the wrenches of
    the force sensors if there are any, `action` the channels asked for. A frame k is the sample that held at k/fps
    after the first one.

    Args:
        logs: an episode each, of the same robot and sensors.
        folder: made if it does not exist; it must be empty.
        fps: frames per second, at most the rate of the logs.
        action: channels that are the action, one after the other.

    Returns:
        The folder.

    Raises:
        ConfigError: no log, an unknown channel, logs that differ in their features, more frames than samples, or
            numbers that are not finite.
        OutputError: the folder is not empty or cannot be written.
    """
    if not logs:
        raise ConfigError("a data set needs one log at least")
    features = _features(logs[0], action)
    for log in logs:
        _check(log, logs[0], features, _features(log, action), fps)
    folder = output_folder(folder)
    if any(folder.iterdir()):
        raise OutputError(f"{folder} is not empty: a data set needs an empty folder")
    tasks = list(dict.fromkeys(_task(log) for log in logs))
    episodes: list[dict[str, Any]] = []
    stats: list[dict[str, Any]] = []
    first = 0
    for number, log in enumerate(logs):
        columns = _episode(log, features, fps, (number, first, tasks.index(_task(log))))
        count = len(columns["timestamp"])
        _write(folder / _DATA.format(episode_chunk=number // _CHUNK, episode_index=number), _table(columns))
        episodes.append({"episode_index": number, "tasks": [_task(log)], "length": count})
        stats.append({"episode_index": number, "stats": {name: _stats(values) for name, values in columns.items()}})
        first += count
    meta = output_folder(folder / "meta")
    write_text(meta / "info.json", json.dumps(_info(logs[0], features, fps, episodes, tasks), indent=4) + "\n")
    _write_lines(meta / "tasks.jsonl", [{"task_index": place, "task": task} for place, task in enumerate(tasks)])
    _write_lines(meta / "episodes.jsonl", episodes)
    _write_lines(meta / "episodes_stats.jsonl", stats)
    return folder


def _features(log: Log, action: Sequence[str]) -> dict[str, _Feature]:
    wrenches = tuple(name for name in log.matching("/wrench") if name.startswith("measurement/"))
    if not action:
        raise ConfigError("an action needs one channel at least, for example command/torque")
    found = {"observation.state": _feature(log, _STATE), "action": _feature(log, action)}
    return {**found, "observation.wrench": _feature(log, wrenches)} if wrenches else found


def _feature(log: Log, channels: Sequence[str]) -> _Feature:
    names: list[str] = []
    for channel in channels:
        log.time(channel)  # it exists
        about = log.channels[channel]
        size = int(np.prod(about.shape))
        labels = about.labels if len(about.labels) == size else tuple(map(str, range(size)))
        names += [f"{channel} {label} [{about.unit or '?'}]" for label in labels]
    return _Feature(tuple(channels), tuple(names))


def _check(log: Log, first: Log, here: dict[str, _Feature], there: dict[str, _Feature], fps: int) -> None:
    if here != there:
        raise ConfigError(f"{log.source} has other joints, sensors or actions than {first.source}: one data set each")
    rate = log.channels["measurement/q"].rate
    if not 1 <= fps <= max(rate, 1.0) * (1.0 + 1e-9):
        raise ConfigError(f"fps must be from 1 to the rate of {log.source}, {rate:.4g} Hz, got {fps}")


def _task(log: Log) -> str:
    return " ".join(part for part in (log.info.study, log.info.case) if part) or "unnamed"


def _episode(log: Log, features: Mapping[str, _Feature], fps: int, place: tuple[int, int, int]) -> dict[str, _Numbers]:
    """Column → (n,) or (n, k) values. Args: place: numbers of the episode, of its first frame, of its task."""
    begin, end = log.time("measurement/q")[[0, -1]]
    count = int((end - begin) * fps + 1e-6) + 1
    steps = np.arange(count)
    columns: dict[str, _Numbers] = {}
    for name, feature in features.items():
        parts = [_held(log, channel, begin + steps / fps) for channel in feature.channels]
        columns[name] = np.concatenate(parts, axis=1).astype(np.float32)
        if not np.isfinite(columns[name]).all():
            raise ConfigError(f"{log.source} has numbers that are not finite in {', '.join(feature.channels)}")
    columns["timestamp"] = (steps / fps).astype(np.float32)
    episode, first, task = place
    for name, values in zip(
        _COUNTERS, (steps, np.full(count, episode), first + steps, np.full(count, task)), strict=True
    ):
        columns[name] = values.astype(np.int64)
    return columns


def _held(log: Log, channel: str, at: Array) -> Array:
    """(n, k) samples that held at times; before the first one that one."""
    index = np.searchsorted(log.time(channel), at + 1e-6, side="right") - 1
    values = log[channel]
    return values[np.maximum(index, 0)].reshape(len(at), -1)


def _table(columns: Mapping[str, _Numbers]) -> pa.Table:
    import pyarrow as pa

    arrays: dict[str, Any] = {}
    for name, values in columns.items():
        flat = pa.array(np.ascontiguousarray(values).ravel())
        arrays[name] = flat if values.ndim == 1 else pa.FixedSizeListArray.from_arrays(flat, values.shape[1])
    return pa.table(arrays)


def _stats(values: _Numbers) -> dict[str, Any]:
    rows = values.reshape(len(values), -1).astype(np.float64)
    found = {"min": rows.min(axis=0), "max": rows.max(axis=0), "mean": rows.mean(axis=0), "std": rows.std(axis=0)}
    return {**{name: value.tolist() for name, value in found.items()}, "count": [len(rows)]}


def _info(
    log: Log, features: Mapping[str, _Feature], fps: int, episodes: Sequence[Mapping[str, Any]], tasks: Sequence[str]
) -> dict[str, Any]:
    described: dict[str, Any] = {
        name: {"dtype": "float32", "shape": [len(feature.names)], "names": list(feature.names)}
        for name, feature in features.items()
    }
    described["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
    described |= {name: {"dtype": "int64", "shape": [1], "names": None} for name in _COUNTERS}
    return {
        "codebase_version": "v2.1",
        "robot_type": log.info.robot,
        "total_episodes": len(episodes),
        "total_frames": sum(episode["length"] for episode in episodes),
        "total_tasks": len(tasks),
        "total_videos": 0,
        "total_chunks": (len(episodes) - 1) // _CHUNK + 1,
        "chunks_size": _CHUNK,
        "fps": fps,
        "splits": {"train": f"0:{len(episodes)}"},
        "data_path": _DATA,
        "video_path": None,
        "features": described,
    }


def _write(path: Path, table: pa.Table) -> None:
    import pyarrow.parquet as pq

    output_folder(path.parent)
    try:
        pq.write_table(table, path)
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror or error}") from error


def _write_lines(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    write_text(path, "".join(json.dumps(row, ensure_ascii=False) + "\n" for row in rows))
