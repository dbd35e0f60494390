"""Trajectories: pure functions of time, and the ways to build one from another."""

from __future__ import annotations

import bisect
import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError, ShapeError, SignalError
from pliant.references.trajectories.time_scaling import EaseIn, Warp
from pliant.spatial import Array


class Point(NamedTuple):
    """A trajectory at one instant. Arrays may be shared and read-only: do not write into them."""

    value: Array
    """(k,) m for a position, N and N·m for a wrench, rad for a posture"""
    rate: Array
    """(k,) first time derivative"""
    acceleration: Array
    """(k,) second time derivative"""


class Trajectory(ABC):
    """A vector that moves with time. Time counts from the start of the trajectory; before it, the start is held."""

    size: int
    """k, number of entries"""
    duration: float
    """s until it comes to rest for good; infinite for a periodic one"""

    @abstractmethod
    def at(self, time: float) -> Point:
        """Value, rate and acceleration at a time in s."""

    def rows(self, times: Array) -> Point:
        """The same at many times (m,) s, as arrays (m, k). A row does not depend on the others."""
        points = [self.at(time) for time in times.tolist()]
        return Point(*(np.array(column).reshape(len(points), self.size) for column in zip(*points, strict=True)))

    def eased(self, seconds: float) -> Trajectory:
        """The same path, started from rest: its clock speeds up from standstill to full rate within `seconds`."""
        return Warped(self, EaseIn(seconds))

    def __add__(self, other: Trajectory) -> Trajectory:
        return Sum((self, other))


def vector(value: npt.ArrayLike, name: str, size: int | None = None) -> Array:
    """A finite, read-only copy of a vector, its length checked if `size` is given."""
    array = np.array(value, dtype=np.float64)
    if array.ndim != 1 or (size is not None and array.shape != (size,)):
        wanted = "a vector" if size is None else f"a vector of {size} entries"
        raise ShapeError(f"{name} must be {wanted}, got shape {array.shape}")
    if not np.isfinite(array).all():
        raise SignalError(f"{name} must be finite, got {array.tolist()}")
    array.setflags(write=False)
    return array


def positive(value: float, name: str, unit: str) -> float:
    """Checks that a number is finite and above zero."""
    if not (math.isfinite(value) and value > 0.0):
        raise ConfigError(f"{name} must be above zero [{unit}], got {value}")
    return float(value)


class Hold(Trajectory):
    """A constant value."""

    def __init__(self, value: npt.ArrayLike) -> None:
        constant = vector(value, "the held value")
        zero = vector(np.zeros(constant.shape[0]), "zero")
        self.size, self.duration = constant.shape[0], 0.0
        self._point = Point(constant, zero, zero)

    def at(self, time: float) -> Point:
        return self._point

    def rows(self, times: Array) -> Point:
        shape = (len(times), self.size)
        return Point(*(np.broadcast_to(part, shape) for part in self._point))


class Warped(Trajectory):
    """A trajectory with another time scaling: the path is the same, the timing changes."""

    def __init__(self, inner: Trajectory, warp: Warp) -> None:
        self.inner, self.warp = inner, warp
        self.size, self.duration = inner.size, warp.time_of(inner.duration)

    def at(self, time: float) -> Point:
        phase, rate, acceleration = self.warp.at(time)
        value, slope, bend = self.inner.at(phase)
        # chain rule for x(φ(t))
        return Point(value, slope * rate, bend * (rate * rate) + slope * acceleration)

    def rows(self, times: Array) -> Point:
        phase, rate, acceleration = self.warp.rows(times)
        value, slope, bend = self.inner.rows(phase)
        rate, acceleration = rate[:, None], acceleration[:, None]
        return Point(value, slope * rate, bend * (rate * rate) + slope * acceleration)


class Sum(Trajectory):
    """Adds trajectories of the same size: a circle on a line, a wrench ripple on a step."""

    def __init__(self, parts: Sequence[Trajectory]) -> None:
        sizes = {part.size for part in parts}
        if len(sizes) != 1:
            raise ShapeError(f"trajectories to be added must have one size, got sizes {sorted(sizes)}")
        self.parts = tuple(parts)
        self.size = sizes.pop()
        self.duration = max(part.duration for part in parts)

    def at(self, time: float) -> Point:
        points = [part.at(time) for part in self.parts]
        return Point(*(np.sum(column, axis=0) for column in zip(*points, strict=True)))

    def rows(self, times: Array) -> Point:
        tables = [part.rows(times) for part in self.parts]
        return Point(*(np.sum(column, axis=0) for column in zip(*tables, strict=True)))


class Blend(Trajectory):
    """Blends one trajectory into another within `seconds`, twice continuously differentiable.

    x(t) = a(t) + s (b(t) − a(t)) with the quintic step s, so that it starts as `first` and ends as `second`.
    """

    def __init__(self, first: Trajectory, second: Trajectory, seconds: float) -> None:
        if first.size != second.size:
            raise ShapeError(f"trajectories to be blended must have one size, got {first.size} and {second.size}")
        self.first, self.second = first, second
        self.seconds = positive(seconds, "the blending time", "s")
        self.size = first.size
        self.duration = max(seconds, second.duration)

    def at(self, time: float) -> Point:
        if time >= self.seconds:
            return self.second.at(time)
        a, b = self.first.at(time), self.second.at(time)
        s, s_dot, s_ddot = smooth_step(time, self.seconds)
        d = [y - x for x, y in zip(a, b, strict=True)]
        return Point(
            a.value + s * d[0],
            a.rate + s * d[1] + s_dot * d[0],
            a.acceleration + s * d[2] + 2.0 * s_dot * d[1] + s_ddot * d[0],
        )


class Chain(Trajectory):
    """Plays trajectories one after the other, each from its own time zero. The parts must meet: a jump is an error.

    Args:
        parts: trajectories of one size; all but the last need a finite duration.
        tolerance: largest jump in value that is accepted where two parts meet (m, rad or N); infinite allows steps.
    """

    def __init__(self, parts: Sequence[Trajectory], tolerance: float = 1e-6) -> None:
        self.parts = tuple(parts)
        sizes = {part.size for part in self.parts}
        if len(sizes) != 1:
            raise ShapeError(f"trajectories in a chain must have one size, got sizes {sorted(sizes)}")
        self.size = sizes.pop()
        self._starts = [0.0]
        for index, (part, after) in enumerate(zip(self.parts[:-1], self.parts[1:], strict=True)):
            if not math.isfinite(part.duration):
                raise ConfigError(f"part {index} of a chain never ends; only the last one may")
            gap = float(np.max(np.abs(after.at(0.0).value - part.at(part.duration).value)))
            if gap > tolerance:
                raise ConfigError(
                    f"parts {index} and {index + 1} of a chain do not meet: a jump of {gap:g} > {tolerance:g}"
                )
            self._starts.append(self._starts[-1] + part.duration)
        self.duration = self._starts[-1] + self.parts[-1].duration

    def at(self, time: float) -> Point:
        index = max(0, bisect.bisect_right(self._starts, time) - 1)
        return self.parts[index].at(time - self._starts[index])


def smooth_step(time: float, seconds: float) -> tuple[float, float, float]:
    """The quintic 10u³ − 15u⁴ + 6u⁵ of u = time/seconds, clamped to [0, 1], with its first two time derivatives."""
    u = time / seconds
    if u <= 0.0:
        return 0.0, 0.0, 0.0
    if u >= 1.0:
        return 1.0, 0.0, 0.0
    value = u * u * u * (10.0 - u * (15.0 - 6.0 * u))
    return value, 30.0 * (u * (1.0 - u)) ** 2 / seconds, 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / seconds**2


def smooth_steps(times: Array, seconds: Array) -> tuple[Array, Array, Array]:
    """`smooth_step` of many times (m,) s, each within its own `seconds` (m,)."""
    u = np.minimum(np.maximum(times / seconds, 0.0), 1.0)
    value = u * u * u * (10.0 - u * (15.0 - 6.0 * u))
    return value, 30.0 * (u * (1.0 - u)) ** 2 / seconds, 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / seconds**2
