"""Whether a signal is valid ("sound"): right type and size, real numbers, finite.

A compiled look (`cpp/guard`) passes what is sound beyond doubt, because this runs in every tick; what it does not pass
is looked at here. All numbers of a signal are then concatenated and checked at once: a sum of squares is finite if
every number is finite and below 1e154. Kinds of arrays that hide numbers (numpy's masked ones) are not of real numbers.
"""

from __future__ import annotations

import math

import numpy as np

from pliant import _guard
from pliant.environment import Environment
from pliant.guard.faults import Fault
from pliant.signals import Estimate, Measurement, Preview, Reference
from pliant.spatial import Array

_NOT_NUMBERS = (AttributeError, TypeError, ValueError)
"""errors of a signal that is not made of arrays of numbers"""
_SIX, _MATRIX = (6,), (3, 3)
_OF_TASK = ((3,), _SIX, _SIX, _SIX)
_REAL = "fiu"  # kinds of numbers


def reading_fault(reading: Measurement, n: int, frames: tuple[str, ...]) -> Fault:
    """The fault of a measurement for n joints and force sensors at these frames."""
    if _guard.is_reading(reading, n, frames):
        return Fault.NONE
    try:
        joints = [reading.q, reading.v, reading.torque, reading.torque_sent]
        felt = [*reading.wrenches.values()]
        sized = [part.shape for part in joints] == [(n,)] * 4 and [part.shape for part in felt] == [_SIX] * len(frames)
        if not sized or tuple(reading.wrenches) != frames:
            return Fault.SHAPE
        flat = np.concatenate(joints + felt)
        if flat.__class__ is not np.ndarray or flat.dtype.kind not in _REAL:
            return Fault.SHAPE
        return Fault.NONE if math.isfinite(reading.time) and math.isfinite(flat.dot(flat)) else Fault.NOT_FINITE
    except _NOT_NUMBERS:
        return Fault.SHAPE


def is_estimate(estimate: object, n: int) -> bool:
    """Whether something is a sound estimate for n joints."""
    if not isinstance(estimate, Estimate):
        return False
    if _guard.is_estimate(estimate, n):
        return True
    shape = (n,)
    try:
        parts = [estimate.q, estimate.v, estimate.torque, estimate.torque_sent]
        if estimate.disturbance is not None:
            parts.append(estimate.disturbance)
        felt = [*estimate.wrenches.values()]
        sized = [part.shape for part in parts] == [shape] * len(parts)
        sized = sized and [part.shape for part in felt] == [_SIX] * len(felt)
        known = all(map(_is_environment, estimate.environments.values())) if estimate.environments else True
        for surface in estimate.surfaces.values():
            felt += [surface.pivot, surface.turn, surface.normal]
            sized = sized and felt[-1].shape == felt[-2].shape == felt[-3].shape == (3,)
            known = known and surface.normal_std >= 0.0
        return sized and known and math.isfinite(estimate.time) and _are_finite(parts + felt)
    except _NOT_NUMBERS:
        return False


def is_reference(reference: object, n: int) -> bool:
    """Whether something is a sound reference for n joints."""
    if not isinstance(reference, Reference):
        return False
    if _guard.is_reference(reference, n):
        return True
    parts: list[Array] = []
    shapes: list[tuple[int, ...]] = []
    try:
        for task in reference.tasks:
            if not isinstance(task.frame, str):  # pyright: ignore[reportUnnecessaryIsInstance] (somebody's own part)
                return False
            parts += (task.position, task.velocity, task.acceleration, task.wrench)
            shapes += _OF_TASK
            for rotation in (task.rotation, task.task_rotation):
                if rotation is not None:
                    parts.append(rotation)
                    shapes.append(_MATRIX)
        if reference.posture is not None:
            parts.append(reference.posture)
            shapes.append((n,))
        sized = [part.shape for part in parts] == shapes and math.isfinite(reference.time)
        ahead = reference.preview is None or _is_preview(reference.preview, n)
        return sized and ahead and _are_finite(parts)
    except _NOT_NUMBERS:
        return False


def is_torque(time: float, torque: Array, n: int) -> bool:
    """Whether a torque for n joints is sound, and so is its time."""
    try:
        return (
            torque.__class__ is np.ndarray
            and torque.shape == (n,)
            and torque.dtype.kind in _REAL
            and math.isfinite(time)
            and math.isfinite(torque.dot(torque))
        )
    except _NOT_NUMBERS:
        return False


def _is_preview(ahead: Preview, n: int) -> bool:
    N = len(ahead.time)
    parts = [ahead.time, ahead.position, ahead.velocity, ahead.wrench]
    shapes: list[tuple[int, ...]] = [(N,), (N, 3), (N, 6), (N, 6)]
    if ahead.rotation is not None:
        parts.append(ahead.rotation)
        shapes.append((N, 3, 3))
    if ahead.posture is not None:
        parts.append(ahead.posture)
        shapes.append((N, n))
    if ahead.task_rotation is not None:
        parts.append(ahead.task_rotation)
        shapes.append((N, 3, 3))
    return [part.shape for part in parts] == shapes and _are_finite(parts)


def _is_environment(known: Environment) -> bool:
    """Whether stiffness and damping are finite; an uncertainty may be infinite, but must be a number."""
    uncertain = known.stiffness_std >= 0.0 and known.damping_std >= 0.0
    return uncertain and math.isfinite(known.stiffness + known.damping)


def _are_finite(parts: list[Array]) -> bool:
    if not parts:
        return True
    flat = np.concatenate(parts, axis=None)
    return flat.__class__ is np.ndarray and flat.dtype.kind in _REAL and math.isfinite(flat.dot(flat))
