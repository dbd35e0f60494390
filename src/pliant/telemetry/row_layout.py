"""Copies ticks of one structure into rows of numbers, fast enough for the control loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from pliant.signals import Tick
from pliant.spatial import Array
from pliant.telemetry.channels import Channel, ChannelGroup
from pliant.telemetry.info import RunInfo
from pliant.telemetry.mcap.topics import Topic, is_rotation, logged, quaternions, topics
from pliant.telemetry.schema import groups


@dataclass(frozen=True)
class RowLayout:
    """How a tick lies in a row: plain arrays, then the other arrays, then scalars.

    Plain are the signals' arrays that are float64 in C order: their bytes can be taken as they are, in a sixth of the
    time of `np.concatenate`. Diagnostics are copied with conversion, because their type may change.
    """

    plain: tuple[ChannelGroup, ...]
    arrays: tuple[ChannelGroup, ...]
    scalars: tuple[ChannelGroup, ...]
    channels: tuple[Channel, ...]
    """in the order of a row"""
    ends: tuple[int, int, int]
    """entry of a row at which each of the three parts ends"""
    topics: list[Topic]

    @classmethod
    def of(cls, tick: Tick, info: RunInfo, units: Sequence[Channel]) -> Self:
        """The layout of ticks like this one. Arguments and errors as of `groups`."""
        found = groups(tick, info, units)
        plain = tuple(group for group in found.signals if _is_plain(group, tick))
        arrays = (*(group for group in found.signals if group not in plain), *found.arrays)
        parts = [[c for group in part for c in group.channels] for part in (plain, arrays, found.scalars)]
        ends = np.cumsum([sum(channel.size for channel in part) for part in parts]).tolist()
        channels = tuple(channel for part in parts for channel in part)
        return cls(plain, arrays, found.scalars, channels, (ends[0], ends[1], ends[2]), topics(logged(channels)))

    def fill(self, tick: Tick, block: Block) -> None:
        """Copies a tick into a block's next row.

        Raises:
            ValueError, TypeError: an array has another size than in the layout, or holds no numbers; the row is then
                undefined.
        """
        plain_end, arrays_end, _ = self.ends
        row = block.rows[block.count]
        start = block.count * block.stride
        plain = _picked(self.plain, tick)
        try:
            block.view[start : start + 8 * plain_end] = b"".join(plain)
        except (ValueError, TypeError, BufferError):  # another memory layout or size: this raises the right error
            np.concatenate(plain, axis=None, out=row[:plain_end])
        if self.arrays:
            np.concatenate(_picked(self.arrays, tick), axis=None, out=row[plain_end:arrays_end])
        if self.scalars:
            row[arrays_end:] = _picked(self.scalars, tick)


def _picked(chosen: tuple[ChannelGroup, ...], tick: Tick) -> list[Any]:
    values: list[Any] = []
    for group in chosen:
        values += group.pick(tick)
    return values


def _is_plain(group: ChannelGroup, tick: Tick) -> bool:
    samples = [np.asarray(value) for value in group.pick(tick)]
    return all(sample.dtype == np.float64 and sample.flags.c_contiguous for sample in samples)


class Block:
    """Preallocated rows for ticks of one layout and one phase."""

    def __init__(self, layout: RowLayout, phase: str, size: int) -> None:
        self.layout, self.phase = layout, phase
        self.times = np.empty(size)
        self.rows = np.empty((size, layout.ends[-1]))
        self.view = self.rows.data.cast("B")
        """the bytes of the rows"""
        self.stride = 8 * layout.ends[-1]
        """bytes per row"""
        self.count = 0

    def columns(self) -> dict[str, Array]:
        """Channel as logged → (count, …) values."""
        found: dict[str, Array] = {}
        at = 0
        for channel in self.layout.channels:
            values = self.rows[: self.count, at : at + channel.size].reshape(-1, *channel.shape)
            at += channel.size
            (stored,) = logged([channel])
            found[stored.name] = quaternions(values) if is_rotation(channel) else values
        return found
