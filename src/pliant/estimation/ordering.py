"""Estimators with a state need readings in the order of their times."""

from __future__ import annotations

from pliant.errors import SignalError
from pliant.signals import Measurement


def time_since(before: float, measurement: Measurement) -> float:
    """s from the last reading to this one.

    Raises:
        SignalError: it is older than the last one.
    """
    period = measurement.time - before
    if period < 0.0:
        raise SignalError(f"measurements must arrive in order, got t = {measurement.time} s after {before} s")
    return period
