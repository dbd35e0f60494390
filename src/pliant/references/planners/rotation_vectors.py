"""Rotation vectors of a planned turn."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from pliant.spatial import Array, skew


def left_jacobian(r: npt.ArrayLike) -> Array:
    """J_l(r) (3, 3), with ω = J_l(r) ṙ. Source: Chirikjian, Stochastic Models, vol. 2, eq. 10.86."""
    angle = float(np.linalg.norm(r))
    cross = skew(r)
    if angle < 1e-4:
        return np.eye(3) + 0.5 * cross + cross @ cross / 6.0
    first, second = (1.0 - np.cos(angle)) / angle**2, (angle - np.sin(angle)) / angle**3
    return np.eye(3) + first * cross + second * cross @ cross


def nearest(turn: Array, last: tuple[float, ...]) -> tuple[float, ...]:
    """Of the rotation vectors of one rotation, r and r − 2π r/|r|, the one nearer to the last target."""
    angle = float(np.linalg.norm(turn))
    if angle < 1e-9:
        return tuple(turn.tolist())
    other = turn * (1.0 - 2.0 * np.pi / angle)
    return tuple((turn if np.linalg.norm(turn - last) <= np.linalg.norm(other - last) else other).tolist())
