"""Low-pass filters for vectors, sampled at a fixed period. The state is passed in and returned."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pliant._estimation import filter_step
from pliant.errors import ConfigError
from pliant.sampling import kept_share
from pliant.spatial import Array


class Memory(NamedTuple):
    """State of a filter of up to second order, each (k,)."""

    first: Array
    second: Array


Coefficients = tuple[float, float, float, float, float]
"""b_0, b_1, b_2, a_1, a_2 of y = (b_0 + b_1 z⁻¹ + b_2 z⁻²)/(1 + a_1 z⁻¹ + a_2 z⁻²) x"""


class LowPass:
    """A low-pass filter of up to second order with gain one at rest, in transposed direct form II.

    Args:
        coefficients: of the filter.
    """

    def __init__(self, coefficients: Coefficients) -> None:
        self.coefficients = coefficients

    def init(self, value: Array) -> Memory:
        """State of a filter that has seen `value` (k,) for ever: its output starts there without a transient."""
        b_0, _, b_2, _, a_2 = self.coefficients
        return Memory((1.0 - b_0) * value, (b_2 - a_2) * value)

    def step(self, value: Array, state: Memory) -> tuple[Array, Memory]:
        """Filtered value (k,) and the next state."""
        filtered, after = np.array(value, dtype=np.float64), Memory(state.first.copy(), state.second.copy())
        filter_step(self.coefficients, filtered, after.first, after.second)
        return filtered, after


class FirstOrder(LowPass):
    """y ← y + α (x − y), α = 1 − e^{−2π f_c T}: the step response of a continuous first-order filter, matched at the
    samples.

    Args:
        cutoff: f_c, Hz.
        period: T, s.
    """

    def __init__(self, cutoff: float, period: float) -> None:
        _check(cutoff, period)
        kept = kept_share(cutoff, period)
        super().__init__((1.0 - kept, 0.0, 0.0, -kept, 0.0))


class Butterworth(LowPass):
    """Second order, maximally flat; bilinear transform, prewarped so that the gain at f_c is 1/√2 exactly.

    Args:
        cutoff: f_c, Hz, below half the sampling rate.
        period: T, s.
    """

    def __init__(self, cutoff: float, period: float) -> None:
        _check(cutoff, period)
        if cutoff >= 0.5 / period:
            raise ConfigError(
                "the cutoff of a Butterworth filter must lie below half the sampling rate,"
                f" got {cutoff} Hz at {1.0 / period:g} Hz"
            )
        w = math.tan(math.pi * cutoff * period)
        scale = 1.0 / (1.0 + math.sqrt(2.0) * w + w * w)
        b = w * w * scale
        a_1, a_2 = 2.0 * (w * w - 1.0) * scale, (1.0 - math.sqrt(2.0) * w + w * w) * scale
        super().__init__((b, 2.0 * b, b, a_1, a_2))


def _check(cutoff: float, period: float) -> None:
    if not (np.isfinite([cutoff, period]).all() and cutoff > 0.0 and period > 0.0):
        raise ConfigError(f"a filter needs a cutoff above 0 Hz and a period above 0 s, got {cutoff} Hz and {period} s")
