"""Taring: the reading of a force/torque sensor at the start of a run is taken as its load."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from pliant.errors import ConfigError, SignalError, options
from pliant.estimation.carried_mass import CarriedMass
from pliant.spatial import Array, cross

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


@dataclass(frozen=True, slots=True)
class TareState:
    """Sums of the readings, and the result."""

    start: float
    """s"""
    count: int = 0
    readings: Mapping[str, Array] = field(default_factory=dict[str, Array])
    """sensor → (6,) sum of what is not explained, in its axes"""
    gravity: Mapping[str, Array] = field(default_factory=dict[str, Array])
    """sensor → (3,) sum of gravity in its axes"""
    found: Mapping[str, CarriedMass] | None = None
    """sensor → load that was found; None while taring"""


def tare_step(
    tare: Tare, time: float, v: Array, unexplained: Mapping[str, Array], gravity: Mapping[str, Array], state: TareState
) -> TareState:
    """Adds one reading; the tare ends with the first one at or after `duration`.

    Args:
        tare: how.
        time: of the reading, s.
        v: (n,) joint velocities, rad/s.
        unexplained: sensor → (6,) reading without what is known, in the sensor's axes.
        gravity: sensor → (3,) gravity in the sensor's axes, m/s².
        state: of the reading before.

    Raises:
        SignalError: the robot moves.
    """
    speed = float(np.abs(v).max())
    if speed > tare.still:
        raise SignalError(
            f"a sensor can be tared only at rest: a joint moves at {speed:.2g} rad/s, at most {tare.still:g} rad/s;"
            " start from rest, let the robot hold itself, or tare for a shorter time"
        )
    readings = {name: state.readings.get(name, 0.0) + reading for name, reading in unexplained.items()}
    pull = {name: state.gravity.get(name, 0.0) + g for name, g in gravity.items()}
    count = state.count + 1
    found = None
    if time - state.start >= tare.duration - 1e-9:
        found = {name: _carried(tare.kind, readings[name] / count, pull[name] / count) for name in readings}
    return TareState(state.start, count, readings, pull, found)


def _carried(kind: str, reading: Array, gravity: Array) -> CarriedMass:
    force, moment = reading[:3], reading[3:]
    scale = float(gravity @ gravity)
    mass = 0.0 if kind == "bias" or scale == 0.0 else max(0.0, float(force @ gravity) / scale)
    if mass == 0.0:
        return CarriedMass(bias=_six(reading))
    weight = mass * gravity
    center: Array = cross(weight, moment) / float(weight @ weight)
    rest = reading - np.concatenate([weight, cross(center, weight)])
    c = center.tolist()
    return CarriedMass(mass, (c[0], c[1], c[2]), _six(rest))


def _six(values: Array) -> tuple[float, float, float, float, float, float]:
    a, b, c, d, e, f = values.tolist()
    return a, b, c, d, e, f
