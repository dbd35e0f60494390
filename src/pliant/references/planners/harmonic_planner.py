"""Harmonic planner: turns targets that jump into smooth motion; targets may change at any time."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant._references import superposed, turning
from pliant.errors import ConfigError, SignalError
from pliant.frozen import changed
from pliant.interfaces import Lookahead, ReferenceSource
from pliant.references.foreseen import Coming, instants, preview_of
from pliant.references.planners.superposition import MotionLimits, Superposition
from pliant.references.planners.workspace import Workspace
from pliant.references.trajectories.trajectory import vector
from pliant.signals import Estimate, Reference, TaskReference
from pliant.spatial import Array, exp3, log3

_STEADY = 0.02  # s: a target that moves continuously is updated at 50 Hz
_ROUNDING = 1e-9  # s; times are sums of periods
_ANGULAR_STEP = 1e-4  # s, for the difference that gives the angular acceleration
_REST = vector(np.zeros(6), "rest")

Place = Callable[[Array, str], tuple[Array, Array]]
"""(q, frame) → position (3,) m and R_world_frame (3, 3), such as `Robot.placement`"""


@dataclass(frozen=True)
class PlannerLimits:
    """Limits of the planned motion; the sum of overlapping pieces keeps them."""

    linear: MotionLimits = MotionLimits(speed=0.3, acceleration=3.0)  # noqa: RUF009
    """m/s and m/s²"""
    angular: MotionLimits = MotionLimits(speed=1.0, acceleration=10.0)  # noqa: RUF009
    """rad/s and rad/s²"""


class PlannedFrame:
    """Plans of one frame. Changed in place by the planner that owns it."""

    __slots__ = (
        "base", "channel", "clamped", "linear", "placed", "position", "resting", "rotation", "still", "taken", "turn"
    )  # fmt: skip

    def __init__(self, name: str, position: Array, rotation: Array) -> None:
        self.channel = f"planner/{name}/clamped"
        self.linear = Superposition(_floats(position))
        self.turn = Superposition((0.0, 0.0, 0.0))
        """rotation vector of R·baseᵀ, rad"""
        self.base = rotation
        self.clamped: Array = np.zeros(3)
        """shift of the last target into the workspace, m"""
        self.position: Array | None = None
        """last target"""
        self.rotation: Array | None = None
        self.taken = -np.inf
        """s at which the last target was taken"""
        self.resting: tuple[Array, Array] | None = None
        """pose while at rest"""
        self.placed: tuple[TaskReference, TaskReference] | None = None
        """the last target, and what became of it"""
        self.still: tuple[TaskReference, TaskReference] | None = None
        """the same, while at rest on that target"""


class PlannerState:
    """Owned by the loop."""

    __slots__ = ("clamped", "first", "frames", "inner", "next_look")

    def __init__(self, inner: Any, first: Array) -> None:
        self.inner, self.first = inner, first
        self.frames: dict[str, PlannedFrame] = {}
        self.clamped: dict[str, Array] = {}
        """channel → shift (3,) m of the last target; another one where a shift changes"""
        self.next_look = -np.inf
        """s at which a preview is due"""


class HarmonicPlanner(ReferenceSource[PlannerState]):
    """Smooths the targets of another source; each frame starts where the robot is.

    When a target of the inner source changes, the motion goes to the new one: from rest along a
    straight line with a half cosine over time; on the way by superposition (see `superposition`), so that it never
    leaves the hull of its start and the targets so far. Wrench, tuning and posture of the inner reference pass
    unchanged; a change of the target within 20 ms of another one is delayed until then; the latest one counts.

    Args:
        inner: targets; the velocities that it gives are ignored.
        place: forward kinematics, `robot.placement`; called once per frame, when it first appears.
        limits: of speed and acceleration.
        workspaces: frame → where its targets may lie. A target outside is moved to the boundary; the shift is in the
            channel `planner/FRAME/clamped` (3,) m of `Reference.diagnostics`.
        lookahead: of a preview of the first task, with the targets that the inner source knows; None for none.

    Raises:
        ConfigError: a preview is wanted and the inner source does not say what is `coming`.
    """

    def __init__(
        self,
        inner: ReferenceSource[Any],
        place: Place,
        limits: PlannerLimits | None = None,
        workspaces: Mapping[str, Workspace] | None = None,
        lookahead: Lookahead | None = None,
    ) -> None:
        if lookahead is not None and not hasattr(inner, "coming"):
            raise ConfigError(
                f"a preview needs a source whose next references are known, and those of {type(inner).__name__} are not"
            )
        self.inner, self.limits, self._place = inner, limits or PlannerLimits(), place
        self.workspaces, self.lookahead = dict(workspaces or {}), lookahead

    def init(self, estimate: Estimate) -> PlannerState:
        return PlannerState(self.inner.init(estimate), np.array(estimate.q))

    def step(self, estimate: Estimate, state: PlannerState) -> tuple[Reference, PlannerState]:
        """The inner reference with planned poses and twists. Raises SignalError for a target that is not finite."""
        goal, state.inner = self.inner.step(estimate, state.inner)
        tasks: list[TaskReference] = []
        for task in goal.tasks:
            frame = state.frames.get(task.frame)
            still = None if frame is None else frame.still
            planned = self._planned(task, estimate, state) if still is None or still[0] is not task else still[1]
            tasks.append(planned)
        diagnostics = goal.diagnostics
        if self.workspaces:
            diagnostics = {**diagnostics, **state.clamped} if diagnostics else state.clamped
        found = changed(goal, tasks=tuple(tasks), diagnostics=diagnostics)
        ahead = self.lookahead
        if ahead is not None and ahead.due(estimate.time, state.next_look):
            state.next_look = estimate.time + ahead.every
            found = changed(found, preview=preview_of(self.foreseen(goal, state, instants(estimate.time, ahead))))
        return found, state

    def foreseen(self, goal: Reference, state: PlannerState, times: Array) -> list[Reference]:
        """The references of the first task at later times, s, increasing, with the targets that are known now.

        Args: goal: the inner source's last reference; state: after it was planned.
        """
        inner: Coming = self.inner  # type: ignore[assignment]  # checked when it was given
        name = goal.tasks[0].frame
        frame, now = copy.copy(state.frames[name]), goal
        waiting = list(inner.coming(state.inner, float(times[-1]) + _ROUNDING))
        found: list[Reference] = []
        for time in times.tolist():
            while waiting and waiting[0].time <= time + _ROUNDING:
                self._take(now.tasks[0], frame, min(max(now.time, frame.taken + _STEADY), waiting[0].time))
                now = waiting.pop(0)
            self._take(now.tasks[0], frame, min(max(now.time, frame.taken + _STEADY), time))
            found.append(Reference(time, (_placed(now.tasks[0], frame, time),), now.posture, now.phase))
        return found

    def _take(self, task: TaskReference, frame: PlannedFrame, time: float) -> None:
        """Accepts a target that has changed, if the last change is old enough."""
        if self._is_new(task, frame) and time >= frame.taken + _STEADY:
            self._retarget(task, frame, time)

    def _planned(self, task: TaskReference, estimate: Estimate, state: PlannerState) -> TaskReference:
        frame = state.frames.get(task.frame)
        if frame is None:
            frame = state.frames[task.frame] = PlannedFrame(task.frame, *self._place(np.array(estimate.q), task.frame))
        if task.position is not frame.position or task.rotation is not frame.rotation:
            self._take(task, frame, estimate.time)
        placed = _placed(task, frame, estimate.time)
        rests = frame.resting is not None and task.position is frame.position and task.rotation is frame.rotation
        frame.still = (task, placed) if rests else None
        if state.clamped.get(frame.channel) is not frame.clamped:
            state.clamped = {**state.clamped, frame.channel: frame.clamped}
        return placed

    @staticmethod
    def _is_new(task: TaskReference, frame: PlannedFrame) -> bool:
        moved = not _same(task.position, frame.position)
        return moved or not (task.rotation is None or _same(task.rotation, frame.rotation))

    def _retarget(self, task: TaskReference, frame: PlannedFrame, time: float) -> None:
        """Takes a new target; position and orientation arrive together where they start together."""
        if not np.isfinite(task.position).all() or (task.rotation is not None and not np.isfinite(task.rotation).all()):
            raise SignalError(f"the target of frame {task.frame!r} is not finite: {task.position.tolist()}")
        workspace = self.workspaces.get(task.frame)
        allowed = task.position if workspace is None else workspace.nearest(task.position)
        frame.clamped = task.position - allowed
        target = _floats(allowed)
        turn = frame.turn.target
        if task.rotation is not None:
            if not frame.turn.folded(time).pieces:
                frame.base, frame.turn = _rotation(frame, time), Superposition((0.0, 0.0, 0.0))
            turn = _nearest(log3(task.rotation @ frame.base.T), frame.turn.target)
            frame.rotation = task.rotation
        way = float(np.linalg.norm(np.subtract(target, frame.linear.target)))
        angle = float(np.linalg.norm(np.subtract(turn, frame.turn.target)))
        linear = self.limits.linear.bounded(task.modes, np.subtract(target, frame.linear.target))
        least = max(linear.duration(way), self.limits.angular.duration(angle))
        frame.linear = frame.linear.retargeted(time, target, linear, least)
        frame.turn = frame.turn.retargeted(time, turn, self.limits.angular, least)
        frame.position, frame.taken, frame.resting, frame.still = task.position, time, None, None


def _placed(task: TaskReference, frame: PlannedFrame, time: float) -> TaskReference:
    """The task of a target, at its planned pose."""
    if frame.resting is not None and frame.placed is not None and frame.placed[0] is task:
        return frame.placed[1]
    (position, turned), velocity, acceleration = _now(frame, time)
    rotation = None if task.rotation is None else turned
    placed = changed(task, position=position, rotation=rotation, velocity=velocity, acceleration=acceleration)
    frame.placed = task, placed
    return placed


def _now(frame: PlannedFrame, time: float) -> tuple[tuple[Array, Array], Array, Array]:
    """Pose, twist (6,) and its derivative (6,) of a planned frame."""
    if frame.resting is not None:
        return frame.resting, _REST, _REST
    frame.linear, frame.turn = frame.linear.folded(time), frame.turn.folded(time)
    position, velocity, acceleration = superposed(frame.linear.base, frame.linear.pieces, time, 6)
    pose = (position, _rotation(frame, time))
    if frame.turn.pieces:
        velocity[3:], acceleration[3:] = turning(frame.turn.base, frame.turn.pieces, time, _ANGULAR_STEP)
    elif not frame.linear.pieces:
        frame.resting = pose
    return pose, velocity, acceleration


def _rotation(frame: PlannedFrame, time: float) -> Array:
    turn = frame.turn.at(time).position if frame.turn.pieces else frame.turn.base
    return exp3(turn) @ frame.base if any(turn) else frame.base


def _nearest(turn: Array, last: tuple[float, ...]) -> tuple[float, ...]:
    """Of the rotation vectors of one rotation, r and r − 2π r/|r|, the one nearer to the last target."""
    angle = float(np.linalg.norm(turn))
    if angle < 1e-9:
        return tuple(turn.tolist())
    other = turn * (1.0 - 2.0 * np.pi / angle)
    return tuple((turn if np.linalg.norm(turn - last) <= np.linalg.norm(other - last) else other).tolist())


def _same(a: Array, b: Array | None) -> bool:
    return a is b or (b is not None and bool((a == b).all()))


def _floats(values: Array) -> tuple[float, ...]:
    return tuple(values.tolist())
