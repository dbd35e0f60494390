"""Orientations as functions of time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pliant.errors import ConfigError
from pliant.references.trajectories.spline import Spline
from pliant.references.trajectories.time_scaling import Warp
from pliant.references.trajectories.trajectory import vector
from pliant.spatial import Array, cross, rotation_of_quaternion, unit_rows


class Orientation(NamedTuple):
    """An orientation at one instant. Arrays may be shared: do not write into them."""

    rotation: Array
    """R_world_frame (3, 3)"""
    velocity: Array
    """(3,) angular velocity, world axes, rad/s"""
    acceleration: Array
    """(3,) rad/s²"""


def third_axis(orientation: Orientation) -> tuple[Array, Array, Array]:
    """The third axis of a frame and its first two time derivatives, (3,) each."""
    R, spin, change = orientation
    n = R[:, 2]
    n_dot = cross(spin, n)
    return n, n_dot, cross(change, n) + cross(spin, n_dot)


class Turning(ABC):
    """A rotation that moves with time."""

    @abstractmethod
    def at(self, time: float) -> Orientation:
        """Rotation, angular velocity and angular acceleration at a time in s."""

    def rows(self, times: Array) -> Orientation:
        """The same at many times (m,) s: (m, 3, 3), (m, 3) and (m, 3). A row does not depend on the others."""
        found = [self.at(time) for time in times.tolist()]
        shapes = ((len(found), 3, 3), (len(found), 3), (len(found), 3))
        columns = zip(shapes, zip(*found, strict=True), strict=True)
        return Orientation(*(np.array(column).reshape(shape) for shape, column in columns))


class Fixed(Turning):
    """A constant orientation. Args: rotation: R_world_frame (3, 3)."""

    def __init__(self, rotation: Array) -> None:
        R = np.array(rotation, dtype=np.float64)
        if R.shape != (3, 3) or not np.allclose(R @ R.T, np.eye(3), atol=1e-6) or np.linalg.det(R) < 0.0:
            raise ConfigError(f"a rotation must be a proper orthogonal (3, 3) matrix, got {R.tolist()}")
        R.setflags(write=False)
        zero = vector(np.zeros(3), "zero")
        self._orientation = Orientation(R, zero, zero)

    def at(self, time: float) -> Orientation:
        return self._orientation

    def rows(self, times: Array) -> Orientation:
        return Orientation(*(np.broadcast_to(part, (len(times), *part.shape)) for part in self._orientation))


class WarpedTurning(Turning):
    """A rotation over time with another time scaling."""

    def __init__(self, inner: Turning, warp: Warp) -> None:
        self.inner, self.warp = inner, warp

    def at(self, time: float) -> Orientation:
        phase, rate, acceleration = self.warp.at(time)
        R, w, a = self.inner.at(phase)
        return Orientation(R, w * rate, a * (rate * rate) + w * acceleration)

    def rows(self, times: Array) -> Orientation:
        phase, rate, acceleration = self.warp.rows(times)
        R, w, a = self.inner.rows(phase)
        rate, acceleration = rate[:, None], acceleration[:, None]
        return Orientation(R, w * rate, a * (rate * rate) + w * acceleration)


class QuaternionSpline(Turning):
    """Cubic spline through quaternions, brought to unit length at every instant.

    Args:
        times: (m,) s, increasing.
        quaternions: (m, 4), scalar first, any length above zero and either sign.
        rests: whether it begins and ends at rest.
    """

    def __init__(self, times: Array, quaternions: Array, rests: bool = False) -> None:
        unit = unit_rows(quaternions)
        turns = np.concatenate([[1.0], np.where(np.sum(unit[1:] * unit[:-1], axis=1) < 0.0, -1.0, 1.0)])
        # q and −q are one rotation: take the sign that keeps the path short
        self._spline = Spline(times, unit * np.cumprod(turns)[:, None], rests)

    def at(self, time: float) -> Orientation:
        q, q_dot, q_ddot = self._spline.at(time)
        w, x, y, z = q.tolist()
        scale = 1.0 / (w * w + x * x + y * y + z * z)
        inverse = (w * scale, -x * scale, -y * scale, -z * scale)
        spin = _product(q_dot.tolist(), inverse)  # scalar: change of length; vector: half the angular velocity
        change = _product(q_ddot.tolist(), inverse)
        squared = _product(spin, spin)
        acceleration = np.array([2.0 * (a - b) for a, b in zip(change[1:], squared[1:], strict=True)])
        return Orientation(rotation_of_quaternion(q), 2.0 * np.array(spin[1:]), acceleration)


def _product(a: Sequence[float], b: Sequence[float]) -> tuple[float, float, float, float]:
    """Hamilton product of quaternions, scalar first."""
    (p, x, y, z), (q, u, v, w) = a, b
    return (
        p * q - x * u - y * v - z * w,
        p * u + q * x + y * w - z * v,
        p * v + q * y + z * u - x * w,
        p * w + q * z + x * v - y * u,
    )
