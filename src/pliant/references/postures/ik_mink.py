"""Inverse kinematics with mink: a quadratic program per Gauss-Newton step, joint ranges as its constraints."""

from __future__ import annotations

import daqp
import mink
import mujoco
import numpy as np

from pliant.mujoco_model import spec_from_robot
from pliant.references.postures.inverse_kinematics import JointBox, PoseSolver, Target
from pliant.robot import Robot
from pliant.spatial import Array

_DAMPING = 1e-12  # as mink's own; the posture's share is 9e-6


class MinkSolver(PoseSolver):
    """Poses by [mink](https://github.com/kevinzakka/mink) on the robot's MuJoCo model, with the solver daqp.

    mink's `solve_ik` takes any tasks and limits and builds a general problem of them at each call. Here the tasks are
    the same two in every step, so that the same problem is written into arrays that stay.

    Args:
        robot: any robot.
        frame: frame to place.
    """

    def __init__(self, robot: Robot, frame: str) -> None:
        super().__init__(robot, frame)
        model: mujoco.MjModel = spec_from_robot(robot, looks=False).compile()
        self._configuration = mink.Configuration(model)
        self._pose = mink.FrameTask(frame, "site", position_cost=1.0, orientation_cost=1.0)
        n = robot.n
        self._jacobian = np.vstack([np.zeros((6, n)), self.POSTURE_COST * np.eye(n)])
        self._error = np.zeros(6 + n)
        # Joint ranges are a box that is set for every call, so that they can bound the step per sample too.
        self._rows = np.vstack([np.eye(n), -np.eye(n)])
        self._no_bound, self._sense = np.full(2 * n, -1e30), np.zeros(2 * n, dtype=np.int32)

    def solve(self, guess: Array, prior: Array, box: JointBox, target: Target) -> Array:
        q = box.clip(guess)
        target = target.nearest(self.rotation(q))
        about = (1.0, 1.0, 0.0) if target.spins else (1.0, 1.0, 1.0)  # the frame's own axes
        self._pose.set_orientation_cost(0.0 if target.rotation is None else about)
        rotation = mink.SO3.identity() if target.rotation is None else mink.SO3.from_matrix(target.rotation)
        self._pose.set_target(mink.SE3.from_rotation_and_translation(rotation, target.position))
        for _ in range(self.MAX_ITERATIONS):
            step = self._step(q, prior, box)
            q = box.clip(q + step)
            if float(np.max(np.abs(step))) < self.STEP_TOLERANCE:
                break
        return q

    def _step(self, q: Array, prior: Array, box: JointBox) -> Array:
        """Δq (n,): min ‖W (J Δq + e)‖² + c² ‖q + Δq − q_prior‖² with lower ≤ q + Δq ≤ upper."""
        n = self.robot.n
        self._configuration.update(q)
        self._jacobian[:6], self._error[:6], _ = self._pose.compute_qp_residual(self._configuration)
        self._error[6:] = self.POSTURE_COST * (prior - q)
        H = self._jacobian.T @ self._jacobian
        H.flat[:: n + 1] += _DAMPING
        c = -(self._error @ self._jacobian)
        bound = np.concatenate([box.upper - q, q - box.lower])
        found, _, flag, _ = daqp.solve(H, c, self._rows, bound, self._no_bound, self._sense)
        if flag <= 0:
            raise mink.NoSolutionFound("daqp")
        return found
