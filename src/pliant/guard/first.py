"""Errors at the start of a loop: the rule that a part breaks before the first tick."""

from __future__ import annotations

import math
from dataclasses import fields
from typing import get_args

import numpy as np

from pliant.errors import ConfigError, PliantError, ShapeError, SignalError, options
from pliant.guard.faults import Fault
from pliant.interfaces import Compensation, Plant
from pliant.signals import Command, Estimate, Measurement, Reference

_OF_JOINTS = ("q", "v", "torque", "torque_sent")
_COMPENSATIONS: tuple[str, ...] = get_args(Compensation)

_PARTS: dict[Fault, tuple[str, type[Estimate | Reference | Command], tuple[str, ...]]] = {
    Fault.ESTIMATE: ("estimator", Estimate, _OF_JOINTS),
    Fault.REFERENCE: ("source", Reference, ()),
    Fault.COMMAND: ("controller", Command, ("torque",)),
}
"""fault → part that it comes from, what that gives, and its fields of one entry per joint"""


def check_plant(plant: Plant[object]) -> None:
    """Checks the properties of a plant.

    Raises:
        ConfigError: its period is not valid, or it names a sensor or a compensation that does not exist.
    """
    if not (math.isfinite(plant.period) and plant.period > 0.0):
        raise ConfigError(f"a plant's period must be finite and above zero, got {plant.period!r} s")
    sensors = {field.name for field in fields(Measurement)} - {"time"}
    for name in plant.noisy - sensors:
        raise ConfigError(f"a plant's noisy sensors must be fields of Measurement, got {name!r}; {options(sensors)}")
    if plant.compensates not in _COMPENSATIONS:
        raise ConfigError(f"unknown compensation {plant.compensates!r}; {options(_COMPENSATIONS)}")


def check_first(reading: object, n: int | None) -> None:
    """Checks types and sizes of the first measurement.

    Raises:
        ConfigError: it is not a measurement.
        ShapeError: it does not fit n joints; None: as many as it has.
    """
    if not isinstance(reading, Measurement):
        raise ConfigError(f"the plant must give a Measurement, got {type(reading).__name__}")
    joints = np.size(reading.q) if n is None else n
    _check_sizes("the first measurement", reading, joints, _OF_JOINTS)
    for frame, wrench in reading.wrenches.items():
        if np.shape(wrench) != (6,):
            raise ShapeError(
                f"the first measurement's wrench at {frame!r} must have shape (6,), got {np.shape(wrench)}"
            )


def why_not(fault: Fault, got: object, n: int) -> PliantError:
    """The error for a first estimate, reference or command of n joints that is not sound."""
    if fault not in _PARTS:
        return SignalError(f"the first tick cannot be computed: {fault.words}")
    part, kind, names = _PARTS[fault]
    if not isinstance(got, kind):
        return ConfigError(f"the {part} must give {kind.__name__}, got {type(got).__name__}")
    try:
        _check_sizes(f"the first {kind.__name__.lower()}", got, n, names)
    except ShapeError as error:
        return error
    return SignalError(f"the first tick cannot be computed: {fault.words}")


def _check_sizes(what: str, signal: object, n: int, names: tuple[str, ...]) -> None:
    for name in names:
        value = getattr(signal, name)
        if np.shape(value) != (n,):
            raise ShapeError(f"{what}'s {name} must have shape ({n},), got {np.shape(value)}")
