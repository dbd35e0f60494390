"""Changes of impedance parameters at given times during a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from pliant.interfaces import ReferenceSource
from pliant.signals import Estimate, ImpedanceTuning, Reference


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
        if tunings:
            tasks = tuple(
                replace(task, tuning=tunings[task.frame]) if task.frame in tunings else task for task in reference.tasks
            )
            reference = replace(reference, tasks=tasks)
        return reference, RetunedState(inner, done, tunings)
