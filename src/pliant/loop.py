"""The whole control loop on one screen."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from pliant.errors import RunFailedError, SignalError
from pliant.interfaces import Controller, Estimator, Observer, Plant, ReferenceSource
from pliant.signals import Measurement, Tick
from pliant.spatial import all_finite


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
) -> Outcome:
    """Runs a control loop until the clock ends, or until a signal is not finite.

    Args:
        plant: the robot in its world.
        estimator: measurement → estimate.
        source: estimate → reference.
        controller: estimate and reference → command.
        clock: one item per period; `range(n)` runs n periods as fast as they go.
        observers: called once a period with a `Tick`; telemetry and the live page attach here and nowhere else.

    Returns:
        How many periods were completed, and why it stopped early if it did. A plant that fails stops the run, and so
        does a measurement that is not finite, before a command is computed from it: the last torque sent is a safe one
        and everything recorded is kept.
    """
    measurement, world = plant.init()
    est = ref = ctl = None
    ticks = 0
    for _ in clock:
        if not _is_finite(measurement):
            return Outcome(ticks, measurement.time, f"a measurement was not finite at t = {measurement.time:.4f} s")
        start = time.perf_counter()
        try:
            est = estimator.init(measurement) if ticks == 0 else est
            estimate, est = estimator.step(measurement, est)
            ref = source.init(estimate) if ticks == 0 else ref
            reference, ref = source.step(estimate, ref)
            ctl = controller.init(estimate) if ticks == 0 else ctl
            planned = time.perf_counter()
            command, ctl = controller.step(estimate, reference, ctl)
        except SignalError as error:
            return Outcome(ticks, measurement.time, f"{error} at t = {measurement.time:.4f} s")
        wall = {"plan": planned - start, "control": time.perf_counter() - planned}
        tick = Tick(measurement, estimate, reference, command, plant.truth(world), wall)
        for observe in observers:
            observe(tick)
        try:
            measurement, world = plant.step(command, world)
        except RunFailedError as error:
            return Outcome(ticks, measurement.time, f"{error} at t = {measurement.time:.4f} s")
        ticks += 1
    return Outcome(ticks, measurement.time)


def _is_finite(measurement: Measurement) -> bool:
    return all_finite(measurement.q, measurement.v, measurement.torque, *measurement.wrenches.values())
