"""A part of a longer trajectory or rotation, with its own time."""

from __future__ import annotations

import numpy as np

from pliant.references.trajectories.rotation import Orientation, Turning
from pliant.references.trajectories.trajectory import Point, Trajectory
from pliant.spatial import Array


class Excerpt(Trajectory):
    """The part of a trajectory between two times; held before and after.

    Args:
        inner: the whole.
        start, end: s of its clock.
    """

    def __init__(self, inner: Trajectory, start: float, end: float) -> None:
        self._inner, self._start = inner, start
        self.size, self.duration = inner.size, end - start

    def at(self, time: float) -> Point:
        if 0.0 <= time <= self.duration:
            return self._inner.at(self._start + time)
        held = self._inner.at(self._start + min(max(time, 0.0), self.duration)).value
        return Point(held, np.zeros(self.size), np.zeros(self.size))

    def rows(self, times: Array) -> Point:
        value, rate, bend = self._inner.rows(self._start + np.minimum(np.maximum(times, 0.0), self.duration))
        within = ((times >= 0.0) & (times <= self.duration))[:, None]
        return Point(value, np.where(within, rate, 0.0), np.where(within, bend, 0.0))


class TurningExcerpt(Turning):
    """The same for orientations. Args: as `Excerpt`."""

    def __init__(self, inner: Turning, start: float, end: float) -> None:
        self._inner, self._start, self._duration = inner, start, end - start

    def at(self, time: float) -> Orientation:
        if 0.0 <= time <= self._duration:
            return self._inner.at(self._start + time)
        held = self._inner.at(self._start + min(max(time, 0.0), self._duration)).rotation
        return Orientation(held, np.zeros(3), np.zeros(3))

    def rows(self, times: Array) -> Orientation:
        R, spin, change = self._inner.rows(self._start + np.minimum(np.maximum(times, 0.0), self._duration))
        within = ((times >= 0.0) & (times <= self._duration))[:, None]
        return Orientation(R, np.where(within, spin, 0.0), np.where(within, change, 0.0))
