"""Time scaling of trajectories: path time as a function of time."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from pliant.errors import ConfigError
from pliant.spatial import Array


class Warp(ABC):
    """Maps time in s to the path time φ in s at which a trajectory is evaluated."""

    @abstractmethod
    def at(self, time: float) -> tuple[float, float, float]:
        """φ in s, dφ/dt (1) and d²φ/dt² in 1/s."""

    def rows(self, times: Array) -> tuple[Array, Array, Array]:
        """The same at many times (m,) s: (m,) each."""
        table = np.array([self.at(time) for time in times.tolist()]).reshape(len(times), 3)
        return table[:, 0], table[:, 1], table[:, 2]

    @abstractmethod
    def time_of(self, phase: float) -> float:
        """The time at which a path time, in s, is reached."""


@dataclass(frozen=True)
class EaseIn(Warp):
    """Starts from rest: dφ/dt rises from 0 to 1 along a quintic step within `seconds`, so that φ has three continuous
    derivatives. From then on the path time lags behind the time by half of `seconds`."""

    seconds: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.seconds) and self.seconds >= 0.0):
            raise ConfigError(f"the time to ease in must be 0 s or more, got {self.seconds}")

    def at(self, time: float) -> tuple[float, float, float]:
        if time >= self.seconds:
            return time - 0.5 * self.seconds, 1.0, 0.0
        if time <= 0.0:
            return 0.0, 0.0, 0.0
        u = time / self.seconds
        phase = self.seconds * u**4 * (2.5 - u * (3.0 - u))
        rate = u**3 * (10.0 - u * (15.0 - 6.0 * u))
        return phase, rate, 30.0 * (u * (1.0 - u)) ** 2 / self.seconds

    def rows(self, times: Array) -> tuple[Array, Array, Array]:
        if times.size == 0 or times.min() < self.seconds:
            return super().rows(times)
        return times - 0.5 * self.seconds, np.ones_like(times), np.zeros_like(times)

    def time_of(self, phase: float) -> float:
        if phase >= 0.5 * self.seconds:
            return phase + 0.5 * self.seconds
        low, high = 0.0, self.seconds
        for _ in range(60):  # bisection: φ is monotone
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.at(middle)[0] < phase else (low, middle)
        return high


@dataclass(frozen=True)
class Scale(Warp):
    """Plays a trajectory faster (rate > 1) or slower."""

    rate: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.rate) and self.rate > 0.0):
            raise ConfigError(f"the rate of a time scaling must be above zero, got {self.rate}")

    def at(self, time: float) -> tuple[float, float, float]:
        return self.rate * time, self.rate, 0.0

    def time_of(self, phase: float) -> float:
        return phase / self.rate
