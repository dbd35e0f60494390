"""Late and noisy sensors in Python: the twin of cpp/plant/imperfect_robot.cpp."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pliant.frozen import changed
from pliant.sampling import whole_periods
from pliant.signals import Measurement
from pliant.simulation.imperfections.link_config import per_joint
from pliant.simulation.imperfections.sensing import SensingConfig
from pliant.simulation.seeding import generator
from pliant.spatial import Array
from tests.twins.imperfect_robot.delay import Delay


@dataclass(slots=True)
class SensingState:
    """Readings under way, the generators, and what was drawn once. Consumed by `step`."""

    queue: tuple[Measurement, ...]
    torques: tuple[Array, ...]
    """(n,) under way from the joint torque sensors, N·m"""
    wrenches: tuple[Mapping[str, Array], ...]
    """frame → (6,) under way from the force/torque sensors"""
    generators: dict[str, np.random.Generator]
    """source → generator"""
    torque_gain: Array
    """(n,) of each joint torque sensor"""
    torque_offset: Array
    """(n,) N·m"""


class Sensing:
    """From what is true to what the sensors say.

    The mismatch between joint torque sensors and force/torque sensor that the published hardware shows ([FFMPC] sec.
    VIII-C) is a gain and an offset of each joint torque sensor, drawn once per run.

    Args:
        config: delay and noise.
        period: s between two readings.
        n: number of joints.

    Raises:
        ConfigError: the delay is not a whole multiple of the period.
        ShapeError: a noise with another number of entries than there are joints.
    """

    def __init__(self, config: SensingConfig, period: float, n: int) -> None:
        self.config = config
        self._delay: Delay[Measurement] = Delay(whole_periods(config.delay, period, "sensing delay"))
        torque_delay = config.delay if config.delay_torque is None else config.delay_torque
        self._delay_torque: Delay[Array] = Delay(whole_periods(torque_delay, period, "delay of the torque sensors"))
        late = whole_periods(config.delay_force, period, "delay of the force signal")
        self._delay_force: Delay[Mapping[str, Array]] = Delay(late)
        self._noise_q = per_joint(config.noise_q, n, "noise_q", fitted=config.fit_joints)
        self._noise_v = per_joint(config.noise_v, n, "noise_v", fitted=config.fit_joints)
        self._noise_torque = per_joint(config.noise_torque, n, "noise_torque", fitted=config.fit_joints)
        self._noise_wrench = np.repeat([config.noise_force, config.noise_moment], 3)
        self._n = n

    def init(self, true: Measurement, seed: int) -> SensingState:
        """State before the first reading. Args: true: what perfect sensors say at the start; seed: of the run."""
        sources = ("q", "v", "torque", *(f"wrench.{frame}" for frame in true.wrenches))
        mismatch = generator(seed, "sensing.mismatch")
        return SensingState(
            queue=self._delay.init(true),
            torques=self._delay_torque.init(true.torque),
            wrenches=self._delay_force.init(true.wrenches),
            generators={source: generator(seed, f"sensing.{source}") for source in sources},
            torque_gain=1.0 + self.config.torque_gain_error * mismatch.uniform(-1.0, 1.0, self._n),
            torque_offset=self.config.torque_offset * mismatch.uniform(-1.0, 1.0, self._n),
        )

    def step(self, true: Measurement, state: SensingState) -> tuple[Measurement, SensingState]:
        """One reading.

        Args:
            true: what perfect sensors would say now. It is not changed.
            state: consumed.

        Returns:
            The reading: values that are `delay` old, plus noise. Its time is now, and `torque_sent` is what was sent
            until now: the controller knows that without a sensor.
        """
        old, state.queue = self._delay.step(true, state.queue)
        torque, state.torques = self._delay_torque.step(true.torque, state.torques)
        felt, state.wrenches = self._delay_force.step(old.wrenches, state.wrenches)
        draw = state.generators
        reading = changed(
            old,
            time=true.time,
            torque_sent=true.torque_sent,
            q=old.q + self._noise_q * draw["q"].standard_normal(self._n),
            v=old.v + self._noise_v * draw["v"].standard_normal(self._n),
            torque=state.torque_gain * torque
            + state.torque_offset
            + self._noise_torque * draw["torque"].standard_normal(self._n),
            wrenches=self._noisy(felt, draw),
        )
        return reading, state

    def _noisy(self, wrenches: Mapping[str, Array], draw: Mapping[str, np.random.Generator]) -> dict[str, Array]:
        return {
            frame: wrench + self._noise_wrench * draw[f"wrench.{frame}"].standard_normal(6)
            for frame, wrench in wrenches.items()
        }
