"""Targets that change at given times or by hand: inputs of planners and exploration."""

from __future__ import annotations

import bisect
import math
from collections.abc import Sequence
from dataclasses import dataclass

from pliant.errors import ConfigError
from pliant.frozen import changed
from pliant.interfaces import ReferenceSource
from pliant.signals import Estimate, Reference


@dataclass(frozen=True, slots=True)
class ScheduleState:
    """State between two ticks."""

    start: float
    """s"""
    index: int = 0
    """index of the active entry"""


class Schedule(ReferenceSource[ScheduleState]):
    """Swaps whole references at given times.

    Args:
        entries: (s since the start, reference), times increasing; the first one holds from the start.

    Raises:
        ConfigError: no entry, or times that do not increase.
    """

    def __init__(self, entries: Sequence[tuple[float, Reference]]) -> None:
        self._times = [float(time) for time, _ in entries]
        self._references = [reference for _, reference in entries]
        self._ends = [-math.inf, *self._times[1:], math.inf]
        """s at which each entry begins to hold, and then the last one's end"""
        if not entries or any(b <= a for a, b in zip(self._times[:-1], self._times[1:], strict=True)):
            raise ConfigError(f"a schedule needs entries at increasing times, got {self._times}")

    def init(self, estimate: Estimate) -> ScheduleState:
        return ScheduleState(estimate.time)

    def step(self, estimate: Estimate, state: ScheduleState) -> tuple[Reference, ScheduleState]:
        # 1 ns: a time that is a sum of periods may fall short of the entry's by rounding
        elapsed = estimate.time - state.start + 1e-9
        if not self._ends[state.index] <= elapsed < self._ends[state.index + 1]:
            state = ScheduleState(state.start, max(bisect.bisect_right(self._times, elapsed) - 1, 0))
        return changed(self._references[state.index], time=estimate.time), state

    def coming(self, state: ScheduleState, until: float) -> list[Reference]:
        """The changes of the reference up to a time in s. Each reference has the time from which it holds."""
        later = zip(self._times[state.index + 1 :], self._references[state.index + 1 :], strict=True)
        return [at_time(said, state.start + time) for time, said in later if state.start + time <= until]


class LatestReference(ReferenceSource[None]):
    """Gives the latest reference that was set by `put`, for sliders, teach pendants and other programs.

    `put` may be called from another thread; the loop takes the latest whole reference at its next tick.
    """

    def __init__(self, reference: Reference) -> None:
        self._latest = reference

    def put(self, reference: Reference) -> None:
        """Replaces the reference from the next tick on."""
        self._latest = reference

    @property
    def latest(self) -> Reference:
        """The latest reference; change it with `dataclasses.replace` and pass it to `put`."""
        return self._latest

    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, state: None) -> tuple[Reference, None]:
        return at_time(self._latest, estimate.time), None


def at_time(reference: Reference, time: float) -> Reference:
    """The same reference at another time, s."""
    return changed(reference, time=time)
