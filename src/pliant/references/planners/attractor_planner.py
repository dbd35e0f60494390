"""The harmonic attractor as a source of references: the planner of the paper beside the default one."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.frozen import changed
from pliant.interfaces import ReferenceSource
from pliant.references.planners.harmonic_attractor import AttractorPlan, AttractorSettings, advanced, retargeted, start
from pliant.references.planners.harmonic_planner import Place
from pliant.signals import Estimate, Reference, TaskReference
from pliant.spatial import Array


class AttractorPlannerState:
    """Owned by the loop: plans and last targets by frame, time of the last tick."""

    __slots__ = ("inner", "plans", "targets", "time")

    def __init__(self, inner: Any, time: float) -> None:
        self.inner, self.time = inner, time
        self.plans: dict[str, AttractorPlan] = {}
        self.targets: dict[str, Array] = {}


class AttractorPlanner(ReferenceSource[AttractorPlannerState]):
    """Positions by the attractor of [HapFIC] Tiseo et al. 2021, eq. 2-3; orientations pass unchanged. For comparison.

    Args:
        inner: targets.
        place: forward kinematics, `robot.placement`.
        settings: `printed=True` for the equations exactly as printed.
    """

    def __init__(self, inner: ReferenceSource[Any], place: Place, settings: AttractorSettings | None = None) -> None:
        self.inner, self.settings, self._place = inner, settings or AttractorSettings(), place

    def init(self, estimate: Estimate) -> AttractorPlannerState:
        return AttractorPlannerState(self.inner.init(estimate), estimate.time)

    def step(self, estimate: Estimate, state: AttractorPlannerState) -> tuple[Reference, AttractorPlannerState]:
        goal, state.inner = self.inner.step(estimate, state.inner)
        period, state.time = estimate.time - state.time, estimate.time
        tasks = tuple([self._planned(task, estimate, state, period) for task in goal.tasks])
        return changed(goal, tasks=tasks), state

    def _planned(
        self, task: TaskReference, estimate: Estimate, state: AttractorPlannerState, period: float
    ) -> TaskReference:
        plan = state.plans.get(task.frame)
        if plan is None:
            plan = start(tuple(self._place(np.array(estimate.q), task.frame)[0].tolist()))
        last = state.targets.get(task.frame)
        if last is None or not np.array_equal(last, task.position):
            plan, state.targets[task.frame] = (
                retargeted(plan, tuple(task.position.tolist()), self.settings),
                task.position,
            )
        before = plan
        plan = state.plans[task.frame] = advanced(plan, period, self.settings)
        velocity, acceleration = np.zeros(6), np.zeros(6)
        velocity[:3] = [axis.velocity for axis in plan.axes]
        if period > 0.0:
            acceleration[:3] = (velocity[:3] - [axis.velocity for axis in before.axes]) / period
        position = np.array([axis.position for axis in plan.axes])
        return changed(task, position=position, velocity=velocity, acceleration=acceleration)
