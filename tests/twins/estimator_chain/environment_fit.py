"""Stiffness and damping of what a robot touches, from force and motion: recursive least squares with forgetting."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from pliant.environment import Environment
from pliant.estimation import FitConfig
from pliant.frozen import changed
from pliant.spatial import Array
from tests.twins.estimator_chain.filters import ButterworthTwin, Memory


@dataclass(frozen=True, slots=True)
class FitState:
    """What the fit remembers. The signals are depth, its rate, and force: m, m/s, N."""

    reference: Array | None = None
    """(3,) signals at first touch, taken off all others against rounding; None out of contact"""
    filter: Memory | None = None
    slow: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) slow mean, taken off"""
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


class FitTwin:
    """F = K p + B ṗ + c along the normal, with depth p from an unknown zero."""

    def __init__(self, config: FitConfig, period: float) -> None:
        self.config = config
        self._filter = ButterworthTwin(config.cutoff, period)
        self._drift = 1.0 - math.exp(-2.0 * math.pi * config.drift * period)
        passed = min(1.0, 2.22 * config.cutoff * period)  # share of white noise's variance: noise bandwidth 1.11 f_c
        self._correlated = 1.0 / passed
        """neighbouring samples that share their noise after the filter"""
        self._noise = passed * np.diag([config.noise_depth**2, config.noise_rate**2])
        """(2, 2) covariance of the motion's noise after the filter"""

    def step(self, force: float, depth: float, rate: float, state: FitState) -> FitState:
        """One sample."""
        if force < self.config.touch:
            return FitState(found=state.found)
        signals = np.array([depth, rate, force])
        if state.reference is None:
            state = changed(state, reference=signals, filter=self._filter.init(np.zeros(3)))
        assert state.reference is not None
        assert state.filter is not None
        value, memory = self._filter.step(signals - state.reference, state.filter)
        slow = state.slow + self._drift * (value - state.slow)
        value = value - slow
        state = changed(state, filter=memory, slow=slow)
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
