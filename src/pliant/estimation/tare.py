"""Taring: the reading of a force/torque sensor at the start of a run is taken as its load."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from pliant.errors import ConfigError, options

_KINDS = ("weight", "bias")


@dataclass(frozen=True)
class Tare:
    """How to tare. The robot must stand still without contact; until taring ends, no contact is reported.

    One pose cannot distinguish a weight from an offset. "weight" takes the force along gravity for a mass (its centre
    as close to the sensor as the moment allows) and only the rest for an offset. This is right for an unknown payload;
    its weight then turns with the sensor, and its inertia is compensated. "bias" takes everything for an offset, which
    is right for a sensor whose zero has drifted.

    Raises:
        ConfigError: on construction, when a value is not above zero or the kind is unknown.
    """

    duration: float = 0.02
    """s at the start whose readings are averaged; at least one reading counts"""
    kind: Literal["weight", "bias"] = "weight"
    still: float = 0.1
    """rad/s; an arm with a faster joint cannot be tared"""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.duration) and self.duration >= 0.0 and self.still > 0.0):
            raise ConfigError(f"a tare needs a duration of 0 s or more and a speed above zero, got {self}")
        if self.kind not in _KINDS:
            raise ConfigError(f"unknown kind of tare {self.kind!r}; {options(_KINDS, self.kind)}")
