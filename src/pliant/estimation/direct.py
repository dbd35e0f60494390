"""The estimator of a robot with good sensors: it returns the measurement, with low-passed velocities if wanted."""

from __future__ import annotations

from pliant.estimation.chain import ChainedEstimator
from pliant.estimation.wrench import wrench_stage


class DirectEstimator(ChainedEstimator):
    """Passes joint signals on. It ignores wrenches.

    Args:
        velocity_gain: α of v ← v + α (v_measured − v); 1 filters nothing.

    Raises:
        ConfigError: the gain is not within (0, 1].
    """

    def __init__(self, velocity_gain: float = 1.0) -> None:
        self.velocity_gain = velocity_gain
        super().__init__(wrench_stage(None, velocity_gain), None, frozenset())
