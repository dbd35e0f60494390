"""Changes of impedance parameters at given times during a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from pliant.compiled import KnownReferences, face_of
from pliant.interfaces import ReferenceSource
from pliant.signals import Estimate, ImpedanceTuning, Reference
from pliant.spatial import Array


@dataclass(frozen=True)
class TuningChange:
    """A new tuning of the task at a frame, from a time on."""

    time: float
    """s since the start of the run"""
    frame: str
    tuning: ImpedanceTuning


class RetunedState(NamedTuple):
    """State of the inner source, and the active tunings."""

    inner: Any
    done: int
    """changes that were made"""
    tunings: dict[str, ImpedanceTuning]
    """frame → active tuning"""


class RetunedReferences(KnownReferences):
    """References with changed tunings, up to the next change.

    Args:
        inner: the references inside.
        tunings: frame → active tuning.
        until: s of the loop's clock, the next change.
    """

    def __init__(self, inner: KnownReferences, tunings: Mapping[str, ImpedanceTuning], until: float) -> None:
        self.inner, self.size, self._tunings, self._until = inner, inner.size, tunings, until
        self.ahead, self.names = inner.ahead, inner.names

    def reference(self, time: float, numbers: Array) -> Reference:
        return _retuned(self.inner.reference(time, numbers), self._tunings)

    def fill(self, times: Array, rows: Array) -> int:
        count = int(np.searchsorted(times, self._until))
        return self.inner.fill(times[:count], rows[:count])

    def after(self, state: RetunedState, ticks: int) -> RetunedState:
        return state._replace(inner=self.inner.after(state.inner, ticks))


def _retuned(reference: Reference, tunings: Mapping[str, ImpedanceTuning]) -> Reference:
    if not tunings:
        return reference
    tasks = [replace(task, tuning=tunings[task.frame]) if task.frame in tunings else task for task in reference.tasks]
    return replace(reference, tasks=tuple(tasks))


class Retuned(ReferenceSource[RetunedState]):
    """Another source's references with changed tunings, replaced as a whole between two ticks.

    Args:
        inner: where the references come from.
        changes: in any order.
    """

    def __init__(self, inner: ReferenceSource[Any], changes: Sequence[TuningChange]) -> None:
        self.inner = inner
        self.changes = tuple(sorted(changes, key=lambda change: change.time))

    def init(self, estimate: Estimate) -> RetunedState:
        return RetunedState(self.inner.init(estimate), 0, {})

    def step(self, estimate: Estimate, state: RetunedState) -> tuple[Reference, RetunedState]:
        reference, inner = self.inner.step(estimate, state.inner)
        done, tunings = state.done, state.tunings
        while done < len(self.changes) and self.changes[done].time <= estimate.time:
            tunings = tunings | {self.changes[done].frame: self.changes[done].tuning}
            done += 1
        return _retuned(reference, tunings), RetunedState(inner, done, tunings)

    def compiled_face(self, estimate: Estimate, state: RetunedState) -> RetunedReferences | None:
        inner = face_of(self.inner, KnownReferences, estimate, state.inner)
        until = self.changes[state.done].time if state.done < len(self.changes) else np.inf
        return None if inner is None else RetunedReferences(inner, state.tunings, until)
