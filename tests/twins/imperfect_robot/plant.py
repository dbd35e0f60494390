"""The imperfect robot in Python, the twin of cpp/plant/flaws.cpp: any plant, with late and noisy sensors, drives, gears
and computation time.

command ─▶ computation delay ─▶ torque loop ─▶ actuation ─▶ plant ─▶ ripple ─▶ sensing ─▶ measurement
                                     ▲                                             │
                                     └───────────── measured torque ───────────────┘
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError
from pliant.frozen import changed
from pliant.interfaces import Compensation, Plant
from pliant.sampling import whole_periods
from pliant.signals import Command, Measurement, Truth
from pliant.simulation.imperfections.config import Imperfections
from pliant.spatial import Array, as_vector, clamp
from tests.twins.imperfect_robot.actuation import Actuation, ActuationState
from tests.twins.imperfect_robot.delay import Delay
from tests.twins.imperfect_robot.ripple import Ripple
from tests.twins.imperfect_robot.sensing import Sensing, SensingState
from tests.twins.imperfect_robot.torque_loop import TorqueLoop, TorqueLoopState


@dataclass(slots=True)
class TwinWorld:
    """State of the imperfect robot. Consumed by `step`."""

    inner: Any
    """state of the plant inside"""
    commands: tuple[Array, ...]
    """torques (n,) computed but not yet in effect, the oldest first, one per period of the torque loop, N·m"""
    torque_loop: TorqueLoopState
    actuation: ActuationState
    ripple_phase: float
    """rad"""
    sensing: SensingState
    reading: Measurement
    """what the sensors said last"""
    true_velocity: Array
    """(n,) rad/s"""
    motor_torque: Array
    """(n,) what the drives asked of the motors last, N·m"""


class ImperfectTwin(Plant[TwinWorld]):
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
        self._delay: Delay[Array] = Delay(whole_periods(config.computation_delay, tick, "computation delay"))
        self._ripple = Ripple(config.ripple, tick)
        _check_damping(inner, config.joint_damping)

    @property
    def noisy(self) -> frozenset[str]:
        return self.config.sensing.noisy

    @property
    def compensates(self) -> Compensation:
        return self.inner.compensates

    def init(self) -> tuple[Measurement, TwinWorld]:
        """The first measurement, and the robot as it stands, holding itself with `holding_torque`."""
        true, inner = self.inner.init()
        n = true.q.shape[0]
        self._build(n)
        held = true.torque_sent if self._holding_torque is None else self._holding_torque
        held = as_vector(held, n, "holding_torque")
        true = changed(true, torque=held, torque_sent=held)
        reading, sensing = self._sensing.step(true, self._sensing.init(true, self.seed))
        world = TwinWorld(
            inner=inner,
            commands=self._delay.init(held),
            torque_loop=self._torque_loop.init(reading.torque),
            actuation=self._actuation.init(held, self.seed),
            ripple_phase=self._ripple.init(),
            sensing=sensing,
            reading=reading,
            true_velocity=true.v,
            motor_torque=held,
        )
        return reading, world

    def step(self, command: Command, world: TwinWorld) -> tuple[Measurement, TwinWorld]:
        """One control period.

        `Measurement.torque_sent` is the torque asked of the drives, after the clamp: its mean over the period, since a
        command can take effect in the middle of one.
        """
        sent = np.zeros_like(command.torque)
        for _ in range(self._ticks):
            asked, world.commands = self._delay.step(command.torque, world.commands)
            asked = clamp(asked, -self._actuation.limit, self._actuation.limit)
            sent += asked / self._ticks
            true = self._drive(asked, world)
            self._sense(changed(true, torque_sent=asked), world)
        return changed(world.reading, torque_sent=sent), world

    def truth(self, world: TwinWorld) -> Truth | None:
        return self.inner.truth(world.inner)

    # ------------------------------------------------------------------ inside

    def _build(self, n: int) -> None:
        """Links whose sizes depend on the number of joints, which the plant tells by its first measurement."""
        self._actuation = Actuation(self.config.actuation, self.inner.period, n)
        self._torque_loop = TorqueLoop(self.config.torque_loop, self._actuation.limit)
        self._sensing = Sensing(self.config.sensing, self.config.torque_loop.period, n)

    def _drive(self, asked: Array, world: TwinWorld) -> Measurement:
        """Drives and gears for one period of the torque loop. Returns what perfect sensors say at its end."""
        world.motor_torque, world.torque_loop = self._torque_loop.step(asked, world.reading.torque, world.torque_loop)
        for _ in range(self._inner_steps - 1):
            self._gears(world)
        return self._gears(world)

    def _gears(self, world: TwinWorld) -> Measurement:
        torque, world.actuation = self._actuation.step(world.motor_torque, world.true_velocity, world.actuation)
        true, world.inner = self.inner.step(Command(world.reading.time, torque, np.zeros_like(torque)), world.inner)
        world.true_velocity = true.v
        return true

    def _sense(self, true: Measurement, world: TwinWorld) -> None:
        wrenches, world.ripple_phase = self._ripple.step(true.wrenches, true.v, world.ripple_phase)
        world.reading, world.sensing = self._sensing.step(changed(true, wrenches=wrenches), world.sensing)


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
