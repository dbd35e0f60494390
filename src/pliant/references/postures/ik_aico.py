"""Inverse kinematics as inference: one time slice of approximate inference control."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from pliant.references.postures.inverse_kinematics import JointBox, PoseSolver, Target
from pliant.robot import Robot
from pliant.spatial import Array, log3


class AicoSolver(PoseSolver):
    """The most probable configuration given a prior N(q_prior, W⁻¹) and a pose with likelihood N(x(q), C).

    The likelihood's message is linearised at the current belief, `R = JᵀC⁻¹J`, `r = R q̂ + JᵀC⁻¹ e`; the belief is
    `b = (W + R)⁻¹ (W q_prior + r)`; this repeats until the belief rests. Without the joint ranges it is
    the optimum that the quadratic programs find; a range is met by projecting the belief onto it.

    Source: Toussaint 2009, Robot trajectory optimization using approximate inference, for one slice, as
    [Stack] Tiseo et al. 2020, sec. III, uses it.

    Args:
        robot: any robot.
        frame: frame to place.
    """

    MAX_MOVE = 0.3  # rad; trust region of the linearised message

    def __init__(self, robot: Robot, frame: str) -> None:
        super().__init__(robot, frame)
        self._prior_precision = np.eye(robot.n) * self.POSTURE_COST**2  # W, with C = 1 (m² and rad²)

    def solve(self, guess: Array, prior: Array, box: JointBox, target: Target) -> Array:
        q = box.clip(guess)
        for _ in range(self.MAX_ITERATIONS):
            error, J = self._linearised(q, target)
            task_precision = J.T @ J
            message = task_precision @ q + J.T @ error
            belief = np.linalg.solve(self._prior_precision + task_precision, self._prior_precision @ prior + message)
            step = belief - q
            largest = float(np.max(np.abs(step)))
            after = box.clip(q + step * min(1.0, self.MAX_MOVE / max(largest, 1e-12)))
            moved = float(np.max(np.abs(after - q)))
            q = after
            if moved < self.STEP_TOLERANCE:
                break
        return q

    def _linearised(self, q: Array, target: Target) -> tuple[Array, Array]:
        """Error of the pose (k,) and its Jacobian (k, n), world axes; k is 3 without a rotation."""
        model, data = self.robot.model, self._data
        J = self.jacobian(q)
        pin.updateFramePlacement(model, data, self._id)
        pose = data.oMf[self._id]
        distance = target.position - pose.translation
        if target.rotation is None:
            return distance, J[:3]
        R = np.array(pose.rotation)
        turned = target.nearest(R).rotation
        assert turned is not None
        angle = log3(turned @ R.T)
        if target.spins:
            P = np.eye(3) - np.outer(R[:, 2], R[:, 2])
            J[3:], angle = P @ J[3:], P @ angle
        return np.concatenate([distance, angle]), J
