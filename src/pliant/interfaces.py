"""The parts of a control loop. Each has `init` and `step`; state is passed in and returned, no part keeps any.

A state may own buffers that `step` reuses: the state passed in is consumed, keep only the one that comes out.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Generic, Literal, Protocol, TypeVar

from pliant.errors import ConfigError, options
from pliant.signals import Command, Estimate, Measurement, Reference, Tick, Truth
from pliant.spatial import Array

State = TypeVar("State")

CLOCK_ROUNDING = 1e-9
"""s; smaller than any period, larger than the rounding of a clock"""

Compensation = Literal["none", "gravity", "gravity+coriolis"]
"""what a robot's own controller adds to the torque that is sent, without reporting it"""


class HasUnit(Protocol):
    """Unit and labels of a diagnostic channel."""

    @property
    def unit(self) -> str:
        """SI; where linear and angular parts share a vector: both, with a comma"""
        ...


@dataclass(frozen=True)
class ChannelUnit:
    """A diagnostic channel that has a unit only."""

    unit: str


@dataclass(frozen=True)
class Lookahead:
    """Instants of a preview."""

    nodes: int
    """N: there are N + 1 instants"""
    step: float
    """s between them"""
    lead: float = 0.0
    """s from now to the first of them; a command that takes effect later needs later references"""
    every: float = 0.0
    """s between two previews, the first in the first tick; in between a source may leave it out. 0: in every tick"""

    def due(self, time: float, next_look: float) -> bool:
        """Whether a preview is due at a time in s, if the next one is planned for `next_look`."""
        turned_back = time < next_look - self.every - CLOCK_ROUNDING
        return turned_back or time >= next_look - CLOCK_ROUNDING

    def __post_init__(self) -> None:
        if not (self.nodes >= 1 and 0.0 < self.step < math.inf and 0.0 <= self.lead < math.inf):
            raise ConfigError(
                "a preview takes 1 node or more, a step above zero and a lead of zero or more (s), got"
                f" {self.nodes}, {self.step} and {self.lead}"
            )


@dataclass(frozen=True)
class Needs:
    """Signals that a controller needs, beyond joint positions and velocities and the references of its tasks.

    `wiring` builds estimators and preview from it; tasks and studies need not know the controller.
    """

    preview: Lookahead | None = None
    """instants of the reference in the future; None: only the present one"""
    wrench: bool = False
    """the contact wrench at the frame that presses"""
    disturbance: Literal["none", "normal", "all"] = "none"
    """estimated joint disturbance torque; the value says which part of a contact wrench the model explains"""
    environment: bool = False
    """estimated stiffness and damping of the contact"""
    calm: bool = False
    """joint positions without white noise"""
    torque: bool = False
    """the measured joint torques"""
    posture: bool = False
    """a joint configuration that goes with the task"""

    def __post_init__(self) -> None:
        preview: Any = self.preview
        if not isinstance(preview, Lookahead | None):
            raise ConfigError(f"Needs.preview takes a Lookahead(nodes, step) or None, got {preview!r}")
        if self.disturbance not in ("none", "normal", "all"):
            raise ConfigError(f"Needs.disturbance: {options(['none', 'normal', 'all'], str(self.disturbance))}")

    def words(self) -> tuple[str, ...]:
        """The same as text."""
        names = ("preview", "wrench", "environment", "torque", "posture")
        wanted = (self.preview is not None, self.wrench, self.environment, self.torque, self.posture)
        found = [name for name, wants in zip(names, wanted, strict=True) if wants]
        if self.disturbance != "none":
            found.append("disturbance")
        return (*found, "joint positions without noise") if self.calm else tuple(found)


_NO_CHANNELS: Mapping[str, HasUnit] = MappingProxyType({})


class Estimator(ABC, Generic[State]):
    """Turns measurements into estimates."""

    @abstractmethod
    def init(self, measurement: Measurement) -> State:
        """State before the first step."""

    @abstractmethod
    def step(self, measurement: Measurement, state: State) -> tuple[Estimate, State]:
        """The estimate at the time of the measurement, and the next state."""


class ReferenceSource(ABC, Generic[State]):
    """Gives the reference: where the robot should be and how hard it should press."""

    @abstractmethod
    def init(self, estimate: Estimate) -> State:
        """State before the first step; most sources start where the robot is."""

    @abstractmethod
    def step(self, estimate: Estimate, state: State) -> tuple[Reference, State]:
        """The reference at the time of the estimate, and the next state."""


class Controller(ABC, Generic[State]):
    """Turns estimates and references into torques. A controller never sees the simulator."""

    @property
    def needs(self) -> Needs:
        """Signals that it needs; by default none beyond positions and velocities."""
        return Needs()

    @property
    def channels(self) -> Mapping[str, HasUnit]:
        """Name → unit of every channel in `Command.diagnostics`; a channel that is not named is logged without one."""
        return _NO_CHANNELS

    @property
    def regulates_force(self) -> bool:
        """Whether it drives the contact force to the reference's `wrench`."""
        return False

    @abstractmethod
    def init(self, estimate: Estimate) -> State:
        """State before the first step."""

    @abstractmethod
    def step(self, estimate: Estimate, reference: Reference, state: State) -> tuple[Command, State]:
        """The command for the next period, and the next state.

        The torque is finite and within the robot's limits; `Command.clamped` holds what the limits took away.
        """

    def kept_back(self, state: State, torque: Array) -> State:
        """Called by an outer wrapper if a part (n,) N·m of the last torque was not sent. Returns the next state.

        Controllers that account for their energy override it.
        """
        return state


class Plant(ABC, Generic[State]):
    """A robot in its world, simulated or real."""

    period: float
    """control period, s"""

    @property
    def noisy(self) -> frozenset[str]:
        """Fields of `Measurement` with noise, so that no two readings are equal."""
        return frozenset()

    @property
    def compensates(self) -> Compensation:
        """What the robot's own controller adds to the torque that is sent."""
        return "none"

    @abstractmethod
    def init(self) -> tuple[Measurement, State]:
        """The first measurement, and the world before the first step."""

    @abstractmethod
    def step(self, command: Command, world: State) -> tuple[Measurement, State]:
        """Holds the command for one period. Returns the measurement at its end, and the world."""

    def truth(self, world: State) -> Truth | None:
        """The true state, for metrics and figures; None on a real robot."""
        return None


class Observer(Protocol):
    """Something that watches the loop (a recorder, a page, a progress bar) and cannot change it."""

    def __call__(self, tick: Tick) -> None:
        """Called once a period, after the command was computed and before the plant moves."""
        ...
