"""The mechanical stops of the joints, with a stiffness and a damping in physical units.

A stop is one of MuJoCo's joint limits, whose force obeys, with a constant impedance d and the joint's inverse
inertia Â,

    τ = −(K x + B ẋ + m ẍ)      x beyond the limit, τ never pulls
    solref = (−K Â (1−d), −B Â (1−d)),   m = d / ((1−d) Â)

so that K and B are exact. m is an inertia of the stop itself. It acts only beyond the limit, and it makes the physics
step stable for every K on every joint: a wrist of 3e-4 kg m² behind a drive of 40 N·m would need steps of 0.1 ms
without it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np

from pliant.errors import ConfigError
from pliant.robot import Robot
from pliant.spatial import Array

_UNLIMITED_TORQUE = 100.0  # N·m or N, where the robot's file gives no limit
_STEPS_SQUARED = 2.0  # m over K dt²: with B at most critical, K dt² + 2 B dt < 4 m for a joint without inertia


@dataclass(frozen=True)
class JointStops:
    """Stiffness and damping of the joints' stops.

    K is such that the torque limit alone pushes a joint by `give` beyond its limit.

    Raises:
        ConfigError: on construction, when a value is not above zero.
    """

    give: float = math.radians(0.5)
    """rad beyond the limit under 100 % of the torque limit"""
    give_linear: float = 1e-3
    """m, of joints that slide"""
    damping_ratio: float = 0.7
    """of the joint on its stop; 0…1"""

    def __post_init__(self) -> None:
        if not (self.give > 0.0 and self.give_linear > 0.0 and 0.0 <= self.damping_ratio <= 1.0):
            raise ConfigError(f"joint stops need a give above zero and a damping ratio of 0 to 1, got {self}")

    def stiffness(self, robot: Robot, slides: Array) -> Array:
        """(n,) K, N·m/rad, or N/m of joints that slide. Args: robot; slides (n,), which joints do."""
        torque = np.where(np.isfinite(robot.torque_limit), robot.torque_limit, _UNLIMITED_TORQUE)
        return np.where(slides, torque / self.give_linear, torque / self.give)


def apply_stops(model: mujoco.MjModel, robot: Robot, stops: JointStops) -> None:
    """Gives every limited joint of the robot its stop.

    Args:
        model: compiled, `timestep` set; the robot's joints by their names.
        robot: for names and torque limits.
        stops: stiffness and damping.
    """
    joints = [model.joint(name).id for name in robot.joint_names]
    slides = np.array([model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE for joint in joints])
    for joint, K in zip(joints, stops.stiffness(robot, slides), strict=True):
        A_hat = float(model.dof_invweight0[model.jnt_dofadr[joint]])
        m = _STEPS_SQUARED * K * float(model.opt.timestep) ** 2
        d = m * A_hat / (1.0 + m * A_hat)
        B = 2.0 * stops.damping_ratio * math.sqrt(K * (1.0 / A_hat + m))
        model.jnt_solimp[joint] = [d, d, 1e-3, 0.5, 2.0]
        model.jnt_solref[joint] = [-K * A_hat * (1.0 - d), -B * A_hat * (1.0 - d)]


def limits_of(model: mujoco.MjModel, robot: Robot) -> tuple[Array, Array]:
    """Lowest and highest position (n,) of the robot's joints in a compiled model, rad; infinite without a stop."""
    joints = [model.joint(name).id for name in robot.joint_names]
    limited = model.jnt_limited[joints].astype(bool)
    lower, upper = np.where(limited, model.jnt_range[joints].T, [[-np.inf], [np.inf]])
    return lower, upper
