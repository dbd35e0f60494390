"""The whole control loop on one screen."""

from __future__ import annotations

import time
import traceback
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from pliant.errors import ConfigError, PliantError, RobotError, RunFailedError, ShapeError, told
from pliant.guard import Fault, Guard
from pliant.interfaces import Controller, Estimator, Observer, Plant, ReferenceSource
from pliant.robot import Robot
from pliant.signals import Tick

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
    est = ref = ctl = estimate = reference = command = watched = None
    ticks, now = 0, 0.0
    for _ in clock:
        start = planned = time.perf_counter()
        fresh = command is None  # the first tick: every part starts
        try:
            watched = watched or guard.init(measurement)
            fault = guard.measurement(measurement, watched)
            now = guard.now(measurement, watched)
            if not fault:
                est = estimator.init(measurement) if fresh else est
                found, est = _pair(estimator.step(measurement, est), "estimator")
                fault = guard.estimate(found, watched)
                estimate = estimate if fault else found
            if not fault and estimate is not None:
                ref = source.init(estimate) if fresh else ref
                wanted, ref = _pair(source.step(estimate, ref), "source")
                fault = guard.reference(wanted, watched)
                reference = reference if fault else wanted
            if not fault and estimate is not None and reference is not None:
                ctl = controller.init(estimate) if fresh else ctl
                planned = time.perf_counter()
                answer, ctl = _pair(controller.step(estimate, reference, ctl), "controller")
                answer, fault = guard.command(answer, watched)
                command = command if fault is Fault.COMMAND else answer
            if estimate is None or reference is None or command is None:
                raise guard.why_not(fault, watched)
            command = guard.settled(command, fault, measurement, watched)
            wall = {"plan": planned - start, "control": time.perf_counter() - planned}
            tick = Tick(
                guard.shown(fault, measurement, watched),
                estimate,
                reference,
                command,
                plant.truth(world),
                wall,
                int(fault),
            )
        except _WHATEVER as error:  # that a part raises: the run ends in order
            if command is None and isinstance(error, ConfigError | ShapeError | RobotError):
                raise  # parts that do not fit together: nothing has run
            return _ended(ticks, now, error)
        for observe in observers:
            observe(tick)  # an observer's error is its own: a full disk is not the robot's failure
        try:
            measurement, world = _pair(plant.step(command, world), "plant")
        except _WHATEVER as error:
            return _ended(ticks, now, error)
        ticks += 1
    return Outcome(ticks, measurement.time)


def _pair(answer: tuple[_Signal, Any], part: str) -> tuple[_Signal, Any]:
    if isinstance(answer, tuple) and len(answer) == 2:  # pyright: ignore[reportUnnecessaryIsInstance, reportUnnecessaryComparison] (somebody's own part)
        return answer
    raise ConfigError(f"the {part}'s step must return two things, its signal and its next state, got {answer!r:.80}")


def _ended(ticks: int, now: float, error: BaseException) -> Outcome:
    if not isinstance(error, PliantError):
        where = traceback.extract_tb(error.__traceback__)[-1]
        name, _, text = told(error).partition(": ")
        error = RunFailedError(f"{name} in {Path(where.filename).name}, line {where.lineno}: {text}".removesuffix(": "))
    return Outcome(ticks, now, f"{error} at t = {now:.4f} s")
