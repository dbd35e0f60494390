"""The parts of a control loop. Each has `init` and `step`; state goes in and comes out, no part hides any.

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
"""what a robot's own controller adds, invisibly, to the torque that is sent"""


class HasUnit(Protocol):
    """Describes a diagnostic."""

    @property
    def unit(self) -> str:
        """SI; where linear and angular parts share a vector: both, with a comma"""
        ...


@dataclass(frozen=True)
class ChannelUnit:
    """A diagnostic of which the unit is all there is to say."""

    unit: str


@dataclass(frozen=True)
class Lookahead:
    """Instants of a preview."""

    nodes: int
    """N: there are N + 1 instants"""
    step: float
    """s between them"""
    lead: float = 0.0
    """s from now to the first of them: commands that take effect later want later references"""
    every: float = 0.0
    """s between two looks, the first in the first tick; in between a source may leave the preview out. 0: in every
    tick"""

    def due(self, time: float, next_look: float) -> bool:
        """Whether a look falls on a time in s, when the next one was expected at `next_look`."""
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
    """What a controller wants to be told, beyond joint positions and velocities and its tasks' references.

    Whoever wires a loop builds estimators and preview from it; no task and no study knows what a controller wants.
    """

    preview: Lookahead | None = None
    """the reference at later instants; None: the present one is enough"""
    wrench: bool = False
    """the contact wrench at the frame that presses"""
    disturbance: Literal["none", "normal", "all"] = "none"
    """the joint torque that the model does not explain, and how much of a contact's wrench the model explains"""
    environment: bool = False
    """stiffness and damping of what the frame touches"""
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
        """The same for people."""
        names = ("preview", "wrench", "environment", "torque", "posture")
        wanted = (self.preview is not None, self.wrench, self.environment, self.torque, self.posture)
        found = [name for name, wants in zip(names, wanted, strict=True) if wants]
        if self.disturbance != "none":
            found.append("disturbance")
        return (*found, "calm positions") if self.calm else tuple(found)


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
    """Says where the robot should be and how hard it should press."""

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
        """What it wants to be told; by default nothing special."""
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
        """Told by a layer outside that a part (n,) N·m of the last torque was not sent. Returns the next state.

        Most controllers do not care; those that book their energy do.
        """
        return state


class Plant(ABC, Generic[State]):
    """A robot in its world, simulated or real."""

    period: float
    """control period, s"""

    @property
    def noisy(self) -> frozenset[str]:
        """Fields of `Measurement` whose noise says that no two readings are equal."""
        return frozenset()

    @property
    def compensates(self) -> Compensation:
        """What the robot adds to the torque that is sent, by itself."""
        return "none"

    @abstractmethod
    def init(self) -> tuple[Measurement, State]:
        """The first measurement, and the world before the first step."""

    @abstractmethod
    def step(self, command: Command, world: State) -> tuple[Measurement, State]:
        """Holds the command for one period. Returns the measurement at its end, and the world."""

    def truth(self, world: State) -> Truth | None:
        """What really happens, for metrics and pictures; None on a real robot."""
        return None


class Observer(Protocol):
    """Something that watches the loop (a recorder, a page, a progress bar) and cannot change it."""

    def __call__(self, tick: Tick) -> None:
        """Called once a period, after the command was computed and before the plant moves."""
        ...
