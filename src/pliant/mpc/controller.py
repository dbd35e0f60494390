"""Predictive control behind the controller interface: classical, torque feedback, force feedback."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from pliant._mpc import ControllerState as MpcState
from pliant.interfaces import Controller, Lookahead, Needs
from pliant.mpc import diagnostics
from pliant.mpc.chain import chain_from_robot
from pliant.mpc.compensation import delays_of
from pliant.mpc.compiled_controller import CompiledMpc
from pliant.mpc.config import MpcConfig
from pliant.mpc.kernel import kernel_step
from pliant.mpc.make_problem import problem_from_robot
from pliant.mpc.needs import needs_of
from pliant.mpc.problem import MpcProblem
from pliant.mpc.refusals import no_wrench, refused
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Reference
from pliant.spatial import Array


class MpcController(Controller[MpcState]):
    """Solves the predictive problem every `config.period` and sends its first torque.

    Between two solves it follows `config.between`. Without a usable solution it follows the last usable plan to
    its end, then compensates gravity with joint damping. It sends no torque that is not finite.

    With `config.compensation` it solves from the state at which its command takes effect and subtracts the estimated
    disturbance from what it sends.

    This class is the handle of one compiled call (`cpp/mpc/step`), which does everything between estimate and torque;
    `tests/twins/mpc_step` implements the same in Python. Its state can be copied (`copy.copy`) and pickled.

    Args:
        robot: serial, at most 8 joints.
        config: which model, costs, phases.
        period: s from step to step; None: `config.period`, a solve at every step.

    Raises:
        RobotError: a robot that the kernel cannot take, an unknown frame.
        ConfigError: weights that do not fit the robot, a stiffness outside the integrator's range, a delay that is not
            a whole number of periods.
    """

    def __init__(self, robot: Robot, config: MpcConfig, period: float | None = None) -> None:
        self.robot, self.config = robot, config
        self.problem: MpcProblem = problem_from_robot(robot, config)
        self.chain = chain_from_robot(robot, config.frame, config.contact.frame)
        self.delays = delays_of(config.compensation, period or config.period)
        self._core = kernel_step(self.problem, self.chain, self.delays, period or config.period)
        self._rows = (3, robot.n)

    @property
    def needs(self) -> Needs:
        """A preview at every solve, from the time at which its command takes effect, and the signals of its model and
        compensation."""
        wanted = needs_of(self.config)
        return replace(
            wanted, preview=Lookahead(self.config.horizon, self.config.dt, self.delays.lead, self.config.period)
        )

    @property
    def regulates_force(self) -> bool:
        """True: its costs track the reference's force in every phase with contact."""
        return True

    @property
    def channels(self) -> Mapping[str, diagnostics.DiagnosticChannel]:
        """Name → unit of every channel in `Command.diagnostics`."""
        return diagnostics.CHANNELS

    def init(self, estimate: Estimate) -> MpcState:
        """State before the first step: the torque sent so far is held.

        Raises:
            SignalError: the estimate lacks the contact force that force feedback needs, or is not finite.
            ShapeError: the estimate is of another robot.
        """
        q = self.robot.vector(estimate.q, "the estimate's q")
        v = self.robot.vector(estimate.v, "the estimate's v")
        frame = self.problem.contact_frame
        if needs_of(self.config).wrench and estimate.wrenches.get(frame) is None:
            raise no_wrench(frame, estimate)
        return self._core.init(estimate.time, q, v, estimate.torque_sent)

    def step(self, estimate: Estimate, reference: Reference, state: MpcState) -> tuple[Command, MpcState]:
        out = np.empty(self._rows)
        refusal = self._core.step(estimate, reference, state, out)
        if refusal is not None:
            raise refused(refusal, self.problem, estimate, reference)
        torque, clamped, disturbance = out
        return Command(estimate.time, torque, clamped, _channels(state, disturbance)), state

    def compiled_face(self, estimate: Estimate, state: MpcState) -> CompiledMpc:
        n, frames = self.robot.n, (self.config.frame, self.problem.contact_frame)
        return CompiledMpc(self._core, state, frames, n, _channels(state, np.zeros(n)))


def _channels(state: MpcState, disturbance: Array) -> dict[str, float | Array]:
    return {
        **state.channels,
        "mpc/source": float(state.source),
        "mpc/failures": float(state.failures),
        "mpc/disturbance": disturbance,
        "mpc/force_shift": state.force_shift,
    }
