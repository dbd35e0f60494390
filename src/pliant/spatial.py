"""Rotations and spatial vectors: the few formulas that several folders need.

Conventions: SI units and radians, the world's z axis points up, spatial vectors carry the linear part first. The error
of a pose is `target minus actual`, its rotational part `log(R_target R_actualᵀ)` in world axes. The functions use
pinocchio where it has them: against arithmetic with more digits its exp and log are off by at most 4e-14 from angle 0
to π.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant.errors import ConfigError, ShapeError, SignalError

Array = npt.NDArray[np.float64]
"""An array of float64. Shapes are given where the array is declared."""


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
    return pin.skew(np.asarray(w, dtype=np.float64))


def exp3(w: npt.ArrayLike) -> Array:
    """Rotation about `w` by its length (Rodrigues). Args: w (3,) rad. Returns: (3, 3)."""
    return pin.exp3(np.asarray(w, dtype=np.float64))


def log3(R: Array) -> Array:
    """Rotation vector of R, with length in [0, π], accurate also near π.

    Args:
        R: rotation matrix (3, 3).

    Returns:
        (3,) rad. At exactly π the sign of the axis is arbitrary.
    """
    return pin.log3(R)


def rpy(roll: float, pitch: float, yaw: float) -> Array:
    """Rotation Rz(yaw) Ry(pitch) Rx(roll). Angles in rad. Returns: (3, 3)."""
    return pin.rpy.rpyToMatrix(roll, pitch, yaw)


def quaternion(R: Array) -> Array:
    """Unit quaternion (w, x, y, z) of a rotation matrix (3, 3). Its sign is arbitrary."""
    return quaternions(R)[0]


def quaternions(rotations: Array) -> Array:
    """Unit quaternions of rotation matrices, bit for bit as Eigen makes them (Shepperd's method).

    Not pinocchio's own class: each of its quaternions that is made of a matrix loses 80 bytes of memory for good.

    Args:
        rotations: (n, 3, 3).

    Returns:
        (n, 4) as (w, x, y, z), of arbitrary sign; NaN where a matrix has entries that are not finite.
    """
    R = np.asarray(rotations, dtype=np.float64).reshape(-1, 3, 3)
    rows, diagonal = np.arange(len(R)), np.diagonal(R, axis1=1, axis2=2)
    i = np.argmax(diagonal, axis=1)
    with np.errstate(invalid="ignore"):
        trace = diagonal[:, 0] + (diagonal[:, 1] + diagonal[:, 2])
        rest = diagonal[rows, i] - diagonal[rows, (i + 1) % 3] - diagonal[rows, (i + 2) % 3]
        by_w = trace > 0.0  # w is far from 0; else the i-th entry of the vector is
        root = np.sqrt(np.where(by_w, trace, rest) + 1.0)
        turn = np.stack((R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]), axis=1)
        vector = np.where(by_w[:, None], turn, R[rows, :, i] + R[rows, i, :]) * (0.5 / root)[:, None]
        vector[rows[~by_w], i[~by_w]] = 0.5 * root[~by_w]
        w = np.where(by_w, 0.5 * root, turn[rows, i] * (0.5 / root))
    return np.column_stack((w, vector))


def rotation_of_quaternion(q: npt.ArrayLike) -> Array:
    """Rotation matrix (3, 3) of a quaternion (w, x, y, z) of any length above zero."""
    w, x, y, z = (float(entry) for entry in np.asarray(q))
    return pin.Quaternion(w, x, y, z).normalized().toRotationMatrix()


def is_rotation(R: Array) -> bool:
    """Whether a matrix is a rotation (3, 3) but for rounding, 1e-6."""
    return R.shape == (3, 3) and bool(np.abs(R @ R.T - np.eye(3)).max() <= 1e-6 and np.linalg.det(R) > 0.0)


def unit(direction: npt.ArrayLike, name: str) -> Array:
    """A direction (3,) brought to length one. Raises ConfigError, which calls it `name`, if it has no length."""
    array = np.asarray(direction, dtype=np.float64)
    length = float(np.linalg.norm(array))
    if not length > 0.0 or not math.isfinite(length):
        raise ConfigError(f"{name} needs a length above zero, got {array.tolist()}")
    return array / length


def unit_rows(vectors: Array) -> Array:
    """(k, m) vectors, each scaled to length one."""
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def frame_with_z_along(direction: npt.ArrayLike) -> Array:
    """A rotation whose third column is `direction`: R_world_surface of a surface with that normal.

    Args:
        direction: (3,), any length above zero.

    Returns:
        (3, 3). The other columns turn the world's x and y axes by the smallest rotation.

    Raises:
        ConfigError: the direction has no length.
    """
    z = unit(direction, "a direction")
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
