"""The state at which a solution takes effect: what was measured, rolled through the torques that are under way."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pliant import _mpc
from pliant.mpc.kernel import kernel_model
from pliant.mpc.problem import MpcProblem
from pliant.spatial import Array


class DelayPrediction:
    """Rolls a measured state through torques with the controller's own model, disturbance included.

    Force feedback moves its contact force along, `λ̇ = −K ẋ − B ẍ` ([FFMPC] eq. 18), and never below zero along the
    normal; the rigid contact of the other two holds the tool where its phase says so. In torque feedback the joint
    torque follows the torque sent, with the difference that both had when they were measured.

    Args:
        problem: the controller's.
        chain: the robot.
        period: s for which each torque acts.
    """

    def __init__(self, problem: MpcProblem, chain: _mpc.Chain, period: float) -> None:
        self._n, self._m = chain.dof, problem.m
        self._kind = problem.config.kind
        self._normal = 2 * self._n + (2 if self._m >= 3 else 0)  # index of the normal force in x
        moving = "classical" if self._kind == "torque_feedback" else self._kind
        self._node = _mpc.Node(chain, kernel_model(problem, moving), period)
        self.parameters = self._node.parameters
        """of the contact: one row, as in the problem"""
        problem.write_contact(self.parameters)

    def ahead(self, x: Array, torques: Sequence[Array], acted: Array, touching: bool) -> Array:
        """The state after the torques have acted.

        Args:
            x: (nx,) measured.
            torques: each (n,) N·m, the next one first, what disturbs the joints added.
            acted: (n,) N·m that acted when x was measured, likewise.
            touching: whether the contact holds.

        Returns:
            (nx,).
        """
        if not len(torques):
            return x
        n = self._n
        self.parameters.contact_active[...] = touching
        self._node.freeze(x[:n])
        state = x[: 2 * n] if self._kind == "torque_feedback" else np.array(x)
        for torque in torques:
            state = self._node.calc(state, torque).x_next
            if self._kind == "force_feedback":
                state[self._normal] = max(state[self._normal], 0.0)
        if self._kind != "torque_feedback":
            return state
        return np.concatenate([state, x[2 * n :] + torques[-1] - acted])
