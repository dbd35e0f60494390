"""The parts of a control loop. Each has `init` and `step`; state goes in and comes out, no part hides any.

A state may own buffers that `step` reuses: the state passed in is consumed, keep only the one that comes out.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Generic, Literal, Protocol, TypeVar

from pliant.signals import Command, Estimate, Measurement, Reference, Tick, Truth
from pliant.spatial import Array

State = TypeVar("State")

Compensation = Literal["none", "gravity", "gravity+coriolis"]
"""what a robot's own controller adds, invisibly, to the torque that is sent"""


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
