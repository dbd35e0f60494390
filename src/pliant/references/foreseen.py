"""A preview for sources whose references are functions of time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, Protocol

import numpy as np

from pliant.interfaces import Lookahead, ReferenceSource
from pliant.signals import Estimate, Preview, Reference
from pliant.spatial import Array


class Timed(Protocol):
    """A source whose reference is known at any time."""

    def at(self, time: float, elapsed: float) -> Reference:
        """The reference at `time` of the loop's clock, `elapsed` s after the start."""
        ...


class Coming(Protocol):
    """A source whose next references are known."""

    def coming(self, state: Any, until: float) -> Sequence[Reference]:
        """Its next references, each with the s from which it holds."""
        ...


class Looked(NamedTuple):
    """When a source was started, and when a preview is due."""

    time: float
    """s of the loop's clock"""
    next_look: float
    """s"""


class Foreseen(ReferenceSource[Looked]):
    """A timed source's references with a preview of its first task.

    Args:
        inner: where the references come from.
        lookahead: instants of the preview.
    """

    def __init__(self, inner: Timed, lookahead: Lookahead) -> None:
        self.inner, self.lookahead = inner, lookahead

    def init(self, estimate: Estimate) -> Looked:
        return Looked(estimate.time, -np.inf)

    def step(self, estimate: Estimate, state: Looked) -> tuple[Reference, Looked]:
        elapsed, ahead = estimate.time - state.time, self.lookahead
        now = self.inner.at(estimate.time, elapsed)
        if not ahead.due(estimate.time, state.next_look):
            return now, state
        delays = (instants(estimate.time, ahead) - estimate.time).tolist()
        later = [self.inner.at(estimate.time + delay, elapsed + delay) for delay in delays]
        return replace(now, preview=preview_of(later)), Looked(state.time, estimate.time + ahead.every)


def instants(time: float, lookahead: Lookahead) -> Array:
    """(N+1,) s of the loop's clock, of a preview that is made at `time`."""
    return time + lookahead.lead + lookahead.step * np.arange(lookahead.nodes + 1, dtype=np.float64)


def preview_of(later: Sequence[Reference]) -> Preview:
    """The first task of later references, at least one, as a preview. Orientation is free where one leaves it free."""
    tasks = [reference.tasks[0] for reference in later]
    rotations = [task.rotation for task in tasks if task.rotation is not None]
    postures = [reference.posture for reference in later if reference.posture is not None]
    axes = [np.eye(3) if task.task_rotation is None else task.task_rotation for task in tasks]
    turning = any(task.task_rotation is not None for task in tasks)
    return Preview(
        time=np.array([reference.time for reference in later]),
        position=np.array([task.position for task in tasks]),
        rotation=np.array(rotations) if len(rotations) == len(tasks) else None,
        velocity=np.array([task.velocity for task in tasks]),
        wrench=np.array([task.wrench for task in tasks]),
        phase=tuple(reference.phase for reference in later),
        posture=np.array(postures) if len(postures) == len(later) else None,
        task_rotation=np.array(axes) if turning else None,
    )
