"""The estimator of a robot with good sensors: it returns the measurement, with low-passed velocities if wanted."""

from __future__ import annotations

from pliant.errors import ConfigError
from pliant.interfaces import Estimator
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array


class DirectEstimator(Estimator[Array]):
    """Passes joint signals on; its state is the filtered joint velocity (n,), rad/s. It ignores wrenches.

    Args:
        velocity_gain: α of v ← v + α (v_measured − v); 1 filters nothing.

    Raises:
        ConfigError: the gain is not within (0, 1].
    """

    def __init__(self, velocity_gain: float = 1.0) -> None:
        if not 0.0 < velocity_gain <= 1.0:
            raise ConfigError(f"velocity_gain must lie within (0, 1], got {velocity_gain}")
        self.velocity_gain = velocity_gain

    def init(self, measurement: Measurement) -> Array:
        return measurement.v

    def step(self, measurement: Measurement, state: Array) -> tuple[Estimate, Array]:
        v = state + self.velocity_gain * (measurement.v - state)
        return Estimate(measurement.time, measurement.q, v, measurement.torque, measurement.torque_sent), v
