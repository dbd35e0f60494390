"""Motors and gears in Python: the twin of cpp/plant/imperfect_robot.cpp."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.sampling import kept_share
from pliant.simulation.imperfections.actuation import ActuationConfig
from pliant.simulation.seeding import generator
from pliant.spatial import Array, as_vector, clamp


@dataclass(slots=True)
class ActuationState:
    """Consumed by `step`."""

    gain: Array
    """a (n,)"""
    bias: Array
    """b (n,), N·m"""
    filtered: Array
    """(n,) motor torque after the first-order response, N·m"""
    clamped: Array
    """(n,) what the peak torque took away in the last step, N·m"""
    generator: np.random.Generator


class Actuation:
    """`τ = a F(τ_m) + b − μ_s tanh(v/v_0) − μ_v v + ν`, F the peak torque, then a first-order lag.

    All of it happens before the torque sensor, which therefore sees it. The printed equation has the joint position in
    the friction terms where the velocity is meant, and one noise for both the torque and its reading: here the
    reading's noise belongs to `Sensing`.

    Args:
        config: what is imperfect.
        period: s between two steps.
        n: number of joints.

    Raises:
        ShapeError: a value with another number of entries than there are joints.
    """

    def __init__(self, config: ActuationConfig, period: float, n: int) -> None:
        self.config = config
        self._n = n
        self._dry = as_vector(config.dry_friction, n, "dry_friction")
        self._viscous = as_vector(config.viscous_friction, n, "viscous_friction")
        self._noise = as_vector(config.noise, n, "noise")
        self.limit = np.full(n, np.inf if config.peak_torque is None else config.peak_torque)
        """(n,) largest motor torque, N·m"""
        self._kept = 0.0 if config.bandwidth is None else kept_share(config.bandwidth, period)

    def init(self, torque: Array, seed: int) -> ActuationState:
        """State before the first step.

        Args:
            torque: (n,) what the motors have been giving so far, N·m.
            seed: of the run.
        """
        return ActuationState(
            gain=generator(seed, "actuation.gain").uniform(*self.config.gain, self._n),
            bias=generator(seed, "actuation.bias").uniform(*self.config.bias, self._n),
            filtered=np.clip(torque, -self.limit, self.limit),
            clamped=np.zeros(self._n),
            generator=generator(seed, "actuation.noise"),
        )

    def step(self, motor_torque: Array, v: Array, state: ActuationState) -> tuple[Array, ActuationState]:
        """Torque at the link side (n,), N·m, and the next state.

        Args:
            motor_torque: (n,) N·m.
            v: (n,) true joint velocity, rad/s.
            state: consumed.
        """
        limited = clamp(motor_torque, -self.limit, self.limit)
        state.clamped = motor_torque - limited
        state.filtered = limited + self._kept * (state.filtered - limited)
        friction = self._dry * np.tanh(v / self.config.friction_velocity) + self._viscous * v
        noise = self._noise * state.generator.standard_normal(self._n)
        return state.gain * state.filtered + state.bias - friction + noise, state
