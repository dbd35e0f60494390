"""The fractal impedance controller at one frame."""

from __future__ import annotations

from collections.abc import Mapping

from pliant.controllers.attractor import Law
from pliant.controllers.phase_settings import PhaseSettings
from pliant.controllers.stack import Stack, StackState
from pliant.controllers.task import FrameTask
from pliant.interfaces import Controller, HasUnit, Needs
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Reference


class FractalImpedance(Controller[StackState]):
    """Pulls one frame towards its reference with bounded force ([HapFIC] sec. II-C; [Stack] sec. II-B).

    The same as a stack of one task. Joints that the task does not hold stay free: without friction or damping in them,
    add a second task, or use it on a robot with as many joints as axes.
    """

    def __init__(
        self,
        robot: Robot,
        task: FrameTask,
        period: float,
        *,
        law: Law = Law.CAPPED,
        phases: PhaseSettings | None = None,
        gravity_compensation: bool = False,
    ) -> None:
        """Arguments and errors as in `Stack`, with one task."""
        self.task = task
        self.stack = Stack(robot, [task], period, law=law, phases=phases, gravity_compensation=gravity_compensation)

    @property
    def needs(self) -> Needs:
        """Signals that its stack needs."""
        return self.stack.needs

    @property
    def channels(self) -> Mapping[str, HasUnit]:
        """Name → unit of every channel in `Command.diagnostics`."""
        return self.stack.channels

    def init(self, estimate: Estimate) -> StackState:
        """Starts diverging, with an empty ledger."""
        return self.stack.init(estimate)

    def step(self, estimate: Estimate, reference: Reference, state: StackState) -> tuple[Command, StackState]:
        """The torque for the next period, and the next state. Raises as `Stack.step` does."""
        return self.stack.step(estimate, reference, state)
