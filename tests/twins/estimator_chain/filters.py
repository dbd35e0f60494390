"""Low-pass filters for vectors, sampled at a fixed period. The state goes in and comes out."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import NamedTuple

from pliant.sampling import kept_share
from pliant.spatial import Array


class Memory(NamedTuple):
    """State of a filter of up to second order, each (k,)."""

    first: Array
    second: Array


class LowPassTwin(ABC):
    """A low-pass filter with gain one at rest."""

    @abstractmethod
    def init(self, value: Array) -> Memory:
        """State of a filter that has seen `value` (k,) for ever: its output starts there without a transient."""

    @abstractmethod
    def step(self, value: Array, state: Memory) -> tuple[Array, Memory]:
        """Filtered value (k,) and the next state."""


class FirstOrderTwin(LowPassTwin):
    """y ← y + α (x − y), α = 1 − e^{−2π f_c T}: the step response of a continuous first-order filter, hit at every
    sample."""

    def __init__(self, cutoff: float, period: float) -> None:
        self.gain = 1.0 - kept_share(cutoff, period)
        """α"""

    def init(self, value: Array) -> Memory:
        return Memory(value, value)

    def step(self, value: Array, state: Memory) -> tuple[Array, Memory]:
        filtered = state.first + self.gain * (value - state.first)
        return filtered, Memory(filtered, filtered)


class ButterworthTwin(LowPassTwin):
    """Second order, maximally flat; bilinear transform, prewarped so that the gain at f_c is 1/√2 exactly."""

    def __init__(self, cutoff: float, period: float) -> None:
        w = math.tan(math.pi * cutoff * period)
        scale = 1.0 / (1.0 + math.sqrt(2.0) * w + w * w)
        self._b = w * w * scale  # numerator b (1 + 2 z⁻¹ + z⁻²)
        self._a_1 = 2.0 * (w * w - 1.0) * scale
        self._a_2 = (1.0 - math.sqrt(2.0) * w + w * w) * scale

    def init(self, value: Array) -> Memory:
        return Memory((1.0 - self._b) * value, (self._b - self._a_2) * value)

    def step(self, value: Array, state: Memory) -> tuple[Array, Memory]:
        # transposed direct form II
        driven = self._b * value
        filtered = driven + state.first
        return filtered, Memory(2.0 * driven - self._a_1 * filtered + state.second, driven - self._a_2 * filtered)
