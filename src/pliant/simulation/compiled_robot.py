"""The compiled face of a simulated robot."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pliant._plant import SimulatedRobot, TruthRow
from pliant.compiled import CompiledPlant
from pliant.signals import Measurement, Truth
from pliant.simulation.compiled_period import CompiledPeriod
from pliant.simulation.truth import TruthReader
from pliant.simulation.world import World
from pliant.spatial import Array


class CompiledRobot(CompiledPlant):
    """One world of a `MujocoPlant`.

    Args:
        compiled: its period.
        truth: reads what is true, compiled by `core`.
        world: consumed.
        period: s.
        passed: writes periods into the world, `MujocoPlant.passed`.
    """

    def __init__(
        self,
        compiled: CompiledPeriod,
        truth: TruthReader,
        core: TruthRow,
        world: World,
        period: float,
        passed: Callable[[World, int, Array, int], float],
    ) -> None:
        self._compiled, self._truth, self._core = compiled, truth, core
        self._world, self._period, self._passed = world, period, passed
        self.size, self.truth_size = compiled.size, core.size
        self._robot: SimulatedRobot | None = None

    def numbers(self, measurement: Measurement) -> Array:
        zero = np.zeros(6)
        felt = [self._world.wrenches.get(frame, zero) for frame in self._compiled.contacts]
        read = [measurement.wrenches[frame] for frame in self._compiled.sensors]
        return np.concatenate([measurement.q, measurement.v, measurement.torque_sent, *felt, *read])

    def measurement(self, time: float, numbers: Array) -> Measurement:
        q, v, torque = self._compiled.signals(numbers)
        return Measurement(time, q, v, torque, torque, self._compiled.readings(numbers))

    def truth(self, time: float, numbers: Array, truth: Array) -> Truth:
        return self._truth.of(truth, time, self._compiled.wrenches(numbers))

    def world(self, torque: int, begin: int) -> SimulatedRobot:
        places = (0, torque, begin, begin + self.size)
        self._robot = SimulatedRobot(self._compiled.core, self._core, self._world.data, self._period, places)
        return self._robot

    def begin(self, ticks: int) -> Array:
        assert self._robot is not None
        begin = self._world.ticks
        self._robot.begin(begin, self._compiled.rows(self._world.pushes))
        return np.arange(begin, begin + ticks, dtype=np.float64) * self._period

    def passed(self, periods: int, numbers: Array) -> None:
        assert self._robot is not None
        self._passed(self._world, periods, numbers, self._robot.touching)
