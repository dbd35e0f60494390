"""References on the estimated surface instead of the believed one."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from pliant.errors import ConfigError
from pliant.frozen import changed
from pliant.interfaces import ReferenceSource
from pliant.signals import Estimate, Preview, Reference, TaskReference
from pliant.spatial import Array, exp3

CHANNELS: Mapping[str, str] = MappingProxyType({"surface/turn": "rad"})
"""name → unit of the channel with the turn of the references; `estimate/FRAME/surface/…` has the estimate"""
_MEMORY = 0.2  # s


@dataclass(frozen=True, slots=True)
class EstimatedSurfaceState:
    """State between two ticks."""

    inner: Any
    time: float
    turn: Array
    """(3,) rad, by which references are turned about the pivot"""


class OnEstimatedSurface(ReferenceSource[EstimatedSurfaceState]):
    """Turns the references of a task about the point of first contact by the estimated rotation of the surface
    (`Estimate.surfaces`): path, tool, direction of the force and task axes, now and over the horizon.

    The turn follows the estimate with a time constant, so that references stay continuous. A shift is not applied:
    references that begin at contact already have the right height.

    Args:
        inner: references on the believed surface.
        frame: contact frame.
        memory: time constant, s.

    Raises:
        ConfigError: a time constant that is not above zero.
    """

    def __init__(self, inner: ReferenceSource[Any], frame: str, memory: float = _MEMORY) -> None:
        if not (math.isfinite(memory) and memory > 0.0):
            raise ConfigError(f"the time constant of an estimated surface must be above zero (s), got {memory}")
        self.inner, self.frame, self.memory = inner, frame, memory

    def init(self, estimate: Estimate) -> EstimatedSurfaceState:
        return EstimatedSurfaceState(self.inner.init(estimate), estimate.time, np.zeros(3))

    def step(self, estimate: Estimate, state: EstimatedSurfaceState) -> tuple[Reference, EstimatedSurfaceState]:
        reference, inner = self.inner.step(estimate, state.inner)
        felt, turn = estimate.surfaces.get(self.frame), state.turn
        if felt is not None:
            share = -math.expm1(-max(estimate.time - state.time, 0.0) / self.memory)
            turn = turn + share * (felt.turn - turn)
            reference = turned(reference, exp3(turn), felt.pivot, self.frame)
        reference = changed(reference, diagnostics={**reference.diagnostics, "surface/turn": turn})
        return reference, EstimatedSurfaceState(inner, estimate.time, turn)


def turned(reference: Reference, R: Array, pivot: Array, frame: str) -> Reference:
    """A reference whose task of a frame is turned by R (3, 3) about a pivot (3,) m; postures stay."""
    tasks = tuple(_task(task, R, pivot) if task.frame == frame else task for task in reference.tasks)
    ahead = reference.preview
    return changed(reference, tasks=tasks, preview=None if ahead is None else _preview(ahead, R, pivot))


def _task(task: TaskReference, R: Array, pivot: Array) -> TaskReference:
    return changed(
        task,
        position=pivot + R @ (task.position - pivot),
        rotation=None if task.rotation is None else R @ task.rotation,
        velocity=_twist(R, task.velocity),
        acceleration=_twist(R, task.acceleration),
        wrench=_twist(R, task.wrench),
        task_rotation=None if task.task_rotation is None else R @ task.task_rotation,
    )


def _preview(ahead: Preview, R: Array, pivot: Array) -> Preview:
    return changed(
        ahead,
        position=pivot + (ahead.position - pivot) @ R.T,
        rotation=None if ahead.rotation is None else R @ ahead.rotation,
        velocity=_twist(R, ahead.velocity),
        wrench=_twist(R, ahead.wrench),
        task_rotation=None if ahead.task_rotation is None else R @ ahead.task_rotation,
    )


def _twist(R: Array, values: Array) -> Array:
    """Linear and angular part of (…, 6), turned."""
    return np.concatenate([values[..., :3] @ R.T, values[..., 3:] @ R.T], axis=-1)
