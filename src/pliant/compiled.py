"""Compiled faces of the parts of a loop: with them it runs blocks of ticks without Python (`pliant.blocks`).

All numbers of a tick lie in one row. A face says how many of them belong to its part, makes signals of them, which are
views of the row, and gives the compiled part that reads and writes them. It holds while the signals keep their
structure.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import FunctionType
from typing import Any, Protocol, TypeVar

from pliant._loop import Part, World
from pliant.signals import Command, Estimate, Measurement, Reference, Tick, Truth
from pliant.spatial import Array

_Face = TypeVar("_Face")
_HARMLESS = frozenset(("__init__", "__doc__", "__module__", "__abstractmethods__"))
"""what a subclass may have of its own"""


def face_of(part: object, kind: type[_Face], *given: object) -> _Face | None:
    """What the `compiled_face` of a part returns; None: it has none, or a subclass or the object itself has another
    method in place of one of that class, or the class has one of another module, which the compiled code does not know.

    Args:
        part: of a loop.
        kind: of the face.
        given: arguments.
    """
    method = unchanged(part, "compiled_face")
    face = None if method is None else method(*given)
    return face if isinstance(face, kind) else None


def unchanged(part: object, name: str) -> Callable[..., Any] | None:
    """A method of a part; None if there is none, or if something was put in place of any method of its class, in it, in
    a subclass or in the object."""
    kinds = type(part).__mro__
    owner = next((place for place, kind in enumerate(kinds) if name in vars(kind)), None)
    if owner is None:
        return None
    if any(_is_of_another_module(value, kind) for kind in kinds[owner:-1] for value in vars(kind).values()):
        return None
    known = {key for kind in kinds[owner:-1] for key, value in vars(kind).items() if _is_method(value)}
    own = {key for kind in kinds[:owner] for key in vars(kind)} | getattr(part, "__dict__", {}).keys()
    found = None if own & known - _HARMLESS else getattr(part, name)
    return found if callable(found) else None


def _is_of_another_module(value: object, kind: type) -> bool:
    """Whether something in a class is a function that was written elsewhere."""
    function = value.fget if isinstance(value, property) else getattr(value, "__func__", value)
    return isinstance(function, FunctionType) and function.__module__ != kind.__module__


def _is_method(value: object) -> bool:
    return callable(value) or isinstance(value, property | staticmethod | classmethod)


def place_of(part: Array, row: Array) -> int | None:
    """Where the numbers of an array begin in a row that they are a view of; None: they lie elsewhere, or not side by
    side."""
    begin, size = _address(part) - _address(row), part.size * 8
    inside = begin >= 0 and begin + size <= row.size * 8
    return begin // 8 if inside and part.flags.c_contiguous and part.dtype == row.dtype else None


def _address(array: Array) -> int:
    return array.__array_interface__["data"][0]


@dataclass(frozen=True)
class Sample:
    """Signals made of views of a row, by which a part finds what it reads."""

    row: Array
    estimate: Estimate
    reference: Reference
    contacts: Mapping[str, int]
    """frame → where the row says whether it touches"""
    environments: Mapping[str, int]
    """frame → where the row has stiffness, damping and their uncertainties"""
    ahead: int
    """where the row says whether there is a preview; -1: there is none"""
    names: tuple[tuple[str, ...], int]
    """names of phases, and where the row has the numbers of those of a preview"""


class CompiledPlant(ABC):
    """A simulated robot in one world. `size`: numbers of a measurement; `truth_size`: of what is true."""

    size: int
    truth_size: int

    @abstractmethod
    def numbers(self, measurement: Measurement) -> Array:
        """(size,) a measurement of this world as numbers."""

    @abstractmethod
    def measurement(self, time: float, numbers: Array) -> Measurement:
        """A measurement at a time in s."""

    @abstractmethod
    def truth(self, time: float, numbers: Array, truth: Array) -> Truth:
        """What is true. Args: time, s; numbers (size,) of the measurement; truth (truth_size,)."""

    @abstractmethod
    def world(self, torque: int, begin: int) -> World:
        """The compiled world. Its time is the first number of the row.

        Args:
            torque: where the command's torque begins in the row.
            begin: where the numbers of the measurement begin, then those of the truth.
        """

    @abstractmethod
    def begin(self, ticks: int) -> Array:
        """A block begins. Returns the times (ticks,) in s at which the world is measured; the first is now."""

    @abstractmethod
    def passed(self, periods: int, numbers: Array) -> None:
        """Writes a block into the world. Args: periods that it had; numbers (size,) after the last, which are kept.

        Raises:
            RunFailedError: the robot stopped in the last period.
        """


class CompiledEstimator(ABC):
    """An estimator with its state as numbers. `size`: of its estimate."""

    size: int

    @abstractmethod
    def estimate(self, measurement: Measurement, numbers: Array) -> Estimate:
        """The estimate (size,) of a measurement."""

    @abstractmethod
    def fits(self, estimate: Estimate) -> bool:
        """Whether an estimate is made as these are."""

    @abstractmethod
    def contacts(self, begin: int) -> Mapping[str, int]:
        """Frame → where the row says whether it touches. Args: where its own numbers begin."""

    @abstractmethod
    def environments(self, begin: int) -> Mapping[str, int]:
        """Frame → where the row has four numbers of its environment: what is known, or not, in every tick."""

    @abstractmethod
    def part(self, measurement: Measurement, row: Array, begin: int) -> Part | None:
        """The compiled part. Args: a measurement made of views of the row; where its own numbers begin. None: it cannot
        read such a measurement."""

    @abstractmethod
    def memory(self, state: Any) -> Array:
        """A state as numbers."""

    @abstractmethod
    def state(self, memory: Array, before: Any) -> Any:
        """A state from numbers that it may keep, and the state before the block."""


class CompiledController(ABC):
    """A controller with its state as numbers. `size`: of its command, with what it needs to find it."""

    size: int

    @abstractmethod
    def fits(self, reference: Reference, state: Any) -> bool:
        """Whether a reference is made as those are that the state has seen."""

    @abstractmethod
    def command(self, time: float, numbers: Array) -> Command:
        """The command (size,) at a time in s."""

    @abstractmethod
    def part(self, given: Sample, begin: int) -> Part | None:
        """The compiled part. Args: what it may read; where its own numbers begin. None: it cannot read such signals."""

    @abstractmethod
    def memory(self, state: Any) -> Array:
        """A state as numbers."""

    @abstractmethod
    def state(self, memory: Array, before: Any) -> Any:
        """A state from numbers that it may keep, and the state before the block."""


class KnownReferences(ABC):
    """References that are known before the robot moves. `size`: numbers of each.

    `compiled_face` of a source may return the one that it returned before while the structure is the same.
    """

    size: int
    ahead: int = -1
    """which of the numbers says whether there is a preview; -1: there is none"""
    names: tuple[tuple[str, ...], int] = ((), 0)
    """names of phases, and where the numbers of those of a preview begin"""

    @abstractmethod
    def reference(self, time: float, numbers: Array) -> Reference:
        """The reference (size,) at a time in s."""

    @abstractmethod
    def fill(self, times: Array, rows: Array) -> int:
        """Writes the references at times in s into rows (k, size). Returns how many of them have the structure that
        `reference` gives them: the first that has not is left to Python."""

    def after(self, state: Any, ticks: int) -> Any:
        """The source's state after so many of the ticks that were filled in last. Args: state before them."""
        return state


@dataclass(frozen=True)
class Rows:
    """Ticks of a block, for observers."""

    numbers: Array
    """(k, size) a row for each tick; used again after the call"""
    tick: Callable[[Array], Tick]
    """a row (size,) → the tick, made of views of it; the same object for ticks of the same structure"""
    wall: Mapping[str, Array]
    """stage → (k,) s of wall time"""

    def first(self) -> Tick:
        """The first tick, with numbers of its own and its wall times."""
        tick = self.tick(self.numbers[0].copy())
        wall = {stage: float(times[0]) for stage, times in self.wall.items()}
        return Tick(tick.measurement, tick.estimate, tick.reference, tick.command, tick.truth, wall, tick.guard)


class BlockObserver(Protocol):
    """An observer that takes blocks of ticks."""

    def __call__(self, tick: Tick) -> None:
        """Called with a tick that was made in Python."""
        ...

    def take_block(self, rows: Rows) -> None:
        """Called with one or more ticks that were made without Python, instead of once with each."""
        ...
