"""Timing of a path: from rest to rest at its speed, slower in bends, within a limit of acceleration."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pliant.spatial import Array

_STILL = 1e-12  # m/s
_SHARP = 0.3  # rad between two steps: a reversal or a corner, at which the tool must stop


class PathPace(NamedTuple):
    """Times and speeds at the points of a path."""

    times: Array
    """(k,) s, from zero"""
    way: Array
    """(k,) m, to each point"""
    speeds: Array
    """(k,) m/s at each point"""

    def way_at(self, times: Array) -> Array:
        """(m,) m, path length at times in s: from point to point the acceleration is constant; between two stops it
        accelerates over the first half and decelerates over the second."""
        i = np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, len(self.times) - 2)
        span, length = self.times[i + 1] - self.times[i], self.way[i + 1] - self.way[i]
        u = np.clip((times - self.times[i]) / span, 0.0, 1.0)
        still = self.speeds[i] + self.speeds[i + 1] < _STILL
        stop_to_stop = length * np.where(u < 0.5, 2.0 * u * u, 1.0 - 2.0 * (1.0 - u) ** 2)
        from_speed = span * u * (self.speeds[i] + 0.5 * u * (self.speeds[i + 1] - self.speeds[i]))
        return self.way[i] + np.where(still, stop_to_stop, from_speed)


def pace(points: Array, speed: Array | float, acceleration: float) -> PathPace:
    """When the points of a path are passed, from rest to rest.

    Along the path the speed changes by at most `acceleration`, and in bends v² κ stays below it, so the whole
    acceleration stays below √2 times the limit.

    Args:
        points: (k, 3) m, in small steps, none twice.
        speed: m/s, one or one per point.
        acceleration: m/s².

    """
    steps = np.diff(points, axis=0)
    ds = np.linalg.norm(steps, axis=1)
    limit = np.minimum(
        np.broadcast_to(np.asarray(speed, dtype=np.float64), (len(points),)), _in_bends(steps, ds, acceleration)
    )
    square = (limit * limit).tolist()
    square[0] = square[-1] = 0.0
    gain = (2.0 * acceleration * ds).tolist()
    for i in range(1, len(square)):
        square[i] = min(square[i], square[i - 1] + gain[i - 1])
    for i in range(len(square) - 2, -1, -1):
        square[i] = min(square[i], square[i + 1] + gain[i])
    v = np.sqrt(square)
    # constant acceleration over each step; between two standstills up to the middle and down again
    mean = 0.5 * (v[1:] + v[:-1])
    still = mean < _STILL
    dt = np.where(still, 2.0 * np.sqrt(ds / acceleration), ds / np.where(still, 1.0, mean))
    return PathPace(_sums(dt), _sums(ds), v)


def _sums(parts: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum(parts)])


def _in_bends(steps: Array, ds: Array, acceleration: float) -> Array:
    """(k,) m/s: the speed whose centripetal acceleration is the limit."""
    ways = steps / ds[:, None]
    turn = np.linalg.norm(np.diff(ways, axis=0), axis=1)
    curvature = turn / (0.5 * (ds[1:] + ds[:-1]))
    allowed = np.sqrt(acceleration / np.maximum(curvature, 1e-9))
    allowed[turn > _SHARP] = 0.0
    allowed = np.concatenate([[math.inf], allowed, [math.inf]])
    # a bend also limits the neighbouring points
    return np.minimum(allowed, np.minimum(np.append(allowed[1:], math.inf), np.insert(allowed[:-1], 0, math.inf)))
