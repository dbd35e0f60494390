"""Stiffness and damping of what a robot touches, from force and motion: recursive least squares with forgetting."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from pydantic import Field

from pliant.configuration import Config
from pliant.environment import Environment
from pliant.estimation.filters import Butterworth, Memory
from pliant.frozen import changed
from pliant.quantity import quantity
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class FitState:
    """State of the fit. The signals are depth, its rate, and force: m, m/s, N."""

    reference: Array | None = None
    """(3,) signals at first contact, subtracted from all others for numerical accuracy; None without contact"""
    filter: Memory | None = None
    accepted: Array | None = None
    """(3,) filtered signals that were used last"""
    count: int = 0
    """samples used since first contact"""
    mean: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) exponentially weighted"""
    covariance: Array = field(default_factory=lambda: np.zeros((3, 3)))
    """(3, 3) exponentially weighted"""
    found: Environment | None = None
    """the last estimate that was accurate enough; it is kept after the contact ends"""


class FitConfig(Config):
    """Forgetting factor, filter and thresholds of the fit."""

    memory: float = quantity(
        300.0,
        "1",
        "number of used samples after which the weight of a sample has fallen to 1/e; unused samples"
        " (standstill) do not count",
        gt=0.0,
        le=1e9,
    )
    cutoff: float = quantity(
        50.0,
        "Hz",
        "of the Butterworth filter of all three signals; the same filter for each keeps their relation",
        gt=0.0,
        le=1e6,
    )
    touch: float = quantity(2.0, "N", "above which there is contact", ge=0.0, le=1e6)
    least_force: float = quantity(
        0.1,
        "N",
        "least change of the force since the last used sample; a few times its noise after the filter",
        ge=0.0,
        le=1e6,
    )
    least_motion: float = quantity(
        1e-7,
        "m",
        "least change of the depth since then; above the position noise after the filter",
        ge=0.0,
        le=1.0,
    )
    noise_depth: float = quantity(
        0.0, "m", "standard deviation of the depth before the filter; see `EnvironmentFit`", ge=0.0, le=1.0
    )
    noise_rate: float = quantity(0.0, "m/s", "the same of its rate", ge=0.0, le=1e3)
    least_samples: int = Field(default=40, ge=1, le=10**9, description="samples before the first estimate")
    accuracy: float = quantity(
        0.2, "1", "largest relative standard uncertainty of K in an estimate that is returned", gt=0.0, le=1e12
    )


class EnvironmentFit:
    """F = K p + B ṗ + c along the normal, with depth p from an unknown zero.

    Least squares over (p, ṗ, 1) with exponential forgetting, in the form of weighted means and covariances, which
    eliminates c, does not wind up, and stays accurate between 3e2 and 1e6 N/m. Samples count only when force and motion
    have changed: without this condition, noise would replace the data while the robot rests.

    Motion noise pulls K towards zero by the factor 1/(1 + σ_p²/var p), σ_p after the filter (errors in variables). If
    its standard deviation is given, its variance is subtracted from var p, which removes this bias, and a contact whose
    motion does not exceed the noise (var p < 3 σ_p²) is not identified at all. A force that is δ s older than the
    motion shifts B by −K δ.

    Args:
        config: see there.
        period: s between two samples.
    """

    def __init__(self, config: FitConfig, period: float) -> None:
        self.config = config
        self._filter = Butterworth(config.cutoff, period)
        passed = min(1.0, 2.22 * config.cutoff * period)  # share of white noise's variance: noise bandwidth 1.11 f_c
        self._correlated = 1.0 / passed
        """neighbouring samples that share their noise after the filter"""
        self._noise = passed * np.diag([config.noise_depth**2, config.noise_rate**2])
        """(2, 2) covariance of the motion's noise after the filter"""

    def step(self, force: float, depth: float, rate: float, state: FitState) -> FitState:
        """One sample.

        Args:
            force: N, normal, positive where the environment pushes.
            depth: m along the inward normal, from any fixed zero.
            rate: m/s of the depth.
            state: of the step before.
        """
        if force < self.config.touch:
            return FitState(found=state.found)
        signals = np.array([depth, rate, force])
        if state.reference is None:
            state = changed(state, reference=signals, filter=self._filter.init(np.zeros(3)))
        assert state.reference is not None
        assert state.filter is not None
        value, memory = self._filter.step(signals - state.reference, state.filter)
        state = changed(state, filter=memory)
        return self._learn(value, state) if self._informative(value, state) else state

    def _informative(self, value: Array, state: FitState) -> bool:
        if state.accepted is None:
            return True
        (depth, _, force), (depth_before, _, force_before) = value.tolist(), state.accepted.tolist()
        stirred = abs(force - force_before) >= self.config.least_force
        return stirred and abs(depth - depth_before) >= self.config.least_motion

    def _learn(self, value: Array, state: FitState) -> FitState:
        count = state.count + 1
        share = max(1.0 / count, 1.0 / self.config.memory)
        off = value - state.mean
        mean = state.mean + share * off
        covariance = (1.0 - share) * (state.covariance + share * np.outer(off, off))
        found = self._solve(covariance, count, share) if count >= self.config.least_samples else None
        return changed(state, accepted=value, count=count, mean=mean, covariance=covariance, found=found or state.found)

    def _solve(self, covariance: Array, count: int, share: float) -> Environment | None:
        """K and B with their uncertainties; None where the data do not determine K."""
        independent = min(float(count), 2.0 / share - 1.0) / self._correlated
        told = covariance - np.pad(self._noise, (0, 1))
        for columns in ([0, 1], [0]):  # a damping below zero is set to zero
            if any(told[i, i] < 2.0 * self._noise[i, i] for i in columns):
                continue
            A, b = told[np.ix_(columns, columns)], told[columns, 2]
            scale = np.sqrt(np.diag(A))
            if not np.all(scale > 0.0):
                continue
            correlation = A / np.outer(scale, scale)
            if np.linalg.det(correlation) < 1e-6:
                continue
            inverse = np.linalg.inv(correlation) / np.outer(scale, scale)
            gains = inverse @ b
            if gains[-1] < 0.0:
                continue
            residual = max(float(covariance[2, 2] - gains @ b), 0.0)
            std = np.sqrt(residual * np.diag(inverse) / max(independent - 3.0, 1.0))
            if std[0] > self.config.accuracy * gains[0]:
                return None
            damping, damping_std = (gains[1], std[1]) if len(columns) == 2 else (0.0, math.inf)
            return Environment(float(gains[0]), float(damping), float(std[0]), float(damping_std))
        return None
