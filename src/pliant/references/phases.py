"""References of a task in phases, which change by time or by contact."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError, RunFailedError
from pliant.frozen import changed
from pliant.interfaces import CLOCK_ROUNDING, Lookahead, ReferenceSource
from pliant.references.foreseen import instants
from pliant.references.landing import SETTLE, Height
from pliant.references.phase_state import PhaseState as PhaseState
from pliant.references.preview_rows import (
    ACCELERATION,
    AXES,
    NORMAL,
    NORMAL_BEND,
    NORMAL_RATE,
    POSITION,
    POSTURE,
    ROTATION,
    VELOCITY,
    WRENCH,
    Stretch,
    preview_of_rows,
    sampled,
)
from pliant.references.rows_ahead import RowsAhead
from pliant.references.task_phase import TaskPhase as TaskPhase
from pliant.robot import Robot
from pliant.signals import Estimate, Preview, Reference, TaskReference
from pliant.spatial import Array


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
        self._samples = [RowsAhead(partial(self._rows, phase)) for phase in self.phases]
        self._last = self._period = 0.0
        """s of the clock and between its last two ticks; they decide what is worked out ahead, not what it is"""

    def init(self, estimate: Estimate) -> PhaseState:
        here = self._position(estimate.q)
        return PhaseState(0, estimate.time, here, here)

    def step(self, estimate: Estimate, state: PhaseState) -> tuple[Reference, PhaseState]:
        state = self._advanced(estimate, state)
        time, phase = estimate.time, self.phases[state.index]
        period, self._last = time - self._last, time
        regular, self._period = abs(period - self._period) < CLOCK_ROUNDING, period
        row = self._samples[state.index].row(time - state.start, period if regular else 0.0)
        ahead, preview = self.lookahead, None
        if ahead is not None and ahead.due(time, state.next_look):
            preview = self._preview(state, instants(time, ahead))
            state = changed(state, next_look=time + ahead.every)
        posture = row[POSTURE] if len(row) > POSTURE.start else None
        return Reference(time, (self._placed(state, row, time),), posture, phase.name, preview), state

    # ------------------------------------------------------------------ inside

    def _rows(self, phase: TaskPhase, times: Array) -> Array:
        return sampled(phase, times, self.rotation, self.posture)

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
            here = self._position(estimate.q)
            state = self._landed(state, after, here) if touched else self._lifted(after, here)
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

    def _lifted(self, after: PhaseState, here: Array) -> PhaseState:
        """The last phase that touches before the tool leaves the surface lifts the reference to where the frame is.

        With a reference inside of a surface that stands otherwise than believed, the motion away from it would begin
        with one against it. A reference above the frame stays.
        """
        now, *later = self.phases[after.index : after.index + 2]
        if now.axes is None or now.anchor != "surface" or not now.touches or not later or later[0].touches:
            return after
        found = float(now.axes.at(0.0).rotation[:, 2] @ (here - now.motion.at(0.0).value))
        height = after.height.at(after.start)[0]
        return after if found <= height else changed(after, height=Height(after.start, found, height - found))

    def _expected(self, state: PhaseState, time: float) -> PhaseState:
        """The phase at a later time, as far as it is known now."""
        while state.index + 1 < len(self.phases):
            phase = self.phases[state.index]
            if phase.ends_on_contact or time < state.start + phase.duration - 1e-9:
                break
            state = self._next(state, state.start + phase.duration)
        return state

    def _task(self, state: PhaseState, time: float) -> TaskReference:
        times = np.array([max(time - state.start, 0.0)])
        return self._placed(state, self._rows(self.phases[state.index], times)[0], time)

    def _placed(self, state: PhaseState, row: Array, time: float) -> TaskReference:
        """The reference of the phase, moved to its anchor."""
        phase, offset = self.phases[state.index], self._offset(state)
        position, velocity, acceleration = row[POSITION], row[VELOCITY], row[ACCELERATION]
        if offset is not None:
            position = position + offset
        if phase.anchor == "surface":
            h, h_dot, h_ddot = state.height.at(time)
            n, n_dot, n_ddot = row[NORMAL], row[NORMAL_RATE], row[NORMAL_BEND]
            position, velocity, acceleration = position + h * n[:3], velocity + h * n_dot, acceleration + h * n_ddot
            if h_dot or h_ddot:
                velocity = velocity + h_dot * n
                acceleration = acceleration + 2.0 * h_dot * n_dot + h_ddot * n
        axes = None if phase.axes is None else row[AXES].reshape(3, 3)
        rotation = row[ROTATION].reshape(3, 3)
        return TaskReference(
            self.frame, position, rotation, velocity, acceleration, row[WRENCH], None, axes, phase.modes
        )

    def _offset(self, state: PhaseState) -> Array | None:
        anchor = self.phases[state.index].anchor
        return state.begin if anchor == "begin" else state.touch if anchor == "touch" else None

    def _preview(self, state: PhaseState, times: Array) -> Preview:
        """The references at later times (N+1,) s."""
        stretches: list[Stretch] = []
        begin = 0
        while begin < len(times):
            state = self._expected(state, float(times[begin]))
            end = self._until(state, times)
            stretches.append(self._stretch(state, times[begin:end]))
            begin = end
        return preview_of_rows(times, stretches, turning=self._turning)

    def _until(self, state: PhaseState, times: Array) -> int:
        """Number of the first time (N+1,) s that is expected in a later phase."""
        phase = self.phases[state.index]
        if phase.ends_on_contact or state.index + 1 == len(self.phases):
            return len(times)
        return int(np.searchsorted(times, state.start + phase.duration - 1e-9))

    def _stretch(self, state: PhaseState, times: Array) -> Stretch:
        phase, height = self.phases[state.index], state.height
        rows = self._samples[state.index].rows(times - state.start)
        heights: list[tuple[float, float, float]] = []
        if phase.anchor == "surface":
            settled = times[0] - height.start >= SETTLE
            heights = (
                [height.at(time) for time in times[:1].tolist()] * len(times)
                if settled
                else [height.at(time) for time in times.tolist()]
            )
        return Stretch(phase.name, rows, self._offset(state), heights)

    def _position(self, q: Array) -> Array:
        pin.framesForwardKinematics(self._model, self._data, q)
        return np.array(self._data.oMf[self._frame_id].translation)
