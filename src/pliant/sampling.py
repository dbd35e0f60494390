"""Sampled time: periods in a duration, and the coefficient of a first-order low-pass."""

from __future__ import annotations

import math

from pliant.errors import ConfigError


def whole_periods(duration: float, period: float, what: str, of: str = "") -> int:
    """How many periods a duration is.

    Args:
        duration: s, not negative.
        period: s, above zero.
        what: name of the duration, for the error.
        of: name of the period, for the error.

    Raises:
        ConfigError: the duration is not a whole multiple of the period.
    """
    ratio = duration / period
    if duration < 0.0 or abs(ratio - round(ratio)) > 1e-6:
        whole = f"a whole multiple of {of + ' of ' if of else ''}{period:g} s"
        raise ConfigError(f"{what} must be {whole} and not negative, got {duration:g} s")
    return round(ratio)


def kept_share(cutoff: float, period: float) -> float:
    """Share e^{−2π f_c T} of the last value that a first-order low-pass keeps over a period: its step response is that
    of the continuous filter at every sample.

    Args:
        cutoff: f_c, Hz.
        period: T, s.
    """
    return math.exp(-2.0 * math.pi * cutoff * period)
