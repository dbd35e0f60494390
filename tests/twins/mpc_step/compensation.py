"""Delay, disturbance and force offset, taken out around a predictive problem.

Offset-free control by estimated disturbances: Pannocchia, Rawlings, "Disturbance models for offset-free
model-predictive control", AIChE Journal 49, 2003. Here the disturbance is a joint torque d̂ (momentum observer): the
problem is solved in ũ from the state at which its solution takes effect, and u = ũ − d̂ is sent.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pliant import _mpc
from pliant.errors import ConfigError, SignalError
from pliant.mpc.config import Compensation
from pliant.mpc.horizon import HorizonReference
from pliant.mpc.problem import MpcProblem
from pliant.signals import Estimate, Reference
from pliant.spatial import Array
from tests.twins.mpc_step.prediction import DelayPrediction


@dataclass(frozen=True, slots=True)
class CompensationState:
    """What a controller with delays remembers."""

    commands: tuple[Array, ...]
    """torques (n,) that were sent, N·m, the oldest first: the one that acted when the state was measured, then those
    under way"""
    wanted: tuple[Array, ...]
    """torques (n,) before averaging, N·m, the newest last"""
    force_shift: float = 0.0
    """N, of the force reference along the normal"""


class Compensator:
    """The compensations of one controller.

    Args:
        config: which of them.
        problem: the controller's.
        chain: the robot.
        period: s between two commands.

    Raises:
        ConfigError: a delay or an average that is not a whole number of periods.
    """

    def __init__(self, config: Compensation, problem: MpcProblem, chain: _mpc.Chain, period: float) -> None:
        self.config = config
        self._solve_period = problem.config.period
        self._count = _periods(config.delay, period, "compensation.sensing_delay + compensation.computation_delay")
        self._averaged = max(_periods(config.averaging, period, "compensation.averaging"), 1)
        self._late = round(0.5 * (self._averaged - 1) + 1e-9)
        """periods by which averaging delays a torque"""
        self.lead = config.computation_delay + self._late * period
        """s from an estimate to the effect of the command that answers to it"""
        self._prediction = DelayPrediction(problem, chain, period)
        self._problem, self._frame = problem, problem.contact_frame

    @property
    def contact(self) -> _mpc.Nodes:
        """Parameters of the contact in the prediction over the delay."""
        return self._prediction.parameters

    def init(self, estimate: Estimate) -> CompensationState:
        """State before the first step: what was sent so far goes on."""
        limit = self._problem.torque_limit
        sent = np.clip(np.nan_to_num(estimate.torque_sent, nan=0.0), -limit, limit)
        return CompensationState((sent,) * (self._count + 1), (sent,) * self._averaged)

    def disturbance(self, estimate: Estimate) -> Array:
        """d̂ (n,), N·m; zero where it is not asked for.

        Raises:
            SignalError: it is asked for and the estimate has none.
        """
        if not self.config.disturbance:
            return np.zeros_like(estimate.q)
        if estimate.disturbance is None:
            raise SignalError(
                "compensation.disturbance needs an estimated disturbance: put a MomentumObserver round the estimator"
            )
        return estimate.disturbance

    def ahead(self, x: Array, disturbance: Array, touching: bool, state: CompensationState) -> Array:
        """The state at which a command computed now takes effect, averaging included.

        Args:
            x: (nx,) measured.
            disturbance: d̂ (n,), N·m.
            touching: whether the contact holds.
            state: with the torques under way.
        """
        acted, *under_way = state.commands
        wanted = state.wanted
        for _ in range(self._late):
            wanted = (*wanted[1:], wanted[-1])
            under_way.append(np.add.reduce(wanted) / len(wanted))
        return self._prediction.ahead(x, [u + disturbance for u in under_way], acted + disturbance, touching)

    def shifted(self, horizon: HorizonReference, state: CompensationState) -> HorizonReference:
        """References whose force is shifted along the normal, at the nodes at which there is to be one."""
        if state.force_shift == 0.0:
            return horizon
        normals = np.broadcast_to(self._problem.normals(horizon.task_rotation), (len(horizon.wrench), 3))
        pressing = np.sum(horizon.wrench[:, :3] * normals, axis=1) > 0.0
        wrench = horizon.wrench.copy()
        wrench[:, :3] += state.force_shift * pressing[:, None] * normals
        return replace(horizon, wrench=wrench)

    def integrate(
        self, estimate: Estimate, reference: Reference, pressing: bool, state: CompensationState
    ) -> CompensationState:
        """Moves the force shift on from one solve to the next; without contact it starts anew.

        Args:
            estimate: of now.
            reference: of now, with the wrench that is wanted now.
            pressing: whether the task is in contact.
            state: of the step before.
        """
        measured = estimate.wrenches.get(self._frame)
        if self.config.force_integral == 0.0 or measured is None or not reference.tasks:
            return state
        if not (pressing and estimate.contacts.get(self._frame, False)):
            return replace(state, force_shift=0.0)
        normal = self._problem.normals(reference.tasks[0].task_rotation)
        error = float(normal @ (reference.tasks[0].wrench[:3] - measured[:3]))
        if not np.isfinite(error):
            return state
        limit = self.config.force_shift_max
        shift = state.force_shift + self.config.force_integral * self._solve_period * error
        return replace(state, force_shift=float(np.clip(shift, -limit, limit)))

    def send(self, wanted: Array, state: CompensationState) -> tuple[Array, CompensationState]:
        """The torque (n,) that is sent for a wanted one within the limits, and the next state."""
        recent = (*state.wanted[1:], wanted)
        sent = wanted if self._averaged == 1 else np.add.reduce(recent) / len(recent)
        return sent, replace(state, commands=(*state.commands[1:], sent), wanted=recent)


def _periods(duration: float, period: float, what: str) -> int:
    ratio = duration / period
    if abs(ratio - round(ratio)) > 1e-6:
        raise ConfigError(f"{what} must be a whole multiple of the control period {period:g} s, got {duration:g} s")
    return round(ratio)
