"""A plant that ends a run when a limit is exceeded."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pliant.errors import ConfigError, RunFailedError
from pliant.interfaces import Compensation, Plant
from pliant.signals import Command, Measurement, Truth
from pliant.spatial import Array


@dataclass(frozen=True)
class RunLimits:
    """Limits of the true motion and force of one frame and its robot.

    Raises:
        ConfigError: on construction, when a bound is not above zero or a workspace is empty.
    """

    frame: str
    force: float = math.inf
    """N, of the contact"""
    speed: float = math.inf
    """m/s, mean of a period"""
    torque: float = math.inf
    """share of each joint's limit"""
    lower: tuple[float, float, float] = (-math.inf, -math.inf, -math.inf)
    """m, of its place"""
    upper: tuple[float, float, float] = (math.inf, math.inf, math.inf)
    """m"""

    def __post_init__(self) -> None:
        for name in ("force", "speed", "torque"):
            if not getattr(self, name) > 0.0:
                raise ConfigError(f"limits.{name} must be above zero, got {getattr(self, name)}")
        if not all(low < high for low, high in zip(self.lower, self.upper, strict=True)):
            raise ConfigError(f"limits.workspace is empty: lower {list(self.lower)}, upper {list(self.upper)} m")

    def outside(self, place: Array) -> bool:
        """Whether a place (3,) m is out of the workspace."""
        inside = [low <= x <= high for low, x, high in zip(self.lower, place.tolist(), self.upper, strict=True)]
        return not all(inside)

    def broken(self, truth: Truth, before: Array | None, period: float, torque_limit: Array) -> str:
        """The limit that is exceeded, with the value, in a few words; empty: none. Args: before: (3,) m, place a period
        ago."""
        place = truth.positions[self.frame]
        wrench = truth.wrenches.get(self.frame)
        force = 0.0 if wrench is None else math.sqrt(wrench[:3].dot(wrench[:3]))
        speed = 0.0 if before is None else math.dist(place, before) / period
        share = float(np.max(np.abs(truth.torque) / torque_limit))
        for name, value, bound, unit in (
            ("force", force, self.force, "N"),
            ("speed", speed, self.speed, "m/s"),
            ("torque", share, self.torque, "of a joint's limit"),
        ):
            if value > bound:
                return f"limits.{name} was exceeded: {value:.3g} {unit}, {bound:g} is allowed"
        if self.outside(place):
            x, y, z = place
            return f"limits.workspace was left: the frame {self.frame!r} was at ({x:.3f}, {y:.3f}, {z:.3f}) m"
        return ""


class LimitedState(NamedTuple):
    """The world inside, and what really happens in it."""

    inner: Any
    truth: Truth | None
    """None: nobody has asked yet, or the world has none"""


class LimitedPlant(Plant[LimitedState]):
    """A wrapper of a plant; a step that exceeds a limit raises `RunFailedError`.

    Args:
        inner: a simulated one, which observes the frame.
        limits: see there.
        torque_limit: (n,) N·m.
    """

    def __init__(self, inner: Plant[Any], limits: RunLimits, torque_limit: Array) -> None:
        self.inner, self.limits, self._torque_limit, self.period = inner, limits, torque_limit, inner.period

    @property
    def noisy(self) -> frozenset[str]:
        return self.inner.noisy

    @property
    def compensates(self) -> Compensation:
        return self.inner.compensates

    def init(self) -> tuple[Measurement, LimitedState]:
        measurement, world = self.inner.init()
        return measurement, LimitedState(world, None)

    def step(self, command: Command, world: LimitedState) -> tuple[Measurement, LimitedState]:
        measurement, inner = self.inner.step(command, world.inner)
        truth = self.inner.truth(inner)
        if truth is not None:
            before = None if world.truth is None else world.truth.positions[self.limits.frame]
            said = self.limits.broken(truth, before, self.period, self._torque_limit)
            if said:
                raise RunFailedError(said)
        return measurement, LimitedState(inner, truth)

    def truth(self, world: LimitedState) -> Truth | None:
        return self.inner.truth(world.inner) if world.truth is None else world.truth
