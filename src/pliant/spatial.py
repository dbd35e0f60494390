"""Rotations and spatial vectors: the few formulas that several folders need.

Conventions: SI units and radians, the world's z axis points up, spatial vectors carry the linear part first. The error
of a pose is `target minus actual`, its rotational part `log(R_target R_actualᵀ)` in world axes.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from pliant.errors import ShapeError, SignalError

Array = npt.NDArray[np.float64]
"""An array of float64. Shapes are given where the array is declared."""

_SMALL_ANGLE = 1e-4  # rad; below it the series are exact to double precision


def as_vector(value: npt.ArrayLike, size: int, name: str) -> Array:
    """Checks and copies a vector.

    Args:
        value: a scalar (repeated) or a sequence.
        size: number of entries.
        name: what the value is called in an error.

    Returns:
        An array of shape (size,), read-only.

    Raises:
        ShapeError: the number of entries differs from `size`.
        SignalError: an entry is not finite.
    """
    array = np.array(value, dtype=np.float64)
    if array.ndim == 0:
        array = np.full(size, float(array))
    if array.shape != (size,):
        raise ShapeError(f"{name} must have {size} entries, got shape {array.shape}")
    if not np.all(np.isfinite(array)):
        raise SignalError(f"{name} must be finite, got {array.tolist()}")
    array.setflags(write=False)
    return array


def skew(w: npt.ArrayLike) -> Array:
    """The matrix S with S b = w × b. Args: w (3,). Returns: (3, 3)."""
    x, y, z = np.asarray(w, dtype=np.float64)
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def exp3(w: npt.ArrayLike) -> Array:
    """Rotation about `w` by its length (Rodrigues). Args: w (3,) rad. Returns: (3, 3)."""
    w = np.asarray(w, dtype=np.float64)
    angle = math.sqrt(float(w @ w))
    S = skew(w)
    if angle < _SMALL_ANGLE:
        return np.eye(3) + S + 0.5 * S @ S
    return np.eye(3) + math.sin(angle) / angle * S + (1.0 - math.cos(angle)) / angle**2 * S @ S


def log3(R: Array) -> Array:
    """Rotation vector of R, with length in [0, π], accurate also near π, where the axis comes from the symmetric part.

    Args:
        R: rotation matrix (3, 3).

    Returns:
        (3,) rad. At exactly π the sign of the axis is arbitrary; the one with a positive largest component is returned.
    """
    half_axis = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])  # sin(angle) · axis
    sine = math.sqrt(float(half_axis @ half_axis))
    cosine = 0.5 * (float(R[0, 0] + R[1, 1] + R[2, 2]) - 1.0)
    angle = math.atan2(sine, cosine)
    if cosine > -0.5:
        return half_axis if sine < _SMALL_ANGLE else half_axis * (angle / sine)
    # Near π the antisymmetric part vanishes: (R + Rᵀ)/2 = cos·I + (1 − cos)·a aᵀ still holds the axis a.
    outer = (0.5 * (R + R.T) - cosine * np.eye(3)) / (1.0 - cosine)
    column = int(np.argmax(np.diag(outer)))
    axis = outer[:, column] / math.sqrt(max(outer[column, column], 1e-300))
    axis = axis / np.linalg.norm(axis)
    return axis * (math.copysign(angle, float(axis @ half_axis)) if sine > 1e-12 else angle)


def left_jacobian_inverse(e: npt.ArrayLike) -> Array:
    """Inverse of the left Jacobian of SO(3): `d log = J_l⁻¹(e) ω` for a rotation `exp(e)` turning with ω in world axes.

    Args:
        e: rotation vector (3,), rad, shorter than 2π.

    Returns:
        (3, 3). Source: Chirikjian, Stochastic Models, Information Theory, and Lie Groups, vol. 2, eq. 10.86.
    """
    e = np.asarray(e, dtype=np.float64)
    angle2 = float(e @ e)
    angle = math.sqrt(angle2)
    if angle < _SMALL_ANGLE:
        gain = 1.0 / 12.0 + angle2 / 720.0
    else:
        gain = 1.0 / angle2 - (1.0 + math.cos(angle)) / (2.0 * angle * math.sin(angle))
    S = skew(e)
    return np.eye(3) - 0.5 * S + gain * S @ S


def rpy(roll: float, pitch: float, yaw: float) -> Array:
    """Rotation Rz(yaw) Ry(pitch) Rx(roll). Angles in rad. Returns: (3, 3)."""
    return exp3([0.0, 0.0, yaw]) @ exp3([0.0, pitch, 0.0]) @ exp3([roll, 0.0, 0.0])


def is_rotation(R: Array) -> bool:
    """Whether a matrix is a rotation (3, 3) but for rounding, 1e-6."""
    return R.shape == (3, 3) and bool(np.abs(R @ R.T - np.eye(3)).max() <= 1e-6 and np.linalg.det(R) > 0.0)


def frame_with_z_along(direction: npt.ArrayLike) -> Array:
    """A rotation whose third column is `direction`: R_world_surface of a surface with that normal.

    Args:
        direction: (3,), any length above zero.

    Returns:
        (3, 3). The other columns turn the world's x and y axes by the smallest rotation.

    Raises:
        SignalError: the direction has no length.
    """
    z = np.asarray(direction, dtype=np.float64)
    length = float(np.linalg.norm(z))
    if not length > 0.0 or not math.isfinite(length):
        raise SignalError(f"a direction needs a length above zero, got {z.tolist()}")
    z = z / length
    axis = np.cross([0.0, 0.0, 1.0], z)
    sine = float(np.linalg.norm(axis))
    if sine < 1e-12:
        return np.eye(3) if z[2] > 0.0 else np.diag([1.0, -1.0, -1.0])
    return exp3(axis / sine * math.atan2(sine, float(z[2])))


def cross(a: Array, b: Array) -> Array:
    """a × b of two vectors (3,); NumPy's own, which takes any shapes, is ten times slower."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def clamp(values: Array, lower: Array, upper: Array) -> Array:
    """Values within bounds, NaN where they are NaN; on a few numbers it costs half of NumPy's clip."""
    return np.minimum(np.maximum(values, lower), upper)


def symmetric(entries: npt.ArrayLike) -> Array:
    """Matrix (3, 3) from its entries xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = np.asarray(entries, dtype=np.float64)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def all_finite(*arrays: Any) -> bool:
    """Whether every entry of every array is finite."""
    return all(np.isfinite(array).all() for array in arrays)
