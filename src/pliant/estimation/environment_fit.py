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
    """What the fit remembers. The signals are depth, its rate, and force: m, m/s, N."""

    reference: Array | None = None
    """(3,) signals at first touch, taken off all others against rounding; None out of contact"""
    filter: Memory | None = None
    accepted: Array | None = None
    """(3,) filtered signals that were used last"""
    count: int = 0
    """samples used since first touch"""
    mean: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) exponentially weighted"""
    covariance: Array = field(default_factory=lambda: np.zeros((3, 3)))
    """(3, 3) exponentially weighted"""
    found: Environment | None = None
    """the last belief that was accurate enough; survives the contact"""


class FitConfig(Config):
    """How the fit forgets and when it learns."""

    memory: float = quantity(
        300.0,
        "1",
        "samples after which an old one counts 1/e; only those that are used count, so that standstill erases nothing",
        gt=0.0,
        le=1e9,
    )
    cutoff: float = quantity(
        50.0,
        "Hz",
        "of the Butterworth filter that all three signals pass alike, which leaves their relation as it is",
        gt=0.0,
        le=1e6,
    )
    touch: float = quantity(2.0, "N", "above which there is contact", ge=0.0, le=1e6)
    least_force: float = quantity(
        0.1,
        "N",
        "that the force must have changed since the last sample that was used; a few times its noise after the filter",
        ge=0.0,
        le=1e6,
    )
    least_motion: float = quantity(
        1e-7,
        "m",
        "that the depth must have changed since then; above the position noise after the filter",
        ge=0.0,
        le=1.0,
    )
    noise_depth: float = quantity(
        0.0, "m", "standard deviation of the depth before the filter; see `EnvironmentFit`", ge=0.0, le=1.0
    )
    noise_rate: float = quantity(0.0, "m/s", "the same of its rate", ge=0.0, le=1e3)
    least_samples: int = Field(default=40, ge=1, le=10**9, description="samples before the first belief")
    accuracy: float = quantity(
        0.2, "1", "largest relative standard uncertainty of K in a belief that is shown", gt=0.0, le=1e12
    )


class EnvironmentFit:
    """F = K p + B ṗ + c along the normal, with depth p from an unknown zero.

    Least squares over (p, ṗ, 1) with exponential forgetting, in the form of weighted means and covariances, which
    eliminates c and neither winds up nor loses digits between 3e2 and 1e6 N/m. Samples count only when force and motion
    have changed: without that gate a robot at rest would replace what it learnt by noise.

    Motion noise pulls K towards zero by the factor 1/(1 + σ_p²/var p), σ_p after the filter (errors in variables). With
    its standard deviation given, its variance is taken off var p, which removes the pull, and a contact whose motion
    does not stand out of the noise (var p < 3 σ_p²) is not identified at all. A force that is δ s older than the motion
    shifts B by −K δ.

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
        """K and B with their uncertainties; None where the data do not tell K."""
        independent = min(float(count), 2.0 / share - 1.0) / self._correlated
        told = covariance - np.pad(self._noise, (0, 1))
        for columns in ([0, 1], [0]):  # a damping below zero is none
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
