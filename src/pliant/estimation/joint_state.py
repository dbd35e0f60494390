"""Joint positions from measured velocities and positions: the integrated velocity has little noise, the measured
position does not drift."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from pliant.errors import ConfigError
from pliant.estimation.ordering import time_since
from pliant.frozen import changed
from pliant.interfaces import Estimator
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class JointStateState:
    """State of the filter."""

    inner: Any
    """state of the estimator inside"""
    time: float
    """s, of the last reading"""
    q: Array
    """(n,) filtered, rad"""
    v: Array
    """(n,) last velocity, rad/s"""
    readings: int
    """number of readings"""


class JointStateFilter(Estimator[JointStateState]):
    """`q̂ ← q̂ + ½ T (v + v_before)`, then `q̂ ← q̂ + a (q − q̂)`, `a = T/memory`: position noise without a lag.

    This is the stationary Kalman filter of a joint whose velocity is measured, too: with white noise σ_q on q and σ_v
    on v the best gain solves `a²/(1 − a) = (T σ_v/σ_q)²` (Kalman, "A new approach to linear filtering and prediction
    problems", 1960). The first readings are averaged. What the noise of q leaves in q̂ is `σ_q √(a/(2 − a))`; a constant
    error b of v shifts q̂ by `b · memory`.

    Args:
        inner: the estimator whose `q` is replaced; its velocity is integrated.
        memory: s.

    Raises:
        ConfigError: a memory that is not above zero.
    """

    def __init__(self, inner: Estimator[Any], memory: float = 0.3) -> None:
        if not (math.isfinite(memory) and memory > 0.0):
            raise ConfigError(f"the memory of a joint state filter must be above zero (s), got {memory}")
        self.inner, self.memory = inner, memory

    def init(self, measurement: Measurement) -> JointStateState:
        return JointStateState(self.inner.init(measurement), measurement.time, measurement.q, measurement.v, 0)

    def step(self, measurement: Measurement, state: JointStateState) -> tuple[Estimate, JointStateState]:
        """The completed estimate and the next state.

        Raises:
            SignalError: the measurement is older than the last one.
        """
        estimate, inner = self.inner.step(measurement, state.inner)
        period = time_since(state.time, measurement)
        moved = state.q + 0.5 * period * (state.v + estimate.v)
        readings = state.readings + 1
        gain = min(1.0, max(period / self.memory, 1.0 / readings))
        q = moved + gain * (estimate.q - moved)
        return changed(estimate, q=q), JointStateState(inner, measurement.time, q, estimate.v, readings)
