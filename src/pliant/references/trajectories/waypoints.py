"""Steps, ramps and smooth moves through a list of values: wrenches over time, point-to-point motion."""

from __future__ import annotations

import bisect
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError, ShapeError
from pliant.references.trajectories.trajectory import Point, Trajectory, smooth_step, smooth_steps, vector
from pliant.spatial import Array, unit

SHAPES = ("step", "ramp", "smooth")


class Waypoints(Trajectory):
    """Passes through values at given times.

    Args:
        times: (m,) s, increasing; before the first the first value is held, after the last the last one.
        values: (m, k).
        shape: "step" jumps at each time, "ramp" goes straight (rate jumps), "smooth" comes to rest at every value along
            a quintic step (twice continuously differentiable).

    Raises:
        ConfigError: times that do not increase, or an unknown shape.
        ShapeError: another number of values than of times.
    """

    def __init__(self, times: npt.ArrayLike, values: npt.ArrayLike, shape: str = "smooth") -> None:
        if shape not in SHAPES:
            raise ConfigError(f"waypoints have no shape {shape!r}; valid: {', '.join(SHAPES)}")
        instants, table = vector(times, "the times of waypoints"), np.array(values, dtype=np.float64)
        if table.ndim != 2 or table.shape[0] != instants.shape[0] or instants.shape[0] == 0:
            raise ShapeError(
                f"waypoints need one row of values per time, got {instants.shape[0]} times and shape {table.shape}"
            )
        if np.any(np.diff(instants) <= 0.0):
            raise ConfigError(f"the times of waypoints must increase, got {instants.tolist()}")
        if not np.isfinite(table).all():
            raise ConfigError("the values of waypoints must be finite")
        self._times: list[float] = instants.tolist()
        self._values: Sequence[Array] = [vector(row, "a waypoint") for row in table]
        self._zero = vector(np.zeros(table.shape[1]), "zero")
        self._shape = shape
        self._starts, self._table = instants, table
        self._ways = np.diff(table, axis=0, append=table[-1:])
        self._seconds = np.append(np.diff(instants), 1.0)
        self.size, self.duration = int(table.shape[1]), float(instants[-1])

    def at(self, time: float) -> Point:
        index = bisect.bisect_right(self._times, time) - 1
        if index < 0:
            return Point(self._values[0], self._zero, self._zero)
        if self._shape == "step" or index + 1 == len(self._times):
            return Point(self._values[index], self._zero, self._zero)
        start, seconds = self._times[index], self._times[index + 1] - self._times[index]
        way = self._values[index + 1] - self._values[index]
        if self._shape == "ramp":
            return Point(self._values[index] + way * ((time - start) / seconds), way / seconds, self._zero)
        s, s_dot, s_ddot = smooth_step(time - start, seconds)
        return Point(self._values[index] + s * way, s_dot * way, s_ddot * way)

    def rows(self, times: Array) -> Point:
        first, last = float(times.min(initial=np.inf)), float(times.max(initial=-np.inf))
        shape = (len(times), self.size)
        still = np.broadcast_to(self._zero, shape)
        if first >= self._times[-1] or last < self._times[0]:
            held = self._values[-1 if first >= self._times[-1] else 0]
            return Point(np.broadcast_to(held, shape), still, still)
        pieces = np.searchsorted(self._starts, times, side="right") - 1
        index = np.maximum(pieces, 0)
        value = self._table[index]
        if self._shape == "step":
            return Point(value, still, still)
        # no way to go before the first one and after the last
        way = np.where((pieces < 0)[:, None], 0.0, self._ways[index])
        since, seconds = times - self._starts[index], self._seconds[index]
        if self._shape == "ramp":
            return Point(value + way * (since / seconds)[:, None], way / seconds[:, None], still)
        s, s_dot, s_ddot = (part[:, None] for part in smooth_steps(since, seconds))
        return Point(value + s * way, s_dot * way, s_ddot * way)


def wrench_steps(
    times: npt.ArrayLike, forces: npt.ArrayLike, axis: npt.ArrayLike = (0.0, 0.0, 1.0), shape: str = "step"
) -> Waypoints:
    """A desired reaction along one direction that changes at given times.

    Args:
        times: (m,) s.
        forces: (m,) N, positive where the environment pushes the robot along `axis`.
        axis: (3,) direction.
        shape: as in `Waypoints`.

    Returns:
        A trajectory of wrenches (6,), moments zero.
    """
    direction = unit(vector(axis, "the axis of a wrench", 3), "the axis of a wrench")
    rows = np.outer(vector(forces, "the forces"), np.concatenate([direction, np.zeros(3)]))
    return Waypoints(times, rows, shape)
