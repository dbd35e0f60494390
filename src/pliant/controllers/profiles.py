"""Force profiles of the fractal impedance controller: how force and stored energy grow with the error."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from pliant.signals import ImpedanceTuning
from pliant.spatial import Array

STEEPNESS = 20.0
"""S of the exponential profile: how many characteristic lengths lie between x_0 and x_b ([Stack] sec. II-C)"""
LINEAR_SHARE = 0.95
"""share of x_b, and of F_max, at which the linear part ends by default ([HapFIC] sec. II-C)"""

_LN2 = float(np.log(2.0))


class Shape(StrEnum):
    """How a profile bends from its linear part to F_max."""

    EXPONENTIAL = "exponential"
    """[Stack] Tiseo et al. 2020, eq. 3, with the factor ΔF and the signs that the print lacks"""
    TANH = "tanh"
    """[HapFIC] Tiseo et al. 2021, eq. 4, shifted so that it is continuous at x_0"""


@dataclass(frozen=True)
class ForceProfile:
    """Force and energy of `k` axes as functions of their error. Odd, continuous, monotone, bounded by F_max."""

    shape: Shape
    stiffness: Array
    """K_0 (k,), N/m or N·m/rad"""
    force_max: Array
    """F_max (k,), N or N·m"""
    range: Array
    """x_b (k,), m or rad"""
    linear_range: Array
    """x_0 (k,), m or rad"""

    @staticmethod
    def of(tuning: ImpedanceTuning, shape: Shape = Shape.EXPONENTIAL) -> ForceProfile:
        """The profile of a tuning; derives x_0 where the tuning does not give it."""
        return ForceProfile(shape, tuning.stiffness, tuning.force_max, tuning.range, linear_range(tuning))

    @property
    def knee_force(self) -> Array:
        """F_0 = K_0 x_0 (k,), N or N·m."""
        return self.stiffness * self.linear_range

    @property
    def length(self) -> Array:
        """Characteristic length of the bend (k,), m or rad: b of [Stack], w of the tanh profile."""
        bend = self.range - self.linear_range
        divisor = STEEPNESS if self.shape is Shape.EXPONENTIAL else 2.0 * np.pi
        return np.where(bend > 0.0, bend / divisor, 1.0)

    def force(self, error: npt.ArrayLike) -> Array:
        """F(x̃). Args: error (..., k) m or rad. Returns: (..., k) N or N·m."""
        error = np.asarray(error, dtype=np.float64)
        return np.copysign(self.magnitude(np.abs(error)), error)

    def magnitude(self, distance: Array) -> Array:
        """|F| at a distance ≥ 0. Args: distance (..., k) m or rad. Returns: (..., k) N or N·m."""
        beyond = np.maximum(distance - self.linear_range, 0.0)
        rise = np.maximum(self.force_max - self.knee_force, 0.0)
        if self.shape is Shape.EXPONENTIAL:
            bent = self.knee_force - rise * np.expm1(-beyond / self.length)
        else:
            z = (distance - self.range) / self.length + np.pi
            bent = self.knee_force + rise * (np.tanh(z) + np.tanh(np.pi)) / (1.0 + np.tanh(np.pi))
        straight = np.minimum(self.stiffness * distance, self.force_max)
        return np.where(distance <= self.linear_range, straight, bent)

    def energy(self, error: npt.ArrayLike) -> Array:
        """E(x̃) = ∫F dx̃, the energy stored in each axis. Args: error (..., k) m or rad. Returns: (..., k) J."""
        distance = np.abs(np.asarray(error, dtype=np.float64))
        beyond = np.maximum(distance - self.linear_range, 0.0)
        rise = np.maximum(self.force_max - self.knee_force, 0.0)
        linear = 0.5 * self.stiffness * np.minimum(distance, self.linear_range) ** 2
        if self.shape is Shape.EXPONENTIAL:
            bent = (self.knee_force + rise) * beyond + self.length * rise * np.expm1(-beyond / self.length)
            return linear + bent
        z = np.maximum((distance - self.range) / self.length, -2.0 * np.pi) + np.pi
        tanh_pi = np.tanh(np.pi)
        bent = self.length * (_log_cosh(z) - _log_cosh(np.asarray(np.pi))) + tanh_pi * beyond
        return linear + self.knee_force * beyond + rise / (1.0 + tanh_pi) * np.where(beyond > 0.0, bent, 0.0)


def linear_range(tuning: ImpedanceTuning) -> Array:
    """x_0 (k,) of a tuning, m or rad: its own, or min(0.95 x_b, 0.95 F_max/K_0)."""
    if tuning.linear_range is not None:
        return tuning.linear_range
    reach = np.divide(tuning.force_max, tuning.stiffness, out=np.zeros_like(tuning.range), where=tuning.stiffness > 0.0)
    return LINEAR_SHARE * np.minimum(tuning.range, reach)


def _log_cosh(z: Array) -> Array:
    size = np.abs(z)  # the naive form overflows at 710
    return size + np.log1p(np.exp(-2.0 * size)) - _LN2
