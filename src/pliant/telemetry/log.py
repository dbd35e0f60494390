"""Reads a log back as arrays."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError, OutputError, options
from pliant.spatial import Array
from pliant.telemetry.columns import columns, data_frame
from pliant.telemetry.info import RunInfo
from pliant.telemetry.mcap.file_bytes import bytes_of
from pliant.telemetry.mcap.reader import Contents, Piece, read
from pliant.telemetry.mcap.topics import FIELDS, PREFIX

CLOCK = "pliant.clock"
"""metadata record of a run whose clock started below zero: MCAP has no such times, so the file's clock is ahead"""
_CACHED = 64 * 2**20  # bytes of channels that stay in memory; those of a longer log are read again


@dataclass(frozen=True, slots=True)
class LogChannel:
    """One channel of a log."""

    name: str
    unit: str
    """SI; empty if it was not registered"""
    shape: tuple[int, ...]
    """of one sample"""
    labels: tuple[str, ...]
    """names of a vector's entries"""
    count: int
    """samples"""
    rate: float
    """Hz: samples per second between the first and the last; 0 for fewer than two"""
    topic: str
    """ROS 2 topic that carries it"""


@dataclass(frozen=True, slots=True)
class _Stored:
    """Samples of one channel in the file: pieces of messages, and the bytes at which the numbers start."""

    topic: str
    unit: str
    shape: tuple[int, ...]
    labels: tuple[str, ...]
    pieces: list[tuple[Piece, Sequence[int]]]
    zero: int
    """ns of the file's clock at which that of the run is zero"""

    @property
    def count(self) -> int:
        return sum(piece.count for piece, _ in self.pieces)

    def times(self) -> Array:
        """(n,) s."""
        times = np.concatenate([piece.times() for piece, _ in self.pieces])
        return (times - self.zero).astype(np.float64) * 1e-9

    def ends(self) -> tuple[float, float]:
        """s: times of the first sample and the last."""
        first, last = self.pieces[0][0].times()[0], self.pieces[-1][0].times()[-1]
        return float(first - self.zero) * 1e-9, float(last - self.zero) * 1e-9

    def values(self) -> Array:
        """(n, …) numbers."""
        values = np.concatenate([_numbers(piece.messages(), offsets) for piece, offsets in self.pieces])
        return values.reshape(len(values), *self.shape)


class Log:
    """The contents of one log. What is asked for is read; a long log stays in its file.

    `log["measurement/q"]` is an array (n, joints), `log.time("measurement/q")` its times in s.
    """

    def __init__(self, source: str, contents: Contents) -> None:
        """Use `Log.open`."""
        self.source = source
        """its source"""
        self.truncated = not contents.complete
        """whether the file is truncated or damaged; the log then holds what could be read before"""
        self.metadata: Mapping[str, Mapping[str, str]] = MappingProxyType(contents.metadata)
        """name → metadata record of the file"""
        self.info = RunInfo.from_metadata(contents.metadata["pliant"])
        begin = int(contents.metadata.get(CLOCK, {}).get("zero_ns", "0"))
        self._stored = _channels(contents, begin)
        phases = contents.texts(f"{PREFIX}/reference/phase")
        self._phases = [(time - 1e-9 * begin, text) for time, text in phases]
        self._times: dict[tuple[int, ...], Array] = {}
        self._values: dict[str, Array] = {}
        self.channels: Mapping[str, LogChannel] = MappingProxyType(
            {name: self._describe(name, stored) for name, stored in sorted(self._stored.items())}
        )
        """name → what it is"""

    @staticmethod
    def open(source: Path | str | BinaryIO) -> Log:
        """Reads a log.

        Args:
            source: an MCAP file that pliant wrote, or a stream of one.

        Raises:
            OutputError: it cannot be read, is not MCAP, or was not written by pliant. A file that was cut off is read
                up to the cut.
        """
        name = str(source) if isinstance(source, (str, Path)) else "the log's stream"
        contents = read(name, bytes_of(Path(source)) if isinstance(source, (str, Path)) else source.read())
        if "pliant" not in contents.metadata:
            if not contents.complete:
                raise OutputError(f"{name} is cut off or damaged before anything that pliant could read")
            raise OutputError(f"{name} is an MCAP file, but not one of pliant's: it has no metadata record 'pliant'")
        try:
            return Log(name, contents)
        except Exception as error:  # records are readable, but their content is damaged
            if contents.complete:
                raise
            raise OutputError(f"{name} is damaged and cannot be read ({error})") from error

    @property
    def failure(self) -> str | None:
        """Why the run ended early; None if it did not or if it is not recorded."""
        return self.metadata.get("pliant.outcome", {}).get("failure") or None

    @property
    def duration(self) -> float:
        """s from the first sample to the last."""
        ends = [stored.ends() for stored in self._stored.values()]
        return max((last for _, last in ends), default=0.0) - min((first for first, _ in ends), default=0.0)

    def __contains__(self, name: object) -> bool:
        return name in self._stored

    def __getitem__(self, name: str) -> Array:
        """Values of a channel, (n, …).

        Raises:
            ConfigError: there is no such channel.
        """
        stored = self._found(name)
        values = self._values.pop(name, None)
        if values is None:
            values = stored.values()
            values.setflags(write=False)
        self._values[name] = values  # the last that was asked for stands last
        while sum(one.nbytes for one in self._values.values()) > _CACHED and len(self._values) > 1:
            del self._values[next(iter(self._values))]
        return values

    def time(self, name: str = "measurement/q") -> Array:
        """Times of a channel's samples, (n,) s since the start of the run.

        Raises:
            ConfigError: there is no such channel.
        """
        stored = self._found(name)
        key = tuple(id(piece) for piece, _ in stored.pieces)  # the channels of a topic share their times
        if key not in self._times:
            self._times[key] = stored.times()
            self._times[key].setflags(write=False)
        return self._times[key]

    def matching(self, suffix: str) -> list[str]:
        """Names of the channels with this ending."""
        return [name for name in self.channels if name.endswith(suffix)]

    def phases(self) -> list[tuple[float, str]]:
        """Begin (s) and name of each phase of the reference."""
        return list(self._phases)

    def to_pandas(self, *names: str) -> Any:
        """Channels as a pandas DataFrame, a column per number, "time" in s first; see `telemetry.columns`.

        Raises:
            ConfigError: an unknown channel, or channels that were not sampled at the same times.
            MissingExtraError: pandas is not installed.
        """
        return data_frame("pandas", columns(self, names))

    def to_polars(self, *names: str) -> Any:
        """The same as a polars DataFrame."""
        return data_frame("polars", columns(self, names))

    def _found(self, name: str) -> _Stored:
        if name not in self._stored:
            raise ConfigError(f"{self.source} has no channel {name!r}; {options(self._stored, name)}")
        return self._stored[name]

    def _describe(self, name: str, stored: _Stored) -> LogChannel:
        first, last = stored.ends()
        rate = (stored.count - 1) / (last - first) if last > first else 0.0
        return LogChannel(name, stored.unit, stored.shape, stored.labels, stored.count, rate, stored.topic)


# ---------------------------------------------------------------------- from bytes to arrays


def _channels(contents: Contents, begin: int) -> dict[str, _Stored]:
    """Args: begin: ns of the file's clock at which that of the run is zero."""
    found: dict[str, _Stored] = {}
    for key in sorted(contents.channels):
        channel = contents.channels[key]
        fields = json.loads(channel.metadata.get(FIELDS, "{}"))
        pieces = contents.pieces.get(key, [])
        for name, about in fields.items() if pieces else ():
            shape, offsets = tuple(about["shape"]), tuple(about["offsets"])
            if max(offsets, default=0) + 8 > min(piece.length for piece in pieces):
                raise ValueError(f"messages of {channel.topic} are shorter than {name} needs")
            if name in found and found[name].shape != shape:
                name = f"{name}[{','.join(map(str, shape))}]"  # a channel whose shape changed on the way
            new = _Stored(channel.topic, about["unit"], shape, tuple(about["labels"]), [], begin)
            found.setdefault(name, new).pieces.extend((piece, offsets) for piece in pieces)
    return found


def _numbers(messages: npt.NDArray[np.uint8], offsets: Sequence[int]) -> Array:
    """(n, k) float64 from messages (n, bytes) and the bytes at which the numbers start."""
    n, k = len(messages), len(offsets)
    if k and list(offsets) == list(range(offsets[0], offsets[0] + 8 * k, 8)):  # neighbours, in one go
        return np.ascontiguousarray(messages[:, offsets[0] : offsets[0] + 8 * k]).view("<f8")
    values = np.empty((n, k))
    for column, offset in enumerate(offsets):
        values[:, column] = np.ascontiguousarray(messages[:, offset : offset + 8]).view("<f8")[:, 0]
    return values
