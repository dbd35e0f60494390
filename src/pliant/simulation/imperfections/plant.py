"""A plant with imperfections around a perfect one: delayed and noisy sensors, drives, gears and computation time.

command ─▶ computation delay ─▶ torque loop ─▶ actuation ─▶ plant ─▶ ripple ─▶ sensing ─▶ measurement
                                     ▲                                             │
                                     └───────────── measured torque ───────────────┘
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from pliant._values import Views
from pliant.compiled import face_of
from pliant.errors import ConfigError
from pliant.interfaces import Compensation, Plant
from pliant.named_rows import NamedRows
from pliant.sampling import whole_periods
from pliant.signals import Command, Measurement, Truth
from pliant.simulation.compiled_period import compiled_period_of
from pliant.simulation.compiled_robot import CompiledRobot
from pliant.simulation.imperfections.chain import Sizes, chain_of, drawn_once, draws_of, wrench_sources
from pliant.simulation.imperfections.compiled_robot import CompiledImperfectRobot, Rates
from pliant.simulation.imperfections.config import Imperfections
from pliant.simulation.imperfections.draws import Draws
from pliant.simulation.plant import MujocoPlant
from pliant.spatial import Array, as_vector


@dataclass(slots=True)
class ImperfectWorld:
    """State of the imperfect robot. Consumed by `step`."""

    inner: Any
    """state of the plant inside"""
    memory: Array
    """state of the chain, one row of numbers (cpp/plant/imperfect_robot.cpp)"""
    draws: Draws
    """its random numbers"""
    time: float
    """s, of the last reading"""


class ImperfectPlant(Plant[ImperfectWorld]):
    """Wraps a plant with perfect sensors and actuators.

    Three periods, each a whole multiple of the next: the control period, the torque loop's, and the inner plant's.
    Gears act at the inner plant's, sensors and delays at the torque loop's.

    Args:
        inner: the perfect plant. It receives the torque at the link side of the joints.
        config: what is imperfect.
        seed: of every random draw.
        period: control period, s; None: the torque loop's.
        holding_torque: (n,) N·m in effect until the first command arrives; None: what the inner plant says was sent
            before.

    Raises:
        ConfigError: periods or delays that are not whole multiples, or joint damping that the inner plant does not
            have. ShapeError: a value per joint that does not fit the robot.
    """

    def __init__(
        self,
        inner: Plant[Any],
        config: Imperfections,
        *,
        seed: int = 0,
        period: float | None = None,
        holding_torque: npt.ArrayLike | None = None,
    ) -> None:
        self.inner = inner
        self.config = config
        self.seed = seed
        tick = config.torque_loop.period
        self.period = tick if period is None else period
        self._ticks = whole_periods(self.period, tick, "the control period")
        self._inner_steps = whole_periods(tick, inner.period, "the torque loop's period")
        if self._ticks < 1 or self._inner_steps < 1:
            raise ConfigError("the control period and the torque loop's must be above zero")
        self._holding_torque = holding_torque
        whole_periods(config.computation_delay, tick, "computation delay")
        _check_damping(inner, config.joint_damping)

    @property
    def noisy(self) -> frozenset[str]:
        return self.config.sensing.noisy

    @property
    def compensates(self) -> Compensation:
        return self.inner.compensates

    def init(self) -> tuple[Measurement, ImperfectWorld]:
        """The first measurement, and the robot as it stands, holding itself with `holding_torque`."""
        true, inner = self.inner.init()
        n = true.q.shape[0]
        self._build(n, tuple(true.wrenches))
        held = true.torque_sent if self._holding_torque is None else self._holding_torque
        held = as_vector(held, n, "holding_torque")
        memory, out = np.empty(self._chain.memory_size), np.empty(self._chain.reading_size)
        draws = draws_of(self.config, self._sizes, self.seed)
        sources = ("sensing.q", "sensing.v", "sensing.torque", *wrench_sources(self._sizes.sensors))
        drawn = drawn_once(self.config, n, self.seed)
        now = self._row(true)
        now[2 * n : 3 * n] = held
        self._chain.init(memory, held, **drawn, now=now, draw=draws.single(sources), out=out)
        return self._reading(true.time, out), ImperfectWorld(inner, memory, draws, true.time)

    def step(self, command: Command, world: ImperfectWorld) -> tuple[Measurement, ImperfectWorld]:
        """One control period.

        `Measurement.torque_sent` is the torque asked of the drives, after the clamp: its mean over the period, since a
        command can take effect in the middle of one.
        """
        draws = world.draws.take(self._ticks)
        if self._period is None or not isinstance(self.inner, MujocoPlant):
            reading = self._in_python(command, draws, world)
        else:
            split = self._chain.reading_size
            reading = np.empty(split + self._period.size)
            robot, core, torque = world.inner, self._period.core, command.torque
            pushes = self._period.rows(robot.pushes)
            mask = self._chain.period(world.memory, draws, core, robot.data, torque, pushes, reading)
            world.time = self.inner.passed(robot, self._ticks * self._inner_steps, reading[split:], mask)
        return self._reading(world.time, reading), world

    def compiled_face(self, world: ImperfectWorld) -> CompiledImperfectRobot | None:
        inner = face_of(self.inner, CompiledRobot, world.inner)
        if inner is None or self._period is None:
            return None
        rates, sensors = Rates(self._ticks, self._inner_steps), self._sizes.sensors
        return CompiledImperfectRobot(self._chain, inner, world, rates, sensors, self._reading)

    def truth(self, world: ImperfectWorld) -> Truth | None:
        return self.inner.truth(world.inner)

    # ------------------------------------------------------------------ inside

    def _build(self, n: int, sensors: tuple[str, ...]) -> None:
        """What depends on the number of joints and sensors, which the plant tells by its first measurement."""
        self._sizes = Sizes(n, sensors, self._ticks, self._inner_steps, self.inner.period)
        self._joints = Views([(i * n, n) for i in range(4)])
        self._felt = NamedRows(sensors, 4 * n, 6)
        self._chain = chain_of(self.config, self._sizes)
        self._period = compiled_period_of(self.inner)

    def _in_python(self, command: Command, draws: Array, world: ImperfectWorld) -> Array:
        """A period with a plant that is not compiled. Returns a reading in a row."""
        n, chain, memory = self._sizes.n, self._chain, world.memory
        out, asked, sent = np.empty(chain.reading_size), np.empty(n), np.zeros(n)
        wanted = np.ascontiguousarray(command.torque, dtype=np.float64)
        for draw in draws:
            chain.drive(memory, wanted, asked)
            sent += asked / self._ticks
            for step in range(self._inner_steps - 1):
                self._geared(draw, step, world)
            true = self._geared(draw, self._inner_steps - 1, world)
            chain.sense(memory, draw, self._row(true), out)
            world.time = true.time
        out[3 * n : 4 * n] = sent
        return out

    def _geared(self, draw: Array, step: int, world: ImperfectWorld) -> Measurement:
        """A step of the plant inside. Returns what perfect sensors say at its end."""
        torque = np.empty(self._sizes.n)
        self._chain.gear(world.memory, draw, step, torque)
        true, world.inner = self.inner.step(Command(world.time, torque, np.zeros_like(torque)), world.inner)
        self._chain.moved(world.memory, np.ascontiguousarray(true.v))
        return true

    def _row(self, true: Measurement) -> Array:
        """The perfect measurement, in the format of the chain."""
        felt = [true.wrenches[frame] for frame in self._sizes.sensors]
        return np.concatenate([true.q, true.v, true.torque, *felt])

    def _reading(self, time: float, out: Array) -> Measurement:
        q, v, torque, sent = self._joints.of(out)
        return Measurement(time, q, v, torque, sent, self._felt.of(out))


def _check_damping(inner: Plant[Any], wanted: float) -> None:
    # As a torque held over a period, damping can make a light joint unstable; the plant integrates it implicitly.
    if wanted == 0.0:
        return
    joints = getattr(inner, "joints", None)
    if joints is None or not np.allclose(getattr(joints, "damping", 0.0), wanted):
        raise ConfigError(
            f"joint damping of {wanted:g} N·m s/rad must be part of the plant inside: give it"
            f" joints=JointEffects(damping={wanted:g})"
        )
