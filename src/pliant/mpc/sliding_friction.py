"""Coulomb friction of the predicted contact: the rate of the tangential force state, with derivatives.

A bristle after Dahl, "A solid friction model" (Aerospace Corporation TOR-0158(3107-18)-1, 1968), with a damper; the
discrete map is derived in docs/mpc_derivation.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pliant.spatial import Array

SLOW_SLIDING = 1e-3  # m/s: below it the bristle hardly gives way, which keeps the law smooth at rest
LIGHT_TOUCH = 1.0  # N: the smooth normal force where the normal force is zero


@dataclass(frozen=True)
class SlidingRate:
    """Rate of the tangential force over one step, and its derivatives."""

    rate: Array
    """(2,) N/s, (λ⁺ − λ)/dt"""
    by_sticking: Array
    """(2, 2) derivative with respect to the rate of a sticking contact"""
    by_force: Array
    """(2, 3) 1/s, derivative with respect to the force at the start of the step"""


def sliding_rate(sticking_rate: Array, force: Array, stiffness: Array, friction: float, dt: float) -> SlidingRate:
    """λ̇ = −K (y + c λ) with K y = −sticking_rate and c = s(y)/(μ n(λ_z)), implicit in λ.

    Args:
        sticking_rate: (2,) N/s, tangential force rate of the visco-elastic contact, −K ẋ − B ẍ.
        force: (3,) N at the start of the step, the normal component last.
        stiffness: (2,) N/m.
        friction: μ, above zero.
        dt: s.
    """
    y = -sticking_rate / stiffness
    square = float(y @ y)
    rounded = square + SLOW_SLIDING**2
    speed, slope = square / math.sqrt(rounded), (rounded + SLOW_SLIDING**2) / rounded**1.5  # ∂s/∂y = slope y
    limit, limit_normal = _limit(float(force[2]), friction)
    yielding = speed / limit
    implicit = 1.0 / (1.0 + dt * stiffness * yielding)
    rate = (sticking_rate - stiffness * yielding * force[:2]) * implicit
    by_yielding = -stiffness * implicit * (force[:2] + dt * rate)
    by_sticking = np.diag(implicit) - by_yielding[:, None] * (slope * y / (limit * stiffness))
    by_normal = -by_yielding * yielding * limit_normal / limit
    return SlidingRate(rate, by_sticking, np.column_stack([np.diag(-stiffness * yielding * implicit), by_normal]))


def _limit(normal: float, friction: float) -> tuple[float, float]:
    """μ n N with n = (λ_z + √(λ_z² + 4 light²))/2, written without cancellation, and its derivative over λ_z."""
    root = math.hypot(normal, 2.0 * LIGHT_TOUCH)
    pressing = 0.5 * (normal + root) if normal > 0.0 else 2.0 * LIGHT_TOUCH**2 / (root - normal)
    return friction * pressing, friction * pressing / root
