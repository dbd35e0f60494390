"""References that users change during a run."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from pliant.interfaces import ReferenceSource
from pliant.live.loop.requests import SharedState
from pliant.references.exploration.haptic_exploration import HapticExploration
from pliant.signals import Estimate, ImpedanceTuning, Preview, Reference, TaskReference
from pliant.spatial import Array

SPEED_RATE_LIMIT = 1.0  # 1/s, largest rate of change of the task's speed factor
TARGET_SPEED = 0.5  # m/s: a target that jumps would put energy into the robot that no ledger books


class Shift(NamedTuple):
    """Present offset of the first task."""

    offset: Array
    """(3,) m"""
    velocity: Array
    """(3,) m/s with which it changes"""
    force_scale: float


class SteeredSourceState(NamedTuple):
    """State of the inner source, and the offset of the target."""

    inner: Any
    time: float
    """s of the last step"""
    offset: Array
    """(3,) m"""
    clock: float
    """s of the task"""
    rate: float = 1.0
    """s of the task a second"""


class SteeredSource(ReferenceSource[SteeredSourceState]):
    """References of another source with the requested changes: tunings, offset of the target, force. The offset moves
    at `TARGET_SPEED` at most; tunings and force are swapped whole between two ticks. Where the speed of the task is
    changed, the inner source has a clock of its own, whose rate changes by `SPEED_RATE_LIMIT` at most.

    Args:
        inner: where the references come from.
        shared: read once a step; the offset of the target is written to it.
    """

    def __init__(self, inner: ReferenceSource[Any], shared: SharedState) -> None:
        self.inner, self._shared = inner, shared

    def init(self, estimate: Estimate) -> SteeredSourceState:
        return SteeredSourceState(self.inner.init(estimate), estimate.time, np.zeros(3), estimate.time)

    def step(self, estimate: Estimate, state: SteeredSourceState) -> tuple[Reference, SteeredSourceState]:
        requests, duration = self._shared.requests, estimate.time - state.time
        most = SPEED_RATE_LIMIT * max(duration, 0.0)
        rate = state.rate + min(max(requests.scaling.speed - state.rate, -most), most)
        real = state.rate == rate == 1.0 and state.clock == state.time
        clock = estimate.time if real else state.clock + 0.5 * (state.rate + rate) * duration
        reference, inner = self.inner.step(estimate if real else replace(estimate, time=clock), state.inner)
        if not real:
            bend = (rate - state.rate) / duration if duration > 0.0 else 0.0
            reference = _on_clock(reference, estimate.time, rate, bend)
        self._shared.clock = clock
        force = requests.aim.force_scale * requests.scaling.force
        shift = _moved(state.offset, np.array(requests.aim.offset), duration, force)
        self._shared.offset = shift.offset
        if requests.tunings:
            reference = _retuned(reference, requests.tunings)
        if requests.whole is not None:
            reference = replace(reference, tuning=requests.whole)
        if reference.tasks and (shift.force_scale != 1.0 or np.any(shift.offset) or np.any(shift.velocity)):
            reference = _shifted(reference, shift)
        return reference, SteeredSourceState(inner, estimate.time, shift.offset, clock, rate)


def steered(source: ReferenceSource[Any], shared: SharedState) -> ReferenceSource[Any]:
    """A source with the requested changes; in front of an exploration, they are applied to the input of the
    exploration."""
    if isinstance(source, HapticExploration):
        exploring = copy.copy(source)
        exploring.inner = SteeredSource(source.inner, shared)
        return exploring
    return SteeredSource(source, shared)


def _moved(offset: Array, wanted: Array, duration: float, force_scale: float) -> Shift:
    """One step towards the requested offset."""
    way = wanted - offset
    distance = float(np.linalg.norm(way))
    if distance == 0.0 or duration <= 0.0:
        return Shift(offset, np.zeros(3), force_scale)
    step = way * min(1.0, TARGET_SPEED * duration / distance)
    return Shift(wanted if distance <= TARGET_SPEED * duration else offset + step, step / duration, force_scale)


def _on_clock(reference: Reference, time: float, rate: float, bend: float) -> Reference:
    """A reference of a clock with another rate, converted to the clock of the loop. Args: bend: 1/s, derivative of the
    rate."""
    tasks = tuple(
        replace(
            task,
            velocity=rate * task.velocity,
            acceleration=rate * rate * task.acceleration + bend * task.velocity,
        )
        for task in reference.tasks
    )
    preview = reference.preview
    if preview is not None:
        times = time + (preview.time - reference.time) / rate
        preview = replace(preview, time=times, velocity=rate * preview.velocity)
    return replace(reference, time=time, tasks=tasks, preview=preview)


def _retuned(reference: Reference, tunings: Mapping[str, ImpedanceTuning]) -> Reference:
    tasks = [replace(task, tuning=tunings.get(task.frame, task.tuning)) for task in reference.tasks]
    return replace(reference, tasks=tuple(tasks))


def _shifted(reference: Reference, shift: Shift) -> Reference:
    first, *others = reference.tasks
    preview = reference.preview and _shifted_preview(reference.preview, shift)
    return replace(reference, tasks=(_shifted_task(first, shift), *others), preview=preview)


def _shifted_task(task: TaskReference, shift: Shift) -> TaskReference:
    twist = task.velocity.copy()
    twist[:3] += shift.velocity
    return replace(task, position=task.position + shift.offset, velocity=twist, wrench=shift.force_scale * task.wrench)


def _shifted_preview(preview: Preview, shift: Shift) -> Preview:
    return replace(preview, position=preview.position + shift.offset, wrench=shift.force_scale * preview.wrench)
