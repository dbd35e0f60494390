"""Rows of a task worked out ahead, moved and read, in Python: the twin of cpp/references."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from pliant.interfaces import CLOCK_ROUNDING
from pliant.spatial import Array

POSITION, ROTATION, VELOCITY, ACCELERATION = slice(0, 3), slice(3, 12), slice(12, 18), slice(18, 24)
WRENCH, AXES = slice(24, 30), slice(30, 39)
NORMAL, NORMAL_RATE, NORMAL_BEND = slice(39, 45), slice(45, 51), slice(51, 57)
POSTURE = slice(57, None)
CHUNK, FAR = 128, 512
Height = tuple[float, float, float]


class RowsAheadTwin:
    """A cache: what it gives depends on the time asked for, not on what was asked before."""

    def __init__(self, rows: Callable[[Array], Array]) -> None:
        self._rows = rows
        self._origin = self._period = 0.0
        self._first = self._now = 0
        self._table = np.zeros((0, 0))

    def row(self, time: float, period: float) -> Array:
        index = self._index(time)
        if index is None or not self._now <= index <= self._now + FAR:
            if period <= 0.0:
                return self._rows(_clean(np.array([time])))[0]
            self._origin, self._period, self._first, self._now = time, period, 0, 0
            self._table, index = np.zeros((0, 0)), 0
        self._reach(index)
        self._now = index
        return self._table[index - self._first]

    def rows(self, times: Array) -> Array:
        first, last, gaps = self._index(float(times[0])), self._index(float(times[-1])), max(len(times) - 1, 1)
        if first is None or last is None or first < self._now or last > self._now + FAR or (last - first) % gaps:
            return self._rows(_clean(times))
        self._reach(last)
        begin, end = first - self._first, last - self._first
        return self._table[begin : end + 1 : max((last - first) // gaps, 1)].copy()

    def _index(self, time: float) -> int | None:
        if self._period == 0.0:
            return None
        steps = (time - self._origin) / self._period
        index = round(steps)
        return index if abs(steps - index) * self._period < CLOCK_ROUNDING else None

    def _reach(self, last: int) -> None:
        have = self._first + len(self._table)
        if last < have:
            return
        ticks = np.arange(have, max(last + 1, have + CHUNK), dtype=np.float64)
        more = self._rows(_clean(self._origin + self._period * ticks))
        kept = self._table[self._now - self._first :]
        self._table = np.concatenate([kept, more]) if len(kept) else more
        self._first = have + len(ticks) - len(self._table)


def _clean(times: Array) -> Array:
    return np.rint(1e9 * np.maximum(times, 0.0)) / 1e9  # ns


def parts_twin(row: Array, offset: Array | None, height: Height | None) -> tuple[Array, ...]:
    """Position, rotation, velocity, acceleration, wrench, axes and posture of a row that is moved."""
    position, velocity, acceleration = row[POSITION], row[VELOCITY], row[ACCELERATION]
    if offset is not None:
        position = position + offset
    if height is not None:
        h, h_dot, h_ddot = height
        n, n_dot, n_ddot = row[NORMAL], row[NORMAL_RATE], row[NORMAL_BEND]
        position, velocity, acceleration = position + h * n[:3], velocity + h * n_dot, acceleration + h * n_ddot
        if h_dot or h_ddot:
            velocity = velocity + h_dot * n
            acceleration = acceleration + 2.0 * h_dot * n_dot + h_ddot * n
    rotation, axes = row[ROTATION].reshape(3, 3), row[AXES].reshape(3, 3)
    return position, rotation, velocity, acceleration, row[WRENCH], axes, row[POSTURE]


class StretchTwin(NamedTuple):
    """Consecutive nodes of a preview within one phase: its rows (written into), displacement, heights of each."""

    rows: Array
    offset: Array | None
    heights: Sequence[Height]


def preview_twin(stretches: Sequence[StretchTwin]) -> tuple[Array, ...]:
    """Position, rotation, velocity, wrench, posture and axes of the nodes of a preview."""
    for rows, offset, heights in stretches:
        if offset is not None:
            rows[:, POSITION] += offset
        if heights:
            lifts = np.array(heights)
            rows[:, POSITION] += lifts[:, :1] * rows[:, NORMAL][:, :3]
            rows[:, VELOCITY] += lifts[:, :1] * rows[:, NORMAL_RATE] + lifts[:, 1:2] * rows[:, NORMAL]
    width = min(stretch.rows.shape[1] for stretch in stretches)
    table = np.concatenate([stretch.rows[:, :width] for stretch in stretches])
    matrices = [table[:, columns].reshape(-1, 3, 3) for columns in (ROTATION, AXES)]
    return table[:, POSITION], matrices[0], table[:, VELOCITY], table[:, WRENCH], table[:, POSTURE], matrices[1]
