"""Inverse kinematics with mink: a quadratic program per Gauss-Newton step, joint ranges as its constraints."""

from __future__ import annotations

import mink
import mujoco
import numpy as np

from pliant.mujoco_model import spec_from_robot
from pliant.references.postures.inverse_kinematics import JointBox, PoseSolver, Target
from pliant.robot import Robot
from pliant.spatial import Array


class MinkSolver(PoseSolver):
    """Poses by [mink](https://github.com/kevinzakka/mink) on the robot's MuJoCo model, with the solver daqp.

    Args:
        robot: any robot.
        frame: frame to place.
    """

    def __init__(self, robot: Robot, frame: str) -> None:
        super().__init__(robot, frame)
        model: mujoco.MjModel = spec_from_robot(robot).compile()
        self._configuration = mink.Configuration(model)
        self._pose = mink.FrameTask(frame, "site", position_cost=1.0, orientation_cost=1.0)
        self._posture = mink.PostureTask(model, cost=self.POSTURE_COST)
        # Joint ranges are a box that this class sets for every call, so that they can bound the step per sample too.
        self._range = _BoxLimit(robot.n)

    def solve(self, guess: Array, prior: Array, box: JointBox, target: Target) -> Array:
        q = box.clip(guess)
        self._range.box = box
        self._posture.set_target(prior)
        target = target.nearest(self.rotation(q))
        about = (1.0, 1.0, 0.0) if target.spins else (1.0, 1.0, 1.0)  # the frame's own axes
        self._pose.set_orientation_cost(0.0 if target.rotation is None else about)
        rotation = mink.SO3.identity() if target.rotation is None else mink.SO3.from_matrix(target.rotation)
        self._pose.set_target(mink.SE3.from_rotation_and_translation(rotation, target.position))
        for _ in range(self.MAX_ITERATIONS):
            self._configuration.update(q)
            step = mink.solve_ik(self._configuration, (self._pose, self._posture), 1.0, "daqp", limits=(self._range,))
            q = box.clip(q + step)
            if float(np.max(np.abs(step))) < self.STEP_TOLERANCE:
                break
        return q


class _BoxLimit(mink.Limit):
    """lower ≤ q + Δq ≤ upper."""

    box: JointBox

    def __init__(self, n: int) -> None:
        self._rows = np.vstack([np.eye(n), -np.eye(n)])

    def compute_qp_inequalities(self, configuration: mink.Configuration, dt: float) -> mink.Constraint:
        q = configuration.q
        return mink.Constraint(G=self._rows, h=np.concatenate([self.box.upper - q, q - self.box.lower]))
