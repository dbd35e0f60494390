"""Taring: what a force/torque sensor reads at the start of a run counts as what it carries."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from pliant.errors import SignalError
from pliant.estimation.carried_mass import CarriedMass
from pliant.estimation.tare import Tare
from pliant.spatial import Array, cross


@dataclass(frozen=True, slots=True)
class TareState:
    """Readings so far, and what they came to."""

    start: float
    """s"""
    count: int = 0
    readings: Mapping[str, Array] = field(default_factory=dict[str, Array])
    """sensor → (6,) sum of what is not explained, in its axes"""
    gravity: Mapping[str, Array] = field(default_factory=dict[str, Array])
    """sensor → (3,) sum of gravity in its axes"""
    found: Mapping[str, CarriedMass] | None = None
    """sensor → what it turned out to carry; None while taring"""


def tare_step(
    tare: Tare, time: float, v: Array, unexplained: Mapping[str, Array], gravity: Mapping[str, Array], state: TareState
) -> TareState:
    """Takes one more reading in; the tare is found with the first one that is `duration` old or older."""
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
