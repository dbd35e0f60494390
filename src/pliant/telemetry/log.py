"""Reads a log back as arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
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
from pliant.telemetry.mcap.reader import Contents, read
from pliant.telemetry.mcap.topics import PREFIX
from pliant.telemetry.stored import StoredChannel, stored_channels

CLOCK = "pliant.clock"
"""metadata record of a run whose clock started below zero: MCAP has no such times, so the file's clock is ahead"""
_CACHED = 64 * 2**20  # bytes of channels that stay in memory; those of a longer log are read again
_PART = 8 * 512  # samples of a long log that are read at once: a few chunks, which stay unpacked for other channels


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
        self._stored = stored_channels(contents, begin)
        phases = contents.texts(f"{PREFIX}/reference/phase")
        self._phases = [(time - 1e-9 * begin, text) for time, text in phases]
        self._held = contents.held
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
            values = stored.values(0, stored.count)
            values.setflags(write=False)
        self._values[name] = values  # the last that was asked for stands last
        while sum(one.nbytes for one in self._values.values()) > _CACHED and len(self._values) > 1:
            del self._values[next(iter(self._values))]
        return values

    def parts(
        self, *names: str, where: npt.NDArray[np.bool_] | None = None, before: int = 0
    ) -> Iterator[tuple[Array, ...]]:
        """Channels side by side, some thousand samples of a long log at a time, all of another: what is made of them
        needs no memory that grows with the log.

        Args:
            names: channels. Where one has fewer samples than another, it began later: the last ones stand side by side.
            where: samples that count, one after the other, of the channel that has fewest; None: all.
            before: samples that a part has once more of the one before it, 1 for changes from sample to sample.

        Yields:
            (k, …) of each channel, in the order of the names; nothing where no sample counts.

        Raises:
            ConfigError: there is no such channel.
        """
        stored = [self._found(name) for name in names]
        begin, end = 0, min(one.count for one in stored)
        skipped = [one.count - end for one in stored]
        if where is not None:
            begin, end = int(np.argmax(where)), len(where) - int(np.argmax(where[::-1]))
            begin = begin if where.any() else end
        size = end - begin if self._held else _PART
        for start in range(begin, end, max(size, 1)):
            first, last = max(start - before, begin), min(start + size, end)
            yield tuple(
                self[name][skip + first : skip + last] if self._held else one.values(skip + first, skip + last)
                for name, one, skip in zip(names, stored, skipped, strict=True)
            )

    def time(self, name: str = "measurement/q") -> Array:
        """Times of a channel's samples, (n,) s since the start of the run.

        Raises:
            ConfigError: there is no such channel.
        """
        stored = self._found(name)
        key = tuple(id(piece.chunks) for piece, _ in stored.pieces)  # the channels of a row share their times
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

    def _found(self, name: str) -> StoredChannel:
        if name not in self._stored:
            raise ConfigError(f"{self.source} has no channel {name!r}; {options(self._stored, name)}")
        return self._stored[name]

    def _describe(self, name: str, stored: StoredChannel) -> LogChannel:
        first, last = stored.ends()
        rate = (stored.count - 1) / (last - first) if last > first else 0.0
        return LogChannel(name, stored.unit, stored.shape, stored.labels, stored.count, rate, stored.topic)
