"""The compiled face of a simulated robot."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np

from pliant._plant import Physics, SimulatedRobot, TruthRow
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
        numbers, n, read = self.touched(), self._compiled.n, self._compiled.readings
        numbers[: 3 * n] = np.concatenate([measurement.q, measurement.v, measurement.torque_sent])
        for frame, reading in read(numbers).items():
            reading[:] = measurement.wrenches[frame]
        return numbers

    def measurement(self, time: float, numbers: Array) -> Measurement:
        q, v, torque = self._compiled.signals(numbers)
        return Measurement(time, q, v, torque, torque, self._compiled.readings(numbers))

    def truth(self, time: float, numbers: Array, truth: Array) -> Truth:
        return self._truth.of(truth, time, self._compiled.wrenches(numbers))

    def world(self, torque: int, begin: int) -> SimulatedRobot:
        self._robot = SimulatedRobot(*self.cores, (0, torque, begin, begin + self.size))
        return self._robot

    def begin(self, ticks: int) -> Array:
        assert self._robot is not None
        return self.start(self._robot, ticks, 1)

    def passed(self, periods: int, numbers: Array) -> None:
        assert self._robot is not None
        self.land(self._robot, periods, numbers)

    # ------------------------------------------------------------------ for what is round it

    @property
    def cores(self) -> tuple[Physics, TruthRow, mujoco.MjData, float]:
        """What a compiled world is made of: robot, truth, data, period in s."""
        return self._compiled.core, self._core, self._world.data, self._period

    def touched(self) -> Array:
        """(size,) the contacts of now; zeros elsewhere."""
        none = np.zeros(6)
        felt = [self._world.wrenches.get(frame, none) for frame in self._compiled.contacts]
        return np.concatenate([np.zeros(3 * self._compiled.n), *felt, np.zeros(6 * len(self._compiled.sensors))])

    def start(self, robot: SimulatedRobot, ticks: int, periods: int) -> Array:
        """`begin` of ticks with so many periods each."""
        begin = self._world.ticks
        robot.begin(begin, self._compiled.rows(self._world.pushes))
        return (begin + periods * np.arange(ticks, dtype=np.float64)) * self._period

    def land(self, robot: SimulatedRobot, periods: int, numbers: Array) -> float:
        """`passed`. Returns the world's time in s."""
        return self._passed(self._world, periods, numbers, robot.touching)
