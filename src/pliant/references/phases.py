"""References of a task in phases, which change by time or by contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError, RunFailedError
from pliant.frozen import changed
from pliant.interfaces import Lookahead, ReferenceSource
from pliant.references.foreseen import instants
from pliant.references.landing import Height
from pliant.references.preview_rows import Moved, packed, preview_of_rows
from pliant.references.task_phase import TaskPhase as TaskPhase
from pliant.references.trajectories.rotation import Orientation, third_axis
from pliant.references.trajectories.trajectory import vector
from pliant.robot import Robot
from pliant.signals import Estimate, Preview, Reference, TaskReference
from pliant.spatial import Array

_REMEMBERED = 1024  # instants
_NO_WRENCH = vector(np.zeros(6), "no wrench")
_NOWHERE = np.zeros(3)


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
    height: Height = field(default_factory=Height)
    """of the surface that was touched above the believed one"""
    next_look: float = -np.inf
    """s at which a preview is due"""


class PhaseSample(NamedTuple):
    """Reference of a phase at one instant, before it is anchored. Arrays are shared: do not write into them."""

    position: Array
    rotation: Array
    velocity: Array
    acceleration: Array
    wrench: Array
    axes: Array | None
    normal: tuple[Array, Array, Array] | None
    """the third of the axes and its first two time derivatives, (6,) each"""
    posture: Array | None
    row: Array
    """the same in a row, for a preview (`preview_rows`)"""


class PhasedSource(ReferenceSource[PhaseState]):
    """References of the phases of a task for one frame, with a preview in which each node has the phase of its own
    time.

    A phase that ends on contact has no known end; the preview continues it.

    Args:
        robot: gives the frame's position, to anchor phases at the contact point.
        frame: the controlled frame.
        phases: in order; the last one holds.
        rotation: R_world_frame (3, 3) in phases that have none of their own.
        lookahead: of the preview; None for none.
        posture: (n,) rad, in phases that have none of their own; None for none.

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
        self._turning = any(phase.axes is not None for phase in phases)
        self._model, self._data = robot.model, robot.model.createData()
        self._frame_id = robot.frame_id(frame)
        self.posture = None if posture is None else robot.vector(posture, "the posture")
        # a pure function; an instant that is in the preview of many ticks is computed once
        self._at = lru_cache(_REMEMBERED)(self._work_out)

    def init(self, estimate: Estimate) -> PhaseState:
        here = self._position(estimate.q)
        return PhaseState(0, estimate.time, here, here)

    def step(self, estimate: Estimate, state: PhaseState) -> tuple[Reference, PhaseState]:
        state = self._advanced(estimate, state)
        now = self._task(state, estimate.time)
        phase, posture = self.phases[state.index].name, self._said(state, estimate.time).posture
        ahead, preview = self.lookahead, None
        if ahead is not None and ahead.due(estimate.time, state.next_look):
            preview = self._preview(state, instants(estimate.time, ahead))
            state = changed(state, next_look=estimate.time + ahead.every)
        return Reference(estimate.time, (now,), posture, phase, preview), state

    # ------------------------------------------------------------------ inside

    def _work_out(self, index: int, elapsed: float) -> PhaseSample:
        phase = self.phases[index]
        point, posture = phase.motion.at(elapsed), self.posture
        rotation, velocity, acceleration = self.rotation, np.zeros(6), np.zeros(6)
        velocity[:3], acceleration[:3] = point.rate, point.acceleration
        if phase.rotation is not None:
            rotation, velocity[3:], acceleration[3:] = phase.rotation.at(elapsed)
        if phase.posture is not None:
            posture = phase.posture.at(elapsed).value
        axes = None if phase.axes is None else phase.axes.at(elapsed)
        wrench = _NO_WRENCH if phase.wrench is None else phase.wrench.at(elapsed).value
        normal, turned = (None, None) if axes is None else (_normal(axes), axes.rotation)
        row = packed(point.value, rotation, velocity, wrench, turned, normal, posture)
        return PhaseSample(point.value, rotation, velocity, acceleration, wrench, turned, normal, posture, row)

    def _advanced(self, estimate: Estimate, state: PhaseState) -> PhaseState:
        """The present phase, from time and contact."""
        while state.index + 1 < len(self.phases):
            phase = self.phases[state.index]
            if phase.ends_on_contact:
                if not estimate.contacts.get(self.frame, False):
                    if estimate.time - state.start > phase.patience:
                        raise RunFailedError(self._missed(phase))
                    break
                start = estimate.time
            else:
                start = state.start + phase.duration
                if estimate.time < start - 1e-9:
                    break
            touched = self.phases[state.index + 1].touches and not phase.touches
            after = self._next(state, start)
            state = self._landed(state, after, self._position(estimate.q)) if touched else after
        return state

    def _landed(self, before: PhaseState, after: PhaseState, here: Array) -> PhaseState:
        """The phase that begins with contact made at `here` (3,) m.

        Raises:
            RunFailedError: too far from where the surface was believed.
        """
        phase, landed = self.phases[after.index], self.phases[before.index]
        if phase.anchor != "surface" or phase.axes is None:
            return changed(after, touch=here)
        normal = phase.axes.at(0.0).rotation[:, 2]
        arriving = self._task(before, after.start)
        found = float(normal @ (here - phase.motion.at(0.0).value))
        if abs(found) > landed.within:
            raise RunFailedError(
                f"phase {landed.name!r}: contact was felt {1e3 * abs(found):.0f} mm"
                f" {'above' if found > 0.0 else 'below'} the believed surface, more than the"
                f" {1e3 * landed.within:.0f} mm within which it is searched:"
                " there is an obstacle, the surface is elsewhere, or contact is detected too early: with"
                " estimation.tare=weight an unknown load of the sensor is removed"
            )
        gap = float(normal @ (arriving.position - here))
        height = Height(after.start, found, gap, float(normal @ arriving.velocity[:3]))
        return changed(after, touch=here, height=height)

    def _missed(self, phase: TaskPhase) -> str:
        return (
            f"phase {phase.name!r} felt no contact of frame {self.frame!r} within {phase.patience:.2g} s: is the"
            " surface lower than believed, further away than the phase searches, or is the threshold of contact too"
            " high?"
        )

    def _next(self, state: PhaseState, start: float) -> PhaseState:
        """The following phase, beginning at `start`; a new contact is expected at the reference."""
        position = self._task(state, start).position
        new = self.phases[state.index + 1].touches and not self.phases[state.index].touches
        touch = position if new else state.touch
        return PhaseState(state.index + 1, start, position, touch, state.height, state.next_look)

    def _expected(self, state: PhaseState, time: float) -> PhaseState:
        """The phase at a later time, as far as it is known now."""
        while state.index + 1 < len(self.phases):
            phase = self.phases[state.index]
            if phase.ends_on_contact or time < state.start + phase.duration - 1e-9:
                break
            state = self._next(state, state.start + phase.duration)
        return state

    def _task(self, state: PhaseState, time: float) -> TaskReference:
        return self._placed(state, self._said(state, time), time)

    def _placed(self, state: PhaseState, said: PhaseSample, time: float) -> TaskReference:
        """The reference of the phase, moved to its anchor."""
        phase = self.phases[state.index]
        offset = {"begin": state.begin, "touch": state.touch}.get(phase.anchor, 0.0)
        position, velocity, acceleration = said.position + offset, said.velocity, said.acceleration
        if phase.anchor == "surface" and said.normal is not None:
            h, h_dot, h_ddot = state.height.at(time)
            n, n_dot, n_ddot = said.normal
            position, velocity, acceleration = position + h * n[:3], velocity + h * n_dot, acceleration + h * n_ddot
            if h_dot or h_ddot:
                velocity = velocity + h_dot * n
                acceleration = acceleration + 2.0 * h_dot * n_dot + h_ddot * n
        return TaskReference(
            self.frame, position, said.rotation, velocity, acceleration, said.wrench, None, said.axes, phase.modes
        )

    def _said(self, state: PhaseState, time: float) -> PhaseSample:
        """The reference of the phase on its own clock; times are rounded, so that an instant is the same in two
        ticks."""
        return self._at(state.index, round(max(time - state.start, 0.0), 9))

    def _preview(self, state: PhaseState, times: Array) -> Preview:
        """The references at later times (N+1,) s."""
        rows: list[Array] = []
        moved: list[Moved] = []
        names: list[str] = []
        for instant in times.tolist():
            state = self._expected(state, instant)
            said, phase = self._said(state, instant), self.phases[state.index]
            rows.append(said.row)
            names.append(phase.name)
            if phase.anchor == "surface" and said.normal is not None:
                moved.append((_NOWHERE, *state.height.at(instant)[:2]))
            else:
                moved.append(({"begin": state.begin, "touch": state.touch}.get(phase.anchor, _NOWHERE), 0.0, 0.0))
        return preview_of_rows(times, rows, moved, tuple(names), turning=self._turning)

    def _position(self, q: Array) -> Array:
        pin.framesForwardKinematics(self._model, self._data, q)
        return np.array(self._data.oMf[self._frame_id].translation)


def _normal(axes: Orientation) -> tuple[Array, Array, Array]:
    """The third of turning axes with its first two time derivatives, (6,) each, the last three entries zero."""
    rows = np.zeros((3, 6))
    rows[:, :3] = third_axis(axes)
    return rows[0], rows[1], rows[2]
