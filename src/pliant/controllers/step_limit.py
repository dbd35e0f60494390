"""A bound on how fast torques may change, round any controller."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.errors import ConfigError
from pliant.interfaces import Controller
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Reference
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class StepLimitState:
    """State of the controller inside, and the book of what the bound did."""

    inner: Any
    q: Array
    """(n,) joint positions of the last tick, rad"""
    held_back: Array
    """(n,) torque that the bound took away in the last tick, N·m"""
    energy: float
    """J that the bound kept from the robot since the start (negative: that it let through)"""


class StepLimit(Controller[StepLimitState]):
    """Bounds the change of each joint's torque from one period to the next.

    Gears, joint-torque loops and most robots' own safety want torques that do not jump; an attractor that switches its
    phase makes them jump. What the bound takes away is part of `Command.clamped`; its work is booked in
    `energy/step_limit`.

    Args:
        inner: the controller whose torques are bounded.
        robot: for the torque limits.
        share: largest change per period, as a share of the joint's torque limit; joints without a limit are not
            bounded.

    Raises:
        ConfigError: the share is not above zero.
    """

    def __init__(self, inner: Controller[Any], robot: Robot, share: float) -> None:
        if not (math.isfinite(share) and share > 0.0):
            raise ConfigError(f"the torque step must be a share above zero of the torque limit, got {share}")
        self.inner = inner
        self.step_max: Array = share * robot.torque_limit
        self._limit: Array = robot.torque_limit

    def init(self, estimate: Estimate) -> StepLimitState:
        return StepLimitState(self.inner.init(estimate), estimate.q, np.zeros_like(estimate.q), 0.0)

    def step(self, estimate: Estimate, reference: Reference, state: StepLimitState) -> tuple[Command, StepLimitState]:
        command, inner = self.inner.step(estimate, reference, state.inner)
        sent = np.clip(np.nan_to_num(estimate.torque_sent, nan=0.0), -self._limit, self._limit)
        torque = np.minimum(np.maximum(command.torque, sent - self.step_max), sent + self.step_max)
        held_back = command.torque - torque
        energy = state.energy + float(state.held_back @ (estimate.q - state.q))
        diagnostics = _With(command.diagnostics, energy)
        bounded = Command(command.time, torque, command.clamped + held_back, diagnostics)
        return bounded, StepLimitState(inner, estimate.q, held_back, energy)


class _With(Mapping[str, "float | Array"]):
    """The inner controller's channels and one more, without copying them."""

    __slots__ = ("_energy", "_inner")

    def __init__(self, inner: Mapping[str, float | Array], energy: float) -> None:
        self._inner, self._energy = inner, energy

    def __getitem__(self, name: str) -> float | Array:
        return self._energy if name == "energy/step_limit" else self._inner[name]

    def __iter__(self) -> Iterator[str]:
        yield from self._inner
        yield "energy/step_limit"

    def __len__(self) -> int:
        return len(self._inner) + 1
