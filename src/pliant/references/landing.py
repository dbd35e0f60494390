"""Smooth transition of the reference to the height at which contact was made."""

from __future__ import annotations

from typing import NamedTuple

SETTLE = 0.1  # s, from the speed of the approach to rest


class Height(NamedTuple):
    """Height of the touched surface above the believed one, along its normal, as the reference follows it.

    The height goes from what the reference had at the contact, at the speed it had, to what was found: a quintic that
    ends at rest.
    """

    start: float = 0.0
    """s of the loop's clock, when contact was made"""
    found: float = 0.0
    """m, of the frame above where the path expects it"""
    gap: float = 0.0
    """m, of the reference above that of the frame, at the contact"""
    rate: float = 0.0
    """m/s, of the reference"""

    def at(self, time: float) -> tuple[float, float, float]:
        """m, m/s and m/s² at a time in s."""
        u = (time - self.start) / SETTLE
        if u >= 1.0:
            return self.found, 0.0, 0.0
        u, x, v = max(u, 0.0), self.gap, self.rate * SETTLE
        value = x * (1.0 - u**3 * (10.0 - u * (15.0 - 6.0 * u))) + v * u * (1.0 - u * u * (6.0 - u * (8.0 - 3.0 * u)))
        slope = -x * 30.0 * (u * (1.0 - u)) ** 2 + v * (1.0 - u * u * (18.0 - u * (32.0 - 15.0 * u)))
        bend = -x * 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) - v * u * (36.0 - u * (96.0 - 60.0 * u))
        return self.found + value, slope / SETTLE, bend / SETTLE**2
