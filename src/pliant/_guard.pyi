"""Typed face of the compiled look at signals (cpp/guard).

True: the signal is sound beyond doubt, made of NumPy's own arrays of float64. False: `pliant.guard.sound` has to look.
"""

from typing import Any

from pliant.spatial import Array

def is_reading(reading: Any, n: int, frames: tuple[str, ...]) -> bool:
    """A measurement for n joints and force sensors at these frames."""

def is_estimate(estimate: Any, n: int) -> bool:
    """An estimate for n joints, without surfaces."""

def is_reference(reference: Any, n: int) -> bool:
    """A reference for n joints."""

def is_within(torque: Any, bound: Array) -> bool:
    """A torque of which no entry is larger than its bound (n,), N·m."""
