"""Force profiles of the fractal impedance controller: how force and stored energy grow with the error."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError
from pliant.signals import ImpedanceTuning
from pliant.spatial import Array

STEEPNESS = 20.0
"""S of the exponential profile: how many characteristic lengths lie between x_0 and x_b ([Stack] sec. II-C)"""
LINEAR_SHARE = 0.95
"""share of x_b, and of F_max, at which the linear part ends by default ([HapFIC] sec. II-C)"""

PRINTED_RISE = 1.0
"""N or N·m: what stands for ΔF in the print of [Stack] eq. 3"""
PRINTED_S = 0.1353
"""S of [HapFIC] eq. 4: share of x_b that is the length of its tanh"""

_BENT_BY_EXP = ("exponential", "exponential-printed")
_LN2 = float(np.log(2.0))


class Shape(StrEnum):
    """How a profile bends from its linear part to F_max."""

    EXPONENTIAL = "exponential"
    """[Stack] Tiseo et al. 2020, eq. 3, with the factor ΔF and the signs that the print lacks"""
    TANH = "tanh"
    """[HapFIC] Tiseo et al. 2021, eq. 4, shifted so that it is continuous at x_0"""
    EXPONENTIAL_PRINTED = "exponential-printed"
    """[Stack] eq. 3 as printed, without the factor ΔF: beyond x_0 the force rises by 1 N (or N·m), at most to F_max,
    and at x_b it jumps to F_max"""
    TANH_PRINTED = "tanh-printed"
    """[HapFIC] eq. 4 as printed, with S = 0.1353: at 0.95 x_b, where the linear part ends whatever x_0 is, the force
    jumps by more than 0.99 ΔF"""


@dataclass(frozen=True)
class ForceProfile:
    """Force and energy of `k` axes as functions of their error. Odd, monotone, bounded by F_max; continuous, but for
    the printed shapes."""

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
        """The profile of a tuning; derives x_0 where the tuning leaves it open.

        Raises ConfigError: a linear part that passes F_max, where the shape says how far it goes.
        """
        knee = LINEAR_SHARE * tuning.range if shape is Shape.TANH_PRINTED else linear_range(tuning)
        passed = np.flatnonzero(tuning.stiffness * knee > tuning.force_max * (1.0 + 1e-12))
        if len(passed):
            i = int(passed[0])
            raise ConfigError(
                f"axis {i}: profile {shape.value!r} is linear up to 0.95 x_b: F_max must be at least 0.95 K_0 x_b ="
                f" {tuning.stiffness[i] * knee[i]:g}, got {tuning.force_max[i]:g}"
            )
        return ForceProfile(shape, tuning.stiffness, tuning.force_max, tuning.range, knee)

    @property
    def knee_force(self) -> Array:
        """F_0 = K_0 x_0 (k,), N or N·m."""
        return self.stiffness * self.linear_range

    @property
    def length(self) -> Array:
        """Characteristic length of the bend (k,), m or rad: b of [Stack], w of the tanh profile."""
        bend = self.range - self.linear_range
        if self.shape is Shape.TANH_PRINTED:
            return np.where(bend > 0.0, PRINTED_S * self.range, 1.0)
        divisor = STEEPNESS if self.shape in _BENT_BY_EXP else 2.0 * np.pi
        return np.where(bend > 0.0, bend / divisor, 1.0)

    @property
    def rise(self) -> Array:
        """ΔF = F_max − F_0 (k,), N or N·m; of the printed exponential what stands in its place."""
        rise = np.maximum(self.force_max - self.knee_force, 0.0)
        return np.minimum(rise, PRINTED_RISE) if self.shape is Shape.EXPONENTIAL_PRINTED else rise

    def force(self, error: npt.ArrayLike) -> Array:
        """F(x̃). Args: error (..., k) m or rad. Returns: (..., k) N or N·m."""
        error = np.asarray(error, dtype=np.float64)
        return np.copysign(self.magnitude(np.abs(error)), error)

    def magnitude(self, distance: Array) -> Array:
        """|F| at a distance ≥ 0. Args: distance (..., k) m or rad. Returns: (..., k) N or N·m."""
        beyond = np.maximum(distance - self.linear_range, 0.0)
        z = (distance - self.range) / self.length + np.pi
        match self.shape:
            case Shape.EXPONENTIAL | Shape.EXPONENTIAL_PRINTED:
                bent = self.knee_force - self.rise * np.expm1(-beyond / self.length)
                if self.shape is Shape.EXPONENTIAL_PRINTED:
                    bent = np.where(distance >= self.range, self.force_max, bent)
            case Shape.TANH:
                bent = self.knee_force + self.rise * (np.tanh(z) + np.tanh(np.pi)) / (1.0 + np.tanh(np.pi))
            case Shape.TANH_PRINTED:
                bent = self.knee_force + 0.5 * self.rise * (np.tanh(z) + 1.0)
        straight = np.minimum(self.stiffness * distance, self.force_max)
        return np.where(distance <= self.linear_range, straight, bent)

    def energy(self, error: npt.ArrayLike) -> Array:
        """E(x̃) = ∫F dx̃, the energy stored in each axis. Args: error (..., k) m or rad. Returns: (..., k) J."""
        distance = np.abs(np.asarray(error, dtype=np.float64))
        linear = 0.5 * self.stiffness * np.minimum(distance, self.linear_range) ** 2
        beyond = np.maximum(distance - self.linear_range, 0.0)
        match self.shape:
            case Shape.EXPONENTIAL:
                return linear + self._bent_by_exp(beyond)
            case Shape.EXPONENTIAL_PRINTED:
                within = np.minimum(beyond, self.range - self.linear_range)
                return linear + self._bent_by_exp(within) + self.force_max * (beyond - within)
            case Shape.TANH:
                tanh_pi = np.tanh(np.pi)
                return linear + self._bent_by_tanh(distance, beyond, -np.pi, tanh_pi, 1.0 / (1.0 + tanh_pi))
            case Shape.TANH_PRINTED:
                first = (self.linear_range - self.range) / self.length + np.pi
                return linear + self._bent_by_tanh(distance, beyond, first, 1.0, 0.5)

    def _bent_by_exp(self, beyond: Array) -> Array:
        rise = self.rise
        return (self.knee_force + rise) * beyond + self.length * rise * np.expm1(-beyond / self.length)

    def _bent_by_tanh(self, distance: Array, beyond: Array, first: npt.ArrayLike, lift: float, share: float) -> Array:
        """∫ F_0 + share · ΔF (tanh z + lift) from the knee on. Args: first: z at the knee."""
        z = np.maximum((distance - self.range) / self.length + np.pi, first)
        bent = self.length * (_log_cosh(z) - _log_cosh(np.asarray(first))) + lift * beyond
        return self.knee_force * beyond + share * self.rise * np.where(beyond > 0.0, bent, 0.0)


def linear_range(tuning: ImpedanceTuning) -> Array:
    """x_0 (k,) of a tuning, m or rad: its own, or min(0.95 x_b, 0.95 F_max/K_0)."""
    if tuning.linear_range is not None:
        return tuning.linear_range
    reach = np.divide(tuning.force_max, tuning.stiffness, out=np.zeros_like(tuning.range), where=tuning.stiffness > 0.0)
    return LINEAR_SHARE * np.minimum(tuning.range, reach)


def _log_cosh(z: Array) -> Array:
    size = np.abs(z)  # the naive form overflows at 710
    return size + np.log1p(np.exp(-2.0 * size)) - _LN2
