"""Curves beside what is pressed: in some phases of a list the frame goes round where the planner brings it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pliant.errors import ConfigError
from pliant.frozen import changed
from pliant.interfaces import ReferenceSource
from pliant.references.placed_phases import PlacedPhases, PlacedPhaseState
from pliant.references.planners.attractor_planner import AttractorPlanner
from pliant.references.planners.harmonic_planner import HarmonicPlanner, PlannerState
from pliant.references.trajectories.trajectory import Hold, Point, Trajectory
from pliant.signals import Estimate, Reference
from pliant.spatial import Array

Planner = HarmonicPlanner | AttractorPlanner
_NOWHERE = Hold(np.zeros(3)).at(0.0)


class PhaseCurve:
    """A curve about the target of a phase. After the phase it goes on and shrinks to nothing, twice continuously
    differentiable.

    Args:
        way: (3,) m from the target, zero and at rest when the phase begins.
        fade: s in which it is gone after the phase.

    Raises:
        ConfigError: it would be gone at once.
    """

    def __init__(self, way: Trajectory, fade: float) -> None:
        if not fade > 0.0:
            raise ConfigError(f"a curve beside a target is gone within more than 0 s, got {fade:g}")
        self.way, self.fade = way, fade

    def at(self, since: float, after: float) -> Point:
        """Its place and derivatives `since` s after its phase began and `after` s after it ended (below 0: before)."""
        value, rate, push = self.way.at(since)
        if after <= 0.0:
            return Point(value, rate, push)
        u, T = min(after / self.fade, 1.0), self.fade
        s, s_1 = 1.0 - u**3 * (10.0 - u * (15.0 - 6.0 * u)), -30.0 * (u * (1.0 - u)) ** 2 / T
        s_2 = -60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / T**2
        return Point(s * value, s * rate + s_1 * value, s * push + 2.0 * s_1 * rate + s_2 * value)


class PhaseTime(NamedTuple):
    """When a phase began and ended, s of the loop's clock."""

    number: int
    begin: float
    end: float = np.inf


@dataclass(frozen=True, slots=True)
class CurvedState:
    """State between two ticks."""

    inner: Any
    """of the planner"""
    times: tuple[PhaseTime, ...] = ()
    """of the phases whose curves have not faded yet, the present one last"""


class CurvedTargets(ReferenceSource[CurvedState]):
    """Adds curves to the motion that a planner makes of a list's targets, and to its preview.

    Args:
        planner: of the targets of `PlacedPhases`.
        curves: number of a phase → its curve.
    """

    def __init__(self, planner: Planner, curves: Mapping[int, PhaseCurve]) -> None:
        assert isinstance(planner.inner, PlacedPhases)
        self.planner, self.curves, self._phases = planner, dict(curves), planner.inner
        self._number = {phase.name: index for index, phase in enumerate(self._phases.phases)}

    def init(self, estimate: Estimate) -> CurvedState:
        return CurvedState(self.planner.init(estimate))

    def step(self, estimate: Estimate, state: CurvedState) -> tuple[Reference, CurvedState]:
        reference, inner = self.planner.step(estimate, state.inner)
        times = self._followed(state.times, inner.inner, estimate.time)
        (place, rate, push), task = self._off(times, estimate.time), reference.tasks[0]
        zero = np.zeros(3)
        moved = changed(
            task,
            position=task.position + place,
            velocity=task.velocity + np.concatenate([rate, zero]),
            acceleration=task.acceleration + np.concatenate([push, zero]),
        )
        preview = reference.preview
        if preview is not None:
            ahead = self._expected(times, inner.inner, float(preview.time[-1]))
            off = [self._off(ahead, time) for time in preview.time.tolist()]
            velocity = preview.velocity.copy()
            velocity[:, :3] += np.array([one.rate for one in off])
            position = preview.position + np.array([one.value for one in off])
            preview = changed(preview, position=position, velocity=velocity)
        return changed(reference, tasks=(moved, *reference.tasks[1:]), preview=preview), CurvedState(inner, times)

    def foreseen(self, goal: Reference, state: CurvedState, times: Array) -> list[Reference]:
        """As of the planner, with the curves. Raises ConfigError where the planner foresees nothing."""
        if not isinstance(self.planner, HarmonicPlanner):
            raise ConfigError("the way of an attractor planner is not known before it is gone")
        inner: PlannerState = state.inner
        ahead = self._expected(state.times, inner.inner, float(times[-1]))
        found: list[Reference] = []
        for one in self.planner.foreseen(goal, inner, times):
            task = one.tasks[0]
            place = task.position + self._off(ahead, one.time).value
            found.append(changed(one, tasks=(changed(task, position=place),)))
        return found

    def _off(self, times: Sequence[PhaseTime], time: float) -> Point:
        """How far the curves are from the targets at a time in s."""
        found = [
            self.curves[one.number].at(time - one.begin, time - one.end)
            for one in times
            if one.number in self.curves and one.begin <= time
        ]
        if not found:
            return _NOWHERE
        return Point(*(np.sum(part, axis=0) for part in zip(*found, strict=True)))

    def _followed(self, times: tuple[PhaseTime, ...], now: PlacedPhaseState, time: float) -> tuple[PhaseTime, ...]:
        """With the phase of now; what has faded is forgotten."""
        if times and times[-1].number == now.number:
            return times
        curved = [one for one in times[:-1] if one.number in self.curves]
        kept = [one for one in curved if time < one.end + self.curves[one.number].fade]
        left = [times[-1]._replace(end=now.begin)] if times and times[-1].number in self.curves else []
        return (*kept, *left, PhaseTime(now.number, now.begin))

    def _expected(self, times: tuple[PhaseTime, ...], now: PlacedPhaseState, until: float) -> list[PhaseTime]:
        """The phases up to a time in s, as far as they are known."""
        ahead = list(times)
        for one in self._phases.coming(now, until):
            number = self._number[one.phase]
            if number != ahead[-1].number:
                ahead[-1] = ahead[-1]._replace(end=one.time)
                ahead.append(PhaseTime(number, one.time))
        return ahead
