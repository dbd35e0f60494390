"""References of a task in phases, which change by time or by contact."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from pliant._references import RowsAhead, columns_of, parts_of
from pliant.errors import ConfigError, RunFailedError
from pliant.frozen import changed
from pliant.interfaces import CLOCK_ROUNDING, Lookahead, ReferenceSource
from pliant.references.known_phases import KnownPhase
from pliant.references.landing import Height
from pliant.references.phase_state import PhaseState as PhaseState
from pliant.references.phase_state import moved, moved_ahead
from pliant.references.preview_rows import Parts, PhaseRows
from pliant.references.task_phase import TaskPhase as TaskPhase
from pliant.robot import Robot
from pliant.signals import Estimate, Preview, Reference, TaskReference
from pliant.spatial import Array

_ROUNDING = 1e-9  # s; times are sums of periods


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
        self._rows = [PhaseRows(phase, rotation, self.posture) for phase in phases]
        self._samples = [RowsAhead(rows, CLOCK_ROUNDING) for rows in self._rows]
        if lookahead is not None:
            self._nodes = lookahead.step * np.arange(lookahead.nodes + 1, dtype=np.float64)
            self._last_node = float(self._nodes[-1])
            self._names = [(name,) * len(self._nodes) for name in names]
        self._coming: deque[tuple[PhaseState, PhaseState]] = deque(maxlen=len(phases))
        """the last phases that were foreseen: before and after"""
        self._last = self._period = self._clock = 0.0
        """s of the clock and between its last two ticks, and the latter where it is regular, else 0; they decide what
        is worked out ahead, not what it is"""

    def init(self, estimate: Estimate) -> PhaseState:
        here = self._position(estimate.q)
        return PhaseState(0, estimate.time, here, here)

    def step(self, estimate: Estimate, state: PhaseState) -> tuple[Reference, PhaseState]:
        time, phase = estimate.time, self.phases[state.index]
        if phase.ends_on_contact or time >= state.start + phase.duration - _ROUNDING:
            state = self._advanced(estimate, state)
            phase = self.phases[state.index]
        period, self._last = time - self._last, time
        self._clock = period if abs(period - self._period) < CLOCK_ROUNDING else 0.0
        self._period = period
        offset, height = moved(phase, state, time)
        task, posture = self._task_of(
            phase, self._samples[state.index].task(time - state.start, self._clock, offset, height)
        )
        ahead, preview = self.lookahead, None
        if ahead is not None and ahead.due(time, state.next_look):
            preview = self._preview(state, time + ahead.lead)
            state = changed(state, next_look=time + ahead.every)
        return Reference(time, (task,), posture, phase.name, preview), state

    def compiled_face(self, estimate: Estimate, state: PhaseState) -> KnownPhase | None:
        if self.phases[state.index].ends_on_contact or estimate.time >= (until := self._until(state)):
            return None
        names = [phase.name for phase in self.phases]
        sample, _ = self.step(estimate, changed(state, next_look=-np.inf))
        return KnownPhase(sample, names, lambda time, at: self.step(changed(estimate, time=time), at), state, until)

    # ------------------------------------------------------------------ inside

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
                if estimate.time < start - _ROUNDING:
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
            if time < self._until(state):
                break
            state = self._foreseen(state, state.start + self.phases[state.index].duration)
        return state

    def _foreseen(self, state: PhaseState, start: float) -> PhaseState:
        """`_next`, worked out once for all previews that reach into the next phase."""
        for before, after in self._coming:
            if before.same_phase(state):
                return after
        after = self._next(state, start)
        self._coming.append((state, after))
        return after

    def _task(self, state: PhaseState, time: float) -> TaskReference:
        phase, times = self.phases[state.index], np.array([max(time - state.start, 0.0)])
        return self._task_of(phase, parts_of(self._rows[state.index](times)[0], *moved(phase, state, time)))[0]

    def _task_of(self, phase: TaskPhase, parts: Parts) -> tuple[TaskReference, Array | None]:
        """The reference of a phase and its posture."""
        position, rotation, velocity, acceleration, wrench, axes, posture = parts
        own = None if phase.axes is None else axes
        task = TaskReference(self.frame, position, rotation, velocity, acceleration, wrench, None, own, phase.modes)
        return task, posture

    def _preview(self, state: PhaseState, time: float) -> Preview:
        """The references at the nodes (N+1,), of which the first is at a time in s."""
        index, phase, nodes = state.index, self.phases[state.index], self._nodes
        if time + self._last_node >= self._until(state):
            return self._across(state, time + nodes)
        offset, heights = moved_ahead(phase, state, time, nodes)
        times, position, rotation, velocity, wrench, posture, axes = self._samples[index].preview(
            time, nodes, state.start, self._clock, offset, heights, self._turning, self._rows[index].width
        )
        return Preview(times, position, rotation, velocity, wrench, self._names[index], posture, axes)

    def _across(self, state: PhaseState, times: Array) -> Preview:
        """The references at later times (N+1,) s, which may be in other phases."""
        begin, count = 0, len(times)
        stretches: list[tuple[PhaseState, int, int]] = []
        while begin < count:
            state = self._expected(state, float(times[begin]))
            end = int(np.searchsorted(times, self._until(state)))
            stretches.append((state, begin, end))
            begin = end
        table = np.empty((count, min([self._rows[one.index].width for one, _, _ in stretches])))
        names: tuple[str, ...] = ()
        for one, begin, end in stretches:
            offset, heights = moved_ahead(self.phases[one.index], one, 0.0, times[begin:end])
            self._samples[one.index].fill(table, begin, end, times, one.start, self._clock, offset, heights)
            names += self._names[one.index][begin:end]
        _, position, rotation, velocity, wrench, posture, axes = columns_of(times, table, self._turning)
        return Preview(times, position, rotation, velocity, wrench, names, posture, axes)

    def _until(self, state: PhaseState) -> float:
        """s at which a phase ends by the clock; infinite where it does not."""
        phase = self.phases[state.index]
        if phase.ends_on_contact or state.index + 1 == len(self.phases):
            return np.inf
        return state.start + phase.duration - _ROUNDING

    def _position(self, q: Array) -> Array:
        pin.framesForwardKinematics(self._model, self._data, q)
        return np.array(self._data.oMf[self._frame_id].translation)
