"""The numbers of a tick as a row: which ticks have the same row, and where each channel stands in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from pliant._telemetry import Row
from pliant.flat_channels import FlatChannels
from pliant.signals import Tick
from pliant.spatial import Array
from pliant.telemetry.channels import Channel, Path, PlacedChannel
from pliant.telemetry.info import RunInfo
from pliant.telemetry.mcap.topics import Topic, is_rotation, logged, topics, upper_quaternions
from pliant.telemetry.schema import channels_of

_MAPPINGS = {
    "measurement": ("wrenches",),
    "estimate": ("wrenches", "contacts", "environments", "surfaces"),
    "reference": ("diagnostics",),
    "command": ("diagnostics",),
    "truth": ("positions", "rotations", "wrenches", "objects"),
}
"""signal → its mappings; their keys determine the channels"""
_OPTIONAL = (("estimate", "disturbance"), ("reference", "posture"), ("truth", "limit_excess"))


_Known = dict[Callable[[Array], Tick], "Copied | None"]


@dataclass(frozen=True)
class RowLayout:
    """How a tick lies in a row: one channel after the other."""

    row: Row
    channels: tuple[Channel, ...]
    """in the order of a row"""
    topics: list[Topic]
    known: _Known = field(default_factory=dict[Callable[[Array], Tick], "Copied | None"])
    """what makes ticks of a block → where their numbers stand in a row"""

    def copied(self, tick: Callable[[Array], Tick], size: int) -> Copied | None:
        """Which numbers of a block's row (size,) are which of a log's row; None: not all of them are copies."""
        if tick not in self.known:
            self.known.clear()  # ticks of another structure do not come again
            self.known[tick] = _copied(self.row, tick, size)
        return self.known[tick]

    @classmethod
    def of(cls, tick: Tick, info: RunInfo, units: Sequence[Channel]) -> Self:
        """The layout of ticks like this one. Arguments and errors as of `channels_of`."""
        found = channels_of(tick, info, units)
        channels = tuple(placed.channel for placed in found)
        return cls(_row(tick, found), channels, topics(logged(channels)))

    def misfit(self, offset: int) -> str:
        """Name of the channel that stands at an offset of the row; beyond it: what a tick consists of."""
        at = 0
        for channel in self.channels:
            if at == offset:
                return channel.name
            at += channel.size
        return "its parts"


@dataclass(frozen=True)
class Copied:
    """Where a log's row has its numbers from."""

    time: int
    """place of the time in s"""
    to: npt.NDArray[np.intp]
    source: npt.NDArray[np.intp]
    """(k,) places in the log's row, and those in the block's row that they are copies of"""
    constant: Array
    """(width,) the log's row where it does not depend on the block's"""


def _copied(row: Row, tick: Callable[[Array], Tick], size: int) -> Copied | None:
    """Asks for the rows of ticks whose numbers are 0 or 1: bit by bit, the places of a block's row, counted from 1."""
    digits = 1 << np.arange((size + 1).bit_length())
    places = np.arange(1, size + 1)
    bits, times = np.empty((len(digits), row.width)), 0
    for i, digit in enumerate(digits.tolist()):
        made = tick((places & digit != 0).astype(np.float64))
        if row.fill(made, bits, i) >= 0:
            return None
        times += digit * int(made.measurement.time)
    varies = np.ptp(bits, axis=0) > 0.0
    found = digits @ bits[:, varies]
    if not np.isin(bits[:, varies], (0.0, 1.0)).all() or found.max(initial=0.0) > size:
        return None
    return Copied(times - 1, np.flatnonzero(varies), found.astype(np.intp) - 1, bits[0])


def _row(tick: Tick, found: Sequence[PlacedChannel]) -> Row:
    row = Row(FlatChannels)
    for signal, names in _MAPPINGS.items():
        for name in names if getattr(tick, signal) is not None else ():
            keys: Mapping[str, Any] = attrgetter(f"{signal}.{name}")(tick)
            row.mapping((signal, name), tuple(keys))
    row.items(("reference", "tasks"), len(tick.reference.tasks))
    for index, task in enumerate(tick.reference.tasks):
        row.text(("reference", "tasks", index, "frame"), task.frame)
    for path in _absent(tick):
        row.none(path)
    offset = 0
    for placed in found:
        if placed.channel.shape:
            row.array(placed.path, offset, placed.channel.size)
        else:
            row.number(placed.path, offset)
        offset += placed.channel.size
    return row


def _absent(tick: Tick) -> list[Path]:
    """Places of a tick that are None, where others have channels."""
    found: list[Path] = [] if tick.truth is not None else [("truth",)]
    for signal, name in _OPTIONAL:
        part = getattr(tick, signal)
        if part is not None and getattr(part, name) is None:
            found.append((signal, name))
    for index, task in enumerate(tick.reference.tasks):
        path: Path = ("reference", "tasks", index)
        if task.rotation is None:
            found.append((*path, "rotation"))
        if task.tuning is None:
            found.append((*path, "tuning"))
        elif task.tuning.linear_range is None:
            found.append((*path, "tuning", "linear_range"))
    return found


class Block:
    """Preallocated rows for ticks of one layout and one phase."""

    def __init__(self, layout: RowLayout, phase: str, size: int) -> None:
        self.layout, self.phase = layout, phase
        self.times = np.empty(size)
        self.rows = np.empty((size, layout.row.width))
        self.count = 0
        self._fill = layout.row.fill

    def add(self, tick: Tick) -> bool:
        """Copies a tick into the next row. False: the block is full, or the tick has another layout or phase."""
        count = self.count
        if count == len(self.times) or tick.reference.phase != self.phase or self._fill(tick, self.rows, count) >= 0:
            return False
        self.times[count] = tick.measurement.time
        self.count = count + 1
        return True

    def add_rows(self, numbers: Array, tick: Callable[[Array], Tick]) -> int:
        """Copies ticks of a block (k, size) that have this layout and phase. Returns how many: as many as there is room
        for, none where a number of a tick is no copy of the block's.

        Args:
            numbers: a row of each.
            tick: a row → the tick, made of views of it.
        """
        count = min(len(numbers), len(self.times) - self.count)
        copied = self.layout.copied(tick, numbers.shape[1]) if count else None
        if copied is None:
            return 0
        rows = slice(self.count, self.count + count)
        self.times[rows] = numbers[:count, copied.time]
        self.rows[rows] = copied.constant
        self.rows[rows, copied.to] = numbers[:count, copied.source]
        self.count += count
        return count

    def columns(self) -> dict[str, Array]:
        """Channel as logged → (count, …) values."""
        found: dict[str, Array] = {}
        at = 0
        for channel in self.layout.channels:
            values = self.rows[: self.count, at : at + channel.size].reshape(-1, *channel.shape)
            at += channel.size
            (stored,) = logged([channel])
            found[stored.name] = upper_quaternions(values) if is_rotation(channel) else values
        return found
