"""Sensors that are late and noisy ([FFMPC] eq. 30–32)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pliant.configuration import Config
from pliant.frozen import changed
from pliant.quantity import quantity
from pliant.sampling import whole_periods
from pliant.signals import Measurement
from pliant.simulation.imperfections.delay import Delay
from pliant.simulation.imperfections.link_config import PerJoint, per_joint
from pliant.simulation.seeding import generator
from pliant.spatial import Array


class SensingConfig(Config):
    """Delay and noise. Standard deviations are those of white Gaussian noise on every reading; 0 switches one off."""

    delay: float = quantity(0.0, "s", "age of every reading", ge=0.0, le=1.0)
    delay_torque: float | None = quantity(
        None, "s", "age of the joint torque sensors' readings; none: as the others", ge=0.0, le=1.0
    )
    delay_force: float = quantity(0.0, "s", "further age of the force/torque sensors' readings", ge=0.0, le=1.0)
    noise_q: PerJoint = quantity(0.0, "rad", "standard deviation of the joint positions")
    noise_v: PerJoint = quantity(0.0, "rad/s", "standard deviation of the joint velocities")
    noise_torque: PerJoint = quantity(0.0, "N·m", "standard deviation of the joint torque sensors")
    fit_joints: bool = quantity(
        False,
        "1",
        "values per joint are those of another robot: joints beyond them take the last, what is too many is left out",
    )
    noise_force: float = quantity(
        0.0, "N", "standard deviation of the force part of force/torque sensors", ge=0.0, le=1e3
    )
    noise_moment: float = quantity(0.0, "N·m", "standard deviation of their moment part", ge=0.0, le=1e3)
    torque_gain_error: float = quantity(0.0, "1", "largest relative error of a joint torque sensor", ge=0.0, lt=1.0)
    torque_offset: float = quantity(0.0, "N·m", "largest offset of a joint torque sensor", ge=0.0, le=1e3)

    @property
    def noisy(self) -> frozenset[str]:
        """Fields of `Measurement` of which no two readings are equal."""
        noise = {
            "q": self.noise_q,
            "v": self.noise_v,
            "torque": self.noise_torque,
            "wrenches": max(self.noise_force, self.noise_moment),
        }
        return frozenset(name for name, std in noise.items() if np.max(std) > 0.0)


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
