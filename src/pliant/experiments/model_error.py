"""Random errors of a controller's robot model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError
from pliant.robot import Robot
from pliant.spatial import Array


def with_mass_error(robot: Robot, share: float, rng: np.random.Generator) -> Robot:
    """The robot as a controller believes it: each link's mass is changed by a random share.

    Mass and inertia of a link are scaled by the same factor, drawn uniformly from 1 ± share; centres of mass, rotors
    and kinematics stay. The plant keeps the robot that was given.

    Args:
        robot: the true one.
        share: 0 … below 1; 0 gives the robot itself and draws nothing.
        rng: of this draw alone.

    Raises:
        ConfigError: a share outside that range.
    """
    if not 0.0 <= share < 1.0:
        raise ConfigError(f"the error of the model's masses must be a share of 0 … below 1, got {share:g}")
    if share == 0.0:
        return robot
    return with_masses(robot, rng.uniform(1.0 - share, 1.0 + share, robot.model.njoints - 1))


def with_masses(robot: Robot, factors: Array) -> Robot:
    """The robot with mass and inertia of each joint's link multiplied by a factor. Args: factors: one per joint."""
    model = robot.model.copy()
    for joint, factor in enumerate(factors.tolist(), start=1):
        true = model.inertias[joint]
        model.inertias[joint] = pin.Inertia(factor * true.mass, true.lever, factor * true.inertia)
    return replace(robot, model=model)
