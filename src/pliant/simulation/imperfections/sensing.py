"""Sensors with delay and noise ([FFMPC] eq. 30–32; cpp/plant/imperfect_robot.cpp).

The mismatch between joint torque sensors and force/torque sensor that the published hardware shows ([FFMPC] sec.
VIII-C) is a gain and an offset of each joint torque sensor, drawn once per run. The torque that was sent has no delay,
because a controller knows it without a sensor.
"""

from __future__ import annotations

import numpy as np

from pliant.configuration import Config
from pliant.quantity import quantity
from pliant.simulation.imperfections.link_config import PerJoint


class SensingConfig(Config):
    """Delay and noise. Standard deviations are those of white Gaussian noise on every reading; 0 switches one off."""

    delay: float = quantity(0.0, "s", "delay of every reading", ge=0.0, le=1.0)
    delay_torque: float | None = quantity(
        None, "s", "delay of the joint torque sensors; none: as the others", ge=0.0, le=1.0
    )
    delay_force: float = quantity(0.0, "s", "additional delay of the force/torque sensors", ge=0.0, le=1.0)
    noise_q: PerJoint = quantity(0.0, "rad", "standard deviation of the joint positions")
    noise_v: PerJoint = quantity(0.0, "rad/s", "standard deviation of the joint velocities")
    noise_torque: PerJoint = quantity(0.0, "N·m", "standard deviation of the joint torque sensors")
    fit_joints: bool = quantity(
        False,
        "1",
        "values per joint are those of another robot: further joints take the last value, surplus values are ignored",
    )
    noise_force: float = quantity(
        0.0, "N", "standard deviation of the force part of force/torque sensors", ge=0.0, le=1e3
    )
    noise_moment: float = quantity(0.0, "N·m", "standard deviation of their moment part", ge=0.0, le=1e3)
    torque_gain_error: float = quantity(0.0, "1", "largest relative error of a joint torque sensor", ge=0.0, lt=1.0)
    torque_offset: float = quantity(0.0, "N·m", "largest offset of a joint torque sensor", ge=0.0, le=1e3)

    @property
    def noisy(self) -> frozenset[str]:
        """Fields of `Measurement` of which no two readings are equal."""
        noise = {
            "q": self.noise_q,
            "v": self.noise_v,
            "torque": self.noise_torque,
            "wrenches": max(self.noise_force, self.noise_moment),
        }
        return frozenset(name for name, std in noise.items() if np.max(std) > 0.0)
