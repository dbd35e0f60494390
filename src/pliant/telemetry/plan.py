"""Copies ticks of one structure into rows of numbers, fast enough for the control loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from pliant.signals import Tick
from pliant.spatial import Array
from pliant.telemetry.info import RunInfo
from pliant.telemetry.schema import Channel, Groups, groups
from pliant.telemetry.topics import Topic, is_rotation, logged, quaternions, topics


@dataclass(frozen=True)
class Plan:
    """How a tick lies in a row: arrays of the signals, then array diagnostics, then scalars."""

    groups: Groups
    channels: tuple[Channel, ...]
    """in the order of a row"""
    ends: tuple[int, int, int]
    """entry of a row at which each of the three parts ends"""
    topics: list[Topic]
    plain: bool
    """whether every array of the signals is float64 and in C order, so that its bytes can be taken as they are"""

    @classmethod
    def of(cls, tick: Tick, info: RunInfo, units: Sequence[Channel]) -> Self:
        """The plan for ticks like this one. Arguments and errors as of `groups`."""
        found = groups(tick, info, units)
        parts = [[c for group in part for c in group.channels] for part in (found.signals, found.arrays, found.scalars)]
        ends = np.cumsum([sum(channel.size for channel in part) for part in parts]).tolist()
        channels = tuple(channel for part in parts for channel in part)
        samples = [np.asarray(value) for group in found.signals for value in group.pick(tick)]
        plain = all(sample.dtype == np.float64 and sample.flags.c_contiguous for sample in samples)
        return cls(found, channels, (ends[0], ends[1], ends[2]), topics(logged(channels)), plain)

    def fill(self, tick: Tick, block: Block) -> None:
        """Copies a tick into a block's next row.

        Raises:
            ValueError, TypeError: an array has another size than the plan's, or holds something else than numbers; the
            row is then
                undefined.
        """
        if self.plain:
            try:
                self._fill_bytes(tick, block)
                return
            except (ValueError, TypeError, BufferError):
                pass  # another memory layout or size than usual: the slow way tells which
        self._fill_numbers(tick, block)

    def _fill_bytes(self, tick: Tick, block: Block) -> None:
        """The signals as bytes, in a sixth of the time of `np.concatenate`."""
        signals: list[Any] = []
        for group in self.groups.signals:
            signals += group.pick(tick)
        start = block.count * block.stride
        block.view[start : start + 8 * self.ends[0]] = b"".join(signals)
        self._fill_rest(tick, block.rows[block.count])

    def _fill_numbers(self, tick: Tick, block: Block) -> None:
        row = block.rows[block.count]
        signals: list[Any] = []
        for group in self.groups.signals:
            signals += group.pick(tick)
        np.concatenate(signals, axis=None, out=row[: self.ends[0]])
        self._fill_rest(tick, row)

    def _fill_rest(self, tick: Tick, row: Array) -> None:
        _, arrays_end, _ = self.ends
        if self.groups.arrays:
            arrays: list[Any] = []
            for group in self.groups.arrays:
                arrays += group.pick(tick)
            np.concatenate(arrays, axis=None, out=row[self.ends[0] : arrays_end])
        if self.groups.scalars:
            numbers: list[float] = []
            for group in self.groups.scalars:
                numbers += group.pick(tick)
            row[arrays_end:] = numbers


class Block:
    """Preallocated rows for ticks of one plan and one phase."""

    def __init__(self, plan: Plan, phase: str, size: int) -> None:
        self.plan, self.phase = plan, phase
        self.times = np.empty(size)
        self.rows = np.empty((size, plan.ends[-1]))
        self.view = self.rows.data.cast("B")
        """the bytes of the rows"""
        self.stride = 8 * plan.ends[-1]
        """bytes per row"""
        self.count = 0

    def columns(self) -> dict[str, Array]:
        """Channel as logged → (count, …) values."""
        found: dict[str, Array] = {}
        at = 0
        for channel in self.plan.channels:
            values = self.rows[: self.count, at : at + channel.size].reshape(-1, *channel.shape)
            at += channel.size
            (stored,) = logged([channel])
            found[stored.name] = quaternions(values) if is_rotation(channel) else values
        return found
