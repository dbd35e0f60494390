"""Targets and wrenches one after the other: each phase ends by time, contact, force, depth or place, not by timetable
alone; and what a user changes in between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError, RunFailedError
from pliant.interfaces import ReferenceSource
from pliant.references.build_up import BuildUp
from pliant.references.force_axes import task_axes
from pliant.robot import Robot
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import Array

_ROUNDING = 1e-9  # s; times are sums of periods


@dataclass(frozen=True)
class Ending:
    """What must hold together so that a phase ends."""

    duration: float = 0.0
    """s, at least, since it began"""
    contact: bool | None = None
    """whether contact is felt; None: either"""
    force: float | None = None
    """N along the phase's wrench, at least"""
    depth: float | None = None
    """m gone against the phase's wrench since it began, at least"""
    reached: float | None = None
    """m from the phase's target, at most"""
    fails: bool = False
    """whether the run is a failure when this ends the phase"""

    @property
    def by_time(self) -> bool:
        """Whether the clock alone decides."""
        return self.contact is None and self.force is None and self.depth is None and self.reached is None


@dataclass(frozen=True)
class PlacedPhase:
    """One target with a wrench. Raises ConfigError on construction where an ending needs a wrench and there is none."""

    name: str
    task: TaskReference
    endings: tuple[Ending, ...]
    """any of which is enough"""
    press: float = 0.0
    """s in which its force is reached from the first contact on, where nothing is touched when it begins; 0: at once"""

    def __post_init__(self) -> None:
        along = any(one.force is not None or one.depth is not None for one in self.endings)
        if along and not np.any(self.task.wrench[:3]):
            raise ConfigError(f"phase {self.name!r}: force and depth are along its wrench, which is zero")


@dataclass(frozen=True)
class PhaseChange:
    """From a time on something is different: a target or wrench until the next phase, the rest until the end."""

    time: float
    """s since the start of the run"""
    target: Array | None = None
    """(3,) m"""
    wrench: Array | None = None
    """(6,) N and N·m"""
    tuning: dict[str, Array] = field(default_factory=dict)
    """field of the impedance's tuning → value"""
    whole: dict[str, Any] = field(default_factory=dict)
    """field of the controller's whole tuning → value"""


class PlacedPhaseState(NamedTuple):
    """Where the list is."""

    number: int
    begin: float
    """s of the loop's clock when the phase began"""
    place: Array
    """(3,) m, of the frame when the phase began"""
    start: float
    """s when the list began"""
    done: int
    """changes that were made"""
    task: TaskReference
    whole: Any
    built: BuildUp = BuildUp()


class PlacedPhases(ReferenceSource[PlacedPhaseState]):
    """The phases in order; the last one lasts.

    Args:
        robot: whose frame moves.
        phases: at least one, all for the same frame.
        tuning: impedance that every reference carries; None: the controller's own.
        whole: tuning of the whole controller that every reference carries; None: its own.
        changes: in any order.

    Raises:
        ConfigError: no phase, or a change of an impedance or a tuning that there is not.
    """

    def __init__(
        self,
        robot: Robot,
        phases: Sequence[PlacedPhase],
        tuning: ImpedanceTuning | None = None,
        whole: Any = None,
        changes: Sequence[PhaseChange] = (),
    ) -> None:
        if not phases:
            raise ConfigError("a list of phases needs one at least")
        self.phases, self._whole = tuple(phases), whole
        self._tuning = tuning
        self.changes = tuple(sorted(changes, key=lambda change: change.time))
        self.frame = phases[0].task.frame
        self._model, self._data, self._frame_id = robot.model, robot.model.createData(), robot.frame_id(self.frame)
        self._seen: tuple[Estimate | None, Array] = None, np.zeros(3)
        """the last estimate whose place was worked out, and that place (3,) m"""
        if tuning is None and any(change.tuning for change in changes):
            raise ConfigError(f"the controller has no impedance at frame {self.frame!r} that an event could change")
        if whole is None and any(change.whole for change in changes):
            raise ConfigError("the controller has no parameters that references carry and an event could change")

    def init(self, estimate: Estimate) -> PlacedPhaseState:
        task = replace(self.phases[0].task, tuning=self._tuning)
        built = BuildUp(self.phases[0].press)
        return PlacedPhaseState(0, estimate.time, self._place(estimate), estimate.time, 0, task, self._whole, built)

    def step(self, estimate: Estimate, state: PlacedPhaseState) -> tuple[Reference, PlacedPhaseState]:
        """Raises RunFailedError where a timeout that is a failure ends a phase, or a bound of its force axes is
        passed."""
        state = self._changed(self._advanced(estimate, state), estimate.time)
        if np.isinf(state.built.touched) and estimate.contacts.get(self.frame, False):
            state = state._replace(built=state.built._replace(touched=estimate.time))
        self._kept(estimate, state)
        return self._said(estimate.time, state), state

    def coming(self, state: PlacedPhaseState, until: float) -> list[Reference]:
        """What will be said other than now up to a time in s, as far as it is known: a phase that ends by what is felt
        goes on. Each reference has the time from which it holds."""
        found: list[Reference] = []
        while True:
            clock, change = self._ends(state), self._next_change(state)
            time = min(clock, change)
            if time > until:
                return found
            # a change at the end of a phase is one of the phase that begins
            state = self._next(state, time, state.place) if clock <= change + _ROUNDING else self._changed(state, time)
            found.append(self._said(time, state))

    def _said(self, time: float, state: PlacedPhaseState) -> Reference:
        task, share = state.task, state.built.share(time)
        if share < 1.0:
            task = replace(task, wrench=share * task.wrench)
        return Reference(time, (task,), phase=self.phases[state.number].name, tuning=state.whole)

    def _ends(self, state: PlacedPhaseState) -> float:
        """s at which the clock alone ends the phase; infinite where it does not."""
        if state.number + 1 == len(self.phases):
            return np.inf
        sure = [one.duration for one in self.phases[state.number].endings if one.by_time and not one.fails]
        return state.begin + min(sure, default=np.inf)

    def _next_change(self, state: PlacedPhaseState) -> float:
        return state.start + self.changes[state.done].time if state.done < len(self.changes) else np.inf

    def _next(self, state: PlacedPhaseState, time: float, place: Array) -> PlacedPhaseState:
        task = replace(self.phases[state.number + 1].task, tuning=state.task.tuning)
        return state._replace(number=state.number + 1, begin=time, place=place, task=task)

    def _advanced(self, estimate: Estimate, state: PlacedPhaseState) -> PlacedPhaseState:
        ending = next((one for one in self.phases[state.number].endings if self._holds(one, estimate, state)), None)
        if ending is None:
            return state
        if ending.fails:
            raise RunFailedError(
                f"phase {self.phases[state.number].name!r} did not end within {ending.duration:g} s, and else = 'fail'"
            )
        if state.number + 1 == len(self.phases):
            return state
        after = self._next(state, estimate.time, self._place(estimate))
        press = self.phases[after.number].press
        if press == 0.0 or estimate.contacts.get(self.frame, False):
            return after
        return after._replace(built=BuildUp(press))

    def _kept(self, estimate: Estimate, state: PlacedPhaseState) -> None:
        """Raises RunFailedError where the frame has moved farther along force axes than the phase allows."""
        modes = state.task.modes
        if modes is None or np.isinf(modes.deviation):
            return
        way = modes.rotation.T @ (self._place(estimate) - state.place)
        gone = float(np.linalg.norm(way[list(modes.having("force")[:3])]))
        if gone > modes.deviation:
            raise RunFailedError(
                f"phase {self.phases[state.number].name!r} moved {1e3 * gone:.1f} mm along its force axes, and"
                f" limit.deviation allows {1e3 * modes.deviation:g} mm: is what it should touch where it was believed?"
            )

    def _holds(self, ending: Ending, estimate: Estimate, state: PlacedPhaseState) -> bool:
        if estimate.time - state.begin < ending.duration - _ROUNDING:
            return False
        if ending.contact is not None and estimate.contacts.get(self.frame, False) is not ending.contact:
            return False
        wrench = state.task.wrench[:3]
        size = float(np.linalg.norm(wrench))
        if ending.force is not None and size > 0.0:
            felt = estimate.wrenches.get(self.frame)
            if felt is None or float(felt[:3] @ wrench) < ending.force * size:
                return False
        if ending.depth is None and ending.reached is None:
            return True
        here = self._place(estimate)
        if ending.reached is not None and float(np.linalg.norm(here - state.task.position)) > ending.reached:
            return False
        gone = 0.0 if size == 0.0 else float((state.place - here) @ wrench) / size
        return ending.depth is None or gone >= ending.depth

    def _changed(self, state: PlacedPhaseState, time: float) -> PlacedPhaseState:
        while state.done < len(self.changes) and self.changes[state.done].time <= time - state.start + _ROUNDING:
            change, task = self.changes[state.done], state.task
            if change.target is not None:
                task = replace(task, position=change.target)
            if change.wrench is not None:
                axes = task_axes(np.eye(3) if task.task_rotation is None else task.task_rotation, change.wrench)
                axes = task.task_rotation if axes is None else axes
                modes = None if task.modes is None else task.modes.pressing(change.wrench)
                task = replace(task, wrench=change.wrench, task_rotation=axes, modes=modes)
            if change.tuning and task.tuning is not None:
                task = replace(task, tuning=replace(task.tuning, **change.tuning))
            whole = state.whole.model_copy(update=change.whole) if change.whole else state.whole
            state = state._replace(done=state.done + 1, task=task, whole=whole)
        return state

    def _place(self, estimate: Estimate) -> Array:
        if self._seen[0] is not estimate:
            pin.forwardKinematics(self._model, self._data, estimate.q)
            pose = pin.updateFramePlacement(self._model, self._data, self._frame_id)
            self._seen = estimate, np.array(pose.translation)
        return self._seen[1]
