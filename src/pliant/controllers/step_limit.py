"""A bound on the rate of change of the torques, around any controller."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np

from pliant import _guard
from pliant.compiled import CompiledController, face_of
from pliant.controllers.compiled_step_limit import CompiledStepLimit
from pliant.errors import ConfigError
from pliant.flat_channels import FlatChannels, FlatLayout
from pliant.frozen import quick
from pliant.interfaces import ChannelUnit, Controller, HasUnit, Needs
from pliant.quantity import quantity
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Reference
from pliant.spatial import Array

DEFAULT_SHARE = 0.14
"""share of a joint's torque limit per period, a change that controllers do not need to exceed in normal use"""
TorqueStep = Annotated[
    float | None,
    quantity(
        ...,
        "1",
        "largest change of a joint's torque per period, as a share of its limit; none: unbounded",
        gt=0.0,
        le=1e3,
    ),
]
"""a key of configurations"""
SPENDABLE = "energy/spendable"
"""channel of a controller that accounts for its energy: J that an outer wrapper may spend in the next period"""
CHANNELS: Mapping[str, HasUnit] = {"energy/step_limit": ChannelUnit("J"), "step_limit/exceeded": ChannelUnit("1")}
"""name → unit of what is added to the inner controller's channels"""


@quick
class StepLimitState:
    """State of the inner controller, and the energy of the bound."""

    inner: Any
    memory: Array
    """joint positions of the last tick, rad, its torque and what was held back of it, N·m; J withheld since the start
    (negative: released to the robot)"""

    @property
    def held_back(self) -> Array:
        """(n,) N·m, torque of the last tick that was not sent."""
        n = len(self.memory) // 3
        return self.memory[2 * n : 3 * n]

    @property
    def energy(self) -> float:
        """J withheld from the robot since the start."""
        return float(self.memory[-1])


class StepLimit(Controller[StepLimitState]):
    """Bounds the change of each joint's torque from one period to the next.

    Gears, joint-torque loops and the safety functions of most robots need torques without jumps; an attractor that
    switches its phase makes them jump, and so does a change of stiffness at a constant error. What the bound takes away
    is part of `Command.clamped`; its work is in `energy/step_limit`, and the inner controller is informed
    (`Controller.kept_back`).

    A torque that lags behind can release energy that the controller did not intend. Where the controller gives the
    energy that may be spent (channel `energy/spendable`), and the lag would cost more over a step like the last one,
    the torque exceeds the bound: passivity has priority. `step_limit/exceeded` says by how much, as a share of the
    bound (0: held).

    Args:
        inner: the controller whose torques are bounded.
        robot: for the torque limits.
        share: largest change per period, as a share of the joint's torque limit; joints without a limit are not
            bounded.

    Raises:
        ConfigError: the share is not above zero.
    """

    def __init__(self, inner: Controller[Any], robot: Robot, share: float = DEFAULT_SHARE) -> None:
        if not (math.isfinite(share) and share > 0.0):
            raise ConfigError(f"the torque step must be a share above zero of the torque limit, got {share}")
        self.inner = inner
        self.step_max: Array = share * robot.torque_limit
        self._limit: Array = robot.torque_limit
        self._n = len(self.step_max)
        self._core = _guard.StepLimit(self.step_max.tolist())
        self._layouts = (FlatLayout({}), FlatLayout({}))

    @property
    def needs(self) -> Needs:
        return self.inner.needs

    @property
    def channels(self) -> Mapping[str, HasUnit]:
        return {**self.inner.channels, **CHANNELS}

    @property
    def regulates_force(self) -> bool:
        return self.inner.regulates_force

    def init(self, estimate: Estimate) -> StepLimitState:
        """The first torque may differ by one step from the torque that the robot reports; with no report it is
        free."""
        sent = np.clip(np.nan_to_num(estimate.torque_sent, nan=0.0), -self._limit, self._limit)
        memory = np.concatenate([estimate.q, sent, np.zeros(len(sent) + 1)])
        return StepLimitState(self.inner.init(estimate), memory)

    def step(self, estimate: Estimate, reference: Reference, state: StepLimitState) -> tuple[Command, StepLimitState]:
        command, inner = self.inner.step(estimate, reference, state.inner)
        n, memory, given = self._n, state.memory.copy(), command.diagnostics
        numbers = given.numbers if isinstance(given, FlatChannels) else None
        out = np.empty(2 * n if numbers is None else 2 * n + len(numbers) + len(CHANNELS))
        asked, clamped, q = command.torque, command.clamped, estimate.q
        exceeded = self._core.step(asked, clamped, q, given, SPENDABLE, numbers, memory, out)
        if exceeded is not None:
            inner = self.inner.kept_back(inner, memory[2 * n : 3 * n].copy())
        if isinstance(given, FlatChannels):
            channels = FlatChannels(self._followed(given.layout), out[2 * n :])
        else:
            channels = {**given, **dict(zip(CHANNELS, (float(memory[-1]), exceeded or 0.0), strict=True))}
        return Command(command.time, out[:n], out[n : 2 * n], channels), StepLimitState(inner, memory)

    def compiled_face(self, estimate: Estimate, state: StepLimitState) -> CompiledStepLimit | None:
        inner = face_of(self.inner, CompiledController, estimate, state.inner)
        return (
            None
            if inner is None
            else CompiledStepLimit(self._core, inner, self._n, self._followed, tuple(CHANNELS), SPENDABLE)
        )

    def _followed(self, layout: FlatLayout) -> FlatLayout:
        """The inner controller's layout with the channels of the bound."""
        known, followed = self._layouts
        if known is not layout:
            followed = layout.followed_by(tuple(CHANNELS))
            self._layouts = layout, followed
        return followed
