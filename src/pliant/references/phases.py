"""A task in phases, as data: reach, track, touch, press, draw; by timetable or by contact that is found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError, ShapeError
from pliant.interfaces import ReferenceSource
from pliant.references.trajectories.trajectory import Trajectory
from pliant.robot import Robot
from pliant.signals import Estimate, Preview, Reference, TaskReference
from pliant.spatial import Array

Anchor = Literal["world", "begin", "touch"]


@dataclass(frozen=True)
class TaskPhase:
    """One phase of a task. Its trajectories count time from the start of the phase."""

    name: str
    motion: Trajectory
    """(3,) m; what it is measured from says `anchor`"""
    anchor: Anchor = "world"
    """"world": absolute; "begin": from where the reference was when the phase began; "touch": from where the frame was
    when the last phase in which `touches` is new began"""
    wrench: Trajectory | None = None
    """(6,) desired reaction of the environment, N and N·m; None for zero"""
    duration: float = math.inf
    """s"""
    ends_on_contact: bool = False
    """the phase lasts until the estimate says that the frame touches, whatever its duration"""
    touches: bool = False
    """the frame is in contact in this phase"""

    def __post_init__(self) -> None:
        if self.motion.size != 3:
            raise ShapeError(f"the motion of phase {self.name!r} must have 3 entries, got {self.motion.size}")
        if self.wrench is not None and self.wrench.size != 6:
            raise ShapeError(f"the wrench of phase {self.name!r} must have 6 entries, got {self.wrench.size}")
        if not self.duration > 0.0:
            raise ConfigError(f"the duration of phase {self.name!r} must be above zero, got {self.duration}")


@dataclass(frozen=True)
class Lookahead:
    """Instants of a preview."""

    nodes: int
    """N: there are N + 1 instants"""
    step: float
    """s between them"""
    lead: float = 0.0
    """s from now to the first of them: commands that take effect later want later references"""


@dataclass(frozen=True, slots=True)
class PhaseState:
    """Which phase the task is in."""

    index: int
    start: float
    """s at which it began"""
    begin: Array
    """(3,) m reference position at that time"""
    touch: Array
    """(3,) m where the frame was when contact began"""


class PhasedSource(ReferenceSource[PhaseState]):
    """Plays the phases of a task for one frame, with a preview in which each node has the phase of its own time.

    A phase that ends on contact has no known end: until then the preview goes on with it.

    Args:
        robot: gives the frame's position, to anchor phases where contact was made.
        frame: the controlled frame.
        phases: in order; the last one holds.
        rotation: R_world_frame (3, 3) throughout.
        lookahead: of the preview; None for none.
        posture: (n,) joint configuration that goes with the whole task, rad; None for none.

    Raises:
        ConfigError: no phase, or two of one name.
        RobotError: a frame that the robot does not have.
    """

    def __init__(
        self,
        robot: Robot,
        frame: str,
        phases: Sequence[TaskPhase],
        rotation: Array,
        lookahead: Lookahead | None = None,
        posture: Array | None = None,
    ) -> None:
        names = [phase.name for phase in phases]
        if not names or len(set(names)) < len(names):
            raise ConfigError(f"a task needs at least one phase and different names, got {names}")
        self.frame, self.phases, self.rotation, self.lookahead = frame, tuple(phases), rotation, lookahead
        self._model, self._data = robot.model, robot.model.createData()
        self._frame_id = robot.frame_id(frame)
        self.posture = None if posture is None else robot.vector(posture, "the posture")

    def init(self, estimate: Estimate) -> PhaseState:
        here = self._position(estimate.q)
        return PhaseState(0, estimate.time, here, here)

    def step(self, estimate: Estimate, state: PhaseState) -> tuple[Reference, PhaseState]:
        state = self._advanced(estimate, state)
        now = self._task(state, estimate.time)
        phase = self.phases[state.index].name
        preview = self._preview(state, estimate.time)
        return Reference(estimate.time, (now,), self.posture, phase, preview), state

    # ------------------------------------------------------------------ inside

    def _advanced(self, estimate: Estimate, state: PhaseState) -> PhaseState:
        """The phase of now, as the clock and the contact say."""
        while state.index + 1 < len(self.phases):
            phase = self.phases[state.index]
            if phase.ends_on_contact:
                if not estimate.contacts.get(self.frame, False):
                    break
                start = estimate.time
            else:
                start = state.start + phase.duration
                if estimate.time < start - 1e-9:
                    break
            touched = self.phases[state.index + 1].touches and not phase.touches
            after = self._next(state, start)
            state = replace(after, touch=self._position(estimate.q)) if touched else after
        return state

    def _next(self, state: PhaseState, start: float) -> PhaseState:
        """The following phase, beginning at `start`; contact, if it is new, is expected where the reference is."""
        position = self._task(state, start).position
        new = self.phases[state.index + 1].touches and not self.phases[state.index].touches
        return PhaseState(state.index + 1, start, position, position if new else state.touch)

    def _expected(self, state: PhaseState, time: float) -> PhaseState:
        """The phase of a later time, as far as it can be known now."""
        while state.index + 1 < len(self.phases):
            phase = self.phases[state.index]
            if phase.ends_on_contact or time < state.start + phase.duration - 1e-9:
                break
            state = self._next(state, state.start + phase.duration)
        return state

    def _task(self, state: PhaseState, time: float) -> TaskReference:
        phase = self.phases[state.index]
        elapsed = max(time - state.start, 0.0)
        point = phase.motion.at(elapsed)
        offset = {"world": 0.0, "begin": state.begin, "touch": state.touch}[phase.anchor]
        velocity, acceleration = np.zeros(6), np.zeros(6)
        velocity[:3], acceleration[:3] = point.rate, point.acceleration
        task = TaskReference(self.frame, point.value + offset, self.rotation, velocity, acceleration)
        return task if phase.wrench is None else replace(task, wrench=phase.wrench.at(elapsed).value)

    def _preview(self, state: PhaseState, time: float) -> Preview | None:
        if self.lookahead is None:
            return None
        times = time + self.lookahead.lead + self.lookahead.step * np.arange(self.lookahead.nodes + 1, dtype=np.float64)
        tasks: list[TaskReference] = []
        names: list[str] = []
        for instant in times.tolist():
            state = self._expected(state, instant)
            tasks.append(self._task(state, instant))
            names.append(self.phases[state.index].name)
        return Preview(
            time=times,
            position=np.array([task.position for task in tasks]),
            rotation=np.tile(self.rotation, (len(times), 1, 1)),
            velocity=np.array([task.velocity for task in tasks]),
            wrench=np.array([task.wrench for task in tasks]),
            phase=tuple(names),
            posture=None if self.posture is None else np.tile(self.posture, (len(times), 1)),
        )

    def _position(self, q: Array) -> Array:
        pin.framesForwardKinematics(self._model, self._data, q)
        return np.array(self._data.oMf[self._frame_id].translation)
