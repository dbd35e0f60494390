"""What a solve leaves behind for the periods until the next one, and what to do when there is no plan."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant import _mpc
from pliant.mpc.config import MpcConfig
from pliant.spatial import Array, all_finite


@dataclass(frozen=True, slots=True)
class Plan:
    """A usable solution."""

    time: float
    """s, of the state it starts from"""
    x0: Array
    """(nx,) that state"""
    torques: Array
    """(N, n) torque to send now and one, two, … steps of the horizon later, N·m"""
    feedback_gain: Array
    """(n, nx) u(x) ≈ torques[0] − gain (x − x0)"""


def plan_of(solution: _mpc.Solution, time: float, n: int, config: MpcConfig) -> Plan:
    """The torques that a solution wants.

    In torque feedback the unfiltered w is too aggressive to send: an interpolation from the measured torque to the
    predicted one goes to the robot, τ_0 + ε (τ_1 − τ_0) with ε = T_mpc/dt ([FFMPC] eq. 15).
    """
    if config.kind != "torque_feedback":
        return Plan(time, solution.xs[0], solution.us, solution.feedback_gain)
    torques = solution.xs[:, 2 * n :]
    share = min(config.period / config.dt, 1.0)
    return Plan(time, solution.xs[0], torques[:-1] + share * np.diff(torques, axis=0), solution.feedback_gain)


def usable(solution: _mpc.Solution, config: MpcConfig) -> bool:
    """Whether a solution may be sent: finite, and following the dynamics. It need not be optimal."""
    broken = solution.status in ("nan", "not_positive_definite")
    return not broken and all_finite(solution.us, solution.xs) and solution.gap <= config.max_gap


def torque_from(plan: Plan, time: float, x: Array | None, config: MpcConfig) -> Array | None:
    """The plan's torque for a later time.

    Args:
        plan: the last usable one.
        time: s.
        x: (nx,) measured state for feedback; None: none was measured.
        config: says what happens between two solves.

    Returns:
        (n,) N·m, or None if the plan's horizon is over or has not begun.
    """
    step = math.floor((time - plan.time) / config.dt + 1e-9)
    if not 0 <= step < len(plan.torques):
        return None
    if step == 0 and config.between == "riccati" and x is not None:
        return plan.torques[0] - plan.feedback_gain @ (x - plan.x0)
    return plan.torques[step]


class SafeTorque:
    """Gravity compensation with joint damping: what is sent when no plan is left."""

    def __init__(self, model: pin.Model, damping: float) -> None:
        self._model, self._damping = model, damping

    def at(self, data: pin.Data, q: Array, v: Array) -> Array:
        """(n,) N·m at finite q (n,) and v (n,)."""
        return np.array(pin.computeGeneralizedGravity(self._model, data, q)) - self._damping * v
