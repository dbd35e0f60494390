"""The imperfect robot in Python, the twin of cpp/plant/imperfect_robot.cpp: any plant, with late and noisy sensors,
drives, gears and computation time.

command ─▶ computation delay ─▶ torque loop ─▶ actuation ─▶ plant ─▶ ripple ─▶ sensing ─▶ measurement
                                     ▲                                             │
                                     └───────────── measured torque ───────────────┘
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant.frozen import changed
from pliant.interfaces import Plant
from pliant.sampling import whole_periods
from pliant.signals import Command, Measurement
from pliant.simulation.imperfections.config import Imperfections
from pliant.simulation.imperfections.plant import ImperfectPlant
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


class ImperfectTwin(ImperfectPlant):
    """The same arguments and periods as `ImperfectPlant`; its own state and steps."""

    def __init__(self, inner: Plant[Any], config: Imperfections, **options: Any) -> None:
        super().__init__(inner, config, **options)
        tick = config.torque_loop.period
        self._delay: Delay[Array] = Delay(whole_periods(config.computation_delay, tick, "computation delay"))
        self._ripple = Ripple(config.ripple, tick)

    def init(self) -> tuple[Measurement, TwinWorld]:
        """The first measurement, and the robot as it stands, holding itself with `holding_torque`."""
        true, inner = self.inner.init()
        n = true.q.shape[0]
        self._build_links(n)
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

    # ------------------------------------------------------------------ inside

    def _build_links(self, n: int) -> None:
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
