"""The compiled face of an imperfect robot round a simulated one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant._plant import ImperfectRobot, ImperfectWorld
from pliant.compiled import CompiledPlant
from pliant.signals import Measurement, Truth
from pliant.simulation.compiled_robot import CompiledRobot
from pliant.spatial import Array


@dataclass(frozen=True)
class Rates:
    """How many in a control period."""

    corrections: int
    """of the torque loop"""
    steps: int
    """of the robot inside in each of them"""


class CompiledImperfectRobot(CompiledPlant):
    """One world of an `ImperfectPlant`. Its numbers are a reading, then those of the robot inside.

    Args:
        chain: what is imperfect, compiled.
        inner: the face of the robot inside.
        world: consumed.
        rates: of corrections and steps.
        sensors: frames of the force sensors.
        reading: time in s and numbers → measurement.
    """

    def __init__(
        self,
        chain: ImperfectRobot,
        inner: CompiledRobot,
        world: Any,
        rates: Rates,
        sensors: tuple[str, ...],
        reading: Callable[[float, Array], Measurement],
    ) -> None:
        self._chain, self._inner, self._world, self._rates = chain, inner, world, rates
        self._sensors, self._reading, self._split = sensors, reading, chain.reading_size
        self.size, self.truth_size = self._split + inner.size, inner.truth_size
        self._made: ImperfectWorld | None = None

    def numbers(self, measurement: Measurement) -> Array:
        m = measurement
        felt = [m.wrenches[frame] for frame in self._sensors]
        return np.concatenate([m.q, m.v, m.torque, m.torque_sent, *felt, self._inner.touched()])

    def measurement(self, time: float, numbers: Array) -> Measurement:
        return self._reading(time, numbers)

    def truth(self, time: float, numbers: Array, truth: Array) -> Truth:
        return self._inner.truth(time, numbers[self._split :], truth)

    def world(self, torque: int, begin: int) -> ImperfectWorld:
        places = (0, torque, begin, begin + self.size)
        self._made = ImperfectWorld(self._chain, *self._inner.cores, places, self._world.memory)
        return self._made

    def begin(self, ticks: int) -> Array:
        assert self._made is not None
        count = self._rates.corrections
        self._made.draw(np.ascontiguousarray(self._world.draws.ahead(ticks * count)).ravel())
        return self._inner.start(self._made, ticks, count * self._rates.steps)

    def passed(self, periods: int, numbers: Array) -> None:
        assert self._made is not None
        count = periods * self._rates.corrections
        self._world.draws.pass_by(count)
        self._world.time = self._inner.land(self._made, count * self._rates.steps, numbers[self._split :])
