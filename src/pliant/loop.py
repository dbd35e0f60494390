"""The whole control loop on one screen."""

from __future__ import annotations

import time
import traceback
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from pliant.blocks import Blocks, Ran, Standing
from pliant.errors import ConfigError, PliantError, RobotError, RunFailedError, ShapeError, told
from pliant.guard import Fault, Guard
from pliant.guard.border import Watched
from pliant.interfaces import Controller, Estimator, Observer, Plant, ReferenceSource
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Measurement, Reference, Tick

_Signal = TypeVar("_Signal")
_WHATEVER = (Exception, SystemExit, GeneratorExit)
"""what ends a run; Ctrl-C passes through"""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a run ended."""

    ticks: int
    """periods that were completed"""
    time: float
    """s of robot time"""
    failure: str | None = None
    """why it stopped early; None if it ran to its end"""


def run(
    plant: Plant[Any],
    estimator: Estimator[Any],
    source: ReferenceSource[Any],
    controller: Controller[Any],
    clock: Iterable[object],
    observers: Sequence[Observer] = (),
    robot: Robot | None = None,
) -> Outcome:
    """Runs a control loop until the clock ends, or until something fails.

    Args:
        plant: the robot in its world.
        estimator: measurement → estimate.
        source: estimate → reference.
        controller: estimate and reference → command.
        clock: one item per period; `range(n)` runs n periods as fast as they go.
        observers: called once a period with a `Tick`; telemetry and the live page attach here and nowhere else.
        robot: whose torque limits and gravity the guard knows; None: it cuts off nothing, and holds the last torque
            where it would compensate gravity.

    Returns:
        How many periods were completed, and why it stopped early if it did. `Guard` keeps signals that are not sound
        from the parts, and what they return from the robot. An exception of a part ends the run in order: the robot
        was sent a sound torque last, and everything observed until then is kept.

    Raises:
        ConfigError, ShapeError, RobotError: parts that do not fit together, in the first tick. What an observer raises
            passes through.
    """
    guard = Guard(plant, robot)
    measurement, world = plant.init()
    cycle = _Cycle(guard, estimator, source, controller)
    blocks = Blocks(plant, estimator, source, controller, observers, guard.bound)
    ticks, periods = 0, iter(clock)
    for _ in periods:
        try:
            estimate, reference, command, wall, fault = cycle.step(measurement)
            seen = guard.shown(fault, measurement, cycle.watched) if fault else measurement
            tick = Tick(seen, estimate, reference, command, plant.truth(world), wall, int(fault))
        except _WHATEVER as error:  # that a part raises: the run ends in order
            if cycle.command is None and isinstance(error, ConfigError | ShapeError | RobotError):
                raise  # parts that do not fit together: nothing has run
            return _ended(ticks, cycle.now, error)
        for observe in observers:
            observe(tick)  # an observer's error is its own: a full disk is not the robot's failure
        try:
            measurement, world = _pair(plant.step(command, world), "plant")
        except _WHATEVER as error:
            return _ended(ticks, cycle.now, error)
        ticks += 1
        while blocks.possible and (ran := blocks.run(cycle.standing(measurement, world), periods)):
            ticks, measurement = ticks + ran.ticks, ran.at.measurement
            cycle.take(ran)
            blocks.show(ran)
            if stopped := _stopped(ran, ticks - 1, cycle.now):
                return stopped
    return Outcome(ticks, measurement.time)


class _Cycle:
    """From a measurement to a command: the guarded parts, with their states and their last valid signals."""

    def __init__(
        self, guard: Guard, estimator: Estimator[Any], source: ReferenceSource[Any], controller: Controller[Any]
    ) -> None:
        self._guard, self._estimator, self._source, self._controller = guard, estimator, source, controller
        self._est: Any = None
        self._ref: Any = None
        self._ctl: Any = None
        self._estimate: Estimate | None = None
        self._reference: Reference | None = None
        self._watched: Watched | None = None
        self.command: Command | None = None
        """None before the first command"""
        self.now = 0.0
        """s, time of the last measurement"""

    @property
    def watched(self) -> Watched:
        """State of the guard, from the first measurement on."""
        assert self._watched is not None
        return self._watched

    def standing(self, measurement: Measurement, world: Any) -> Standing | None:
        """Where the loop stands before a measurement's tick, after the first one. None: a sensor reads the same
        again."""
        if not self._guard.fresh(measurement, self.watched):
            return None
        assert self._estimate is not None
        assert self._reference is not None
        assert self.command is not None
        states = (self._est, self._ref, self._ctl)
        return Standing(measurement, world, self._estimate, self._reference, self.command, states)

    def take(self, ran: Ran) -> None:
        """Goes on after a block of ticks."""
        at = ran.at
        self._estimate, self._reference, self.command = at.estimate, at.reference, at.command
        self._est, self._ref, self._ctl = at.states
        self.now = ran.reading.time
        self._guard.passed(ran.reading, at.command.torque, self.watched)

    def step(self, measurement: Measurement) -> tuple[Estimate, Reference, Command, dict[str, float], Fault]:
        """The signals of a tick, the wall time of its stages in s, and its fault. Raises what a part raises."""
        start = planned = time.perf_counter()
        guard, fresh = self._guard, self.command is None  # the first tick: every part starts
        watched = self._watched = self._watched or guard.init(measurement)
        fault = guard.measurement(measurement, watched)
        self.now = guard.now(measurement, watched)
        if not fault:
            est = self._estimator.init(measurement) if fresh else self._est
            found, self._est = _pair(self._estimator.step(measurement, est), "estimator")
            fault = guard.estimate(found, watched)
            self._estimate = self._estimate if fault else found
        if not fault and (estimate := self._estimate) is not None:
            ref = self._source.init(estimate) if fresh else self._ref
            wanted, self._ref = _pair(self._source.step(estimate, ref), "source")
            fault = guard.reference(wanted, watched)
            self._reference = self._reference if fault else wanted
        if not fault and (estimate := self._estimate) is not None and (reference := self._reference) is not None:
            ctl = self._controller.init(estimate) if fresh else self._ctl
            planned = time.perf_counter()
            answer, self._ctl = _pair(self._controller.step(estimate, reference, ctl), "controller")
            answer, fault = guard.command(answer, watched)
            self.command = self.command if fault is Fault.COMMAND else answer
        if self._estimate is None or self._reference is None or self.command is None:
            raise guard.why_not(fault, watched)
        self.command = guard.settled(self.command, fault, measurement, watched)
        wall = {"plan": planned - start, "control": time.perf_counter() - planned}
        return self._estimate, self._reference, self.command, wall, fault


def _pair(answer: tuple[_Signal, Any], part: str) -> tuple[_Signal, Any]:
    if isinstance(answer, tuple) and len(answer) == 2:  # pyright: ignore[reportUnnecessaryIsInstance, reportUnnecessaryComparison] (somebody's own part)
        return answer
    raise ConfigError(f"the {part}'s step must return two things, its signal and its next state, got {answer!r:.80}")


def _stopped(ran: Ran, ticks: int, now: float) -> Outcome | None:
    """How the run ended if the plant stopped in the last period of a block; None: it did not."""
    try:
        ran.land()
    except _WHATEVER as error:
        return _ended(ticks, now, error)
    return None


def _ended(ticks: int, now: float, error: BaseException) -> Outcome:
    if not isinstance(error, PliantError):
        where = traceback.extract_tb(error.__traceback__)[-1]
        name, _, text = told(error).partition(": ")
        error = RunFailedError(f"{name} in {Path(where.filename).name}, line {where.lineno}: {text}".removesuffix(": "))
    return Outcome(ticks, now, f"{error} at t = {now:.4f} s")
