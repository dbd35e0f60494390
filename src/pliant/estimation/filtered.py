"""Low-pass filters behind another estimator."""

from __future__ import annotations

from typing import Any

from pliant._estimation import FilteredStage
from pliant.estimation.chain import ChainedEstimator
from pliant.estimation.filters import LowPass
from pliant.interfaces import Estimator


class FilteredEstimator(ChainedEstimator):
    """Low-passes velocities, torques and contact wrenches of another estimator; signals without a filter are unchanged.

    The remedy for gearing ripple in a force signal is a `Butterworth` below the ripple's frequency.

    Args:
        inner: where the estimates come from.
        velocity: filter of joint velocities.
        torque: filter of joint torques.
        wrench: filter of every contact wrench.
    """

    def __init__(
        self,
        inner: Estimator[Any],
        *,
        velocity: LowPass | None = None,
        torque: LowPass | None = None,
        wrench: LowPass | None = None,
    ) -> None:
        self.velocity, self.torque, self.wrench = velocity, torque, wrench
        given = {"v": velocity, "torque": torque, "wrenches": wrench}
        stage = FilteredStage(
            velocity=None if velocity is None else velocity.coefficients,
            torque=None if torque is None else torque.coefficients,
            wrench=None if wrench is None else wrench.coefficients,
        )
        super().__init__(stage, inner, frozenset(name for name, filter in given.items() if filter is not None))
