"""Rows of a function of time, worked out once for each tick of a clock, many ticks in one go."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pliant.interfaces import CLOCK_ROUNDING
from pliant.spatial import Array

_CHUNK = 32  # rows
_FAR = 512  # rows ahead; instants farther apart are worked out one by one


class RowsAhead:
    """A cache: what it gives depends on the time asked for, not on what was asked before.

    Args:
        rows: times (m,) s, zero or more, to rows (m, w); each row depends on its own time only.
    """

    def __init__(self, rows: Callable[[Array], Array]) -> None:
        self._rows = rows
        self._origin = self._period = 0.0
        self._first = self._now = 0
        self._table = np.zeros((0, 0))

    def row(self, time: float, period: float) -> Array:
        """Row (w,) at a time in s, now. Read-only.

        Args:
            time: s.
            period: s from one tick of the clock to the next; 0: it is not regular.
        """
        index = self._index(time)
        if index is None or not self._now <= index <= self._now + _FAR:
            if period <= 0.0:
                return self._rows(_clean(np.array([time])))[0]
            self._origin, self._period, self._first, self._now = time, period, 0, 0
            self._table, index = np.zeros((0, 0)), 0
        self._reach(index)
        self._now = index
        return self._table[index - self._first]

    def rows(self, times: Array) -> Array:
        """Rows (m, w) at equally spaced times (m,) s from now on, m ≥ 1; a copy."""
        first, last, gaps = self._index(float(times[0])), self._index(float(times[-1])), max(len(times) - 1, 1)
        if first is None or last is None or first < self._now or last > self._now + _FAR or (last - first) % gaps:
            return self._rows(_clean(times))
        self._reach(last)
        begin, end = first - self._first, last - self._first
        return self._table[begin : end + 1 : max((last - first) // gaps, 1)].copy()

    def _index(self, time: float) -> int | None:
        """Number of the tick at a time in s, from the first on; None: there is none."""
        if self._period == 0.0:
            return None
        steps = (time - self._origin) / self._period
        index = round(steps)
        return index if abs(steps - index) * self._period < CLOCK_ROUNDING else None

    def _reach(self, last: int) -> None:
        have = self._first + len(self._table)
        if last < have:
            return
        ticks = np.arange(have, max(last + 1, have + _CHUNK), dtype=np.float64)
        more = self._rows(_clean(self._origin + self._period * ticks))
        kept = self._table[self._now - self._first :]
        self._table = np.concatenate([kept, more]) if len(kept) else more
        self._table.setflags(write=False)
        self._first = have + len(ticks) - len(self._table)


def _clean(times: Array) -> Array:
    """Times without the rounding of a clock, so that an instant is the same in two ticks."""
    return np.rint(1e9 * np.maximum(times, 0.0)) / 1e9  # ns
