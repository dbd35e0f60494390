"""Joint positions from measured velocities and positions: the integrated velocity has little noise, the measured
position does not drift."""

from __future__ import annotations

import math
from typing import Any

from pliant._estimation import JointStateStage
from pliant.errors import ConfigError
from pliant.estimation.chain import ChainedEstimator
from pliant.interfaces import Estimator


class JointStateFilter(ChainedEstimator):
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
        self.memory = memory
        super().__init__(JointStateStage(memory), inner, frozenset({"q"}))
