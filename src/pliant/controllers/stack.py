"""A stack of passive task-space controllers: joint torques from fractal impedances at several frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin

from pliant import _impedance
from pliant.controllers.attractor import Law
from pliant.controllers.compiled_stack import CompiledStack
from pliant.controllers.damping import Damping
from pliant.controllers.energy_ledger import LedgerChannel, channel_table, layout_of, require_length
from pliant.controllers.passivity_account import AccountSettings
from pliant.controllers.phase_settings import PhaseSettings
from pliant.controllers.profiles import linear_range
from pliant.controllers.stack_input import Seen, check_stack, free_axes, joints_that_move, loosened, seen_of, target_of
from pliant.controllers.task import FrameTask
from pliant.errors import ShapeError, SignalError
from pliant.flat_channels import FlatChannels
from pliant.frozen import quick
from pliant.interfaces import Controller, Needs
from pliant.rigid_body import tree_of
from pliant.robot import Robot
from pliant.signals import Command, Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import Array


@quick
class StackState:
    """State between two ticks: phases, turning points, filters and ledger in one array, and the active tunings."""

    memory: Array
    tuned: _Tuned


@quick
class _Tuned:
    """Active tunings, and what of the references they follow from: while that is the same, so are they."""

    seen: Seen
    tunings: tuple[ImpedanceTuning | None, ...]
    free: tuple[tuple[bool, ...], ...]
    """of each task, which axes are free; empty: none"""


_CHANGED = -1  # the core's answer where references are not as they were seen before


def needs_of_law(law: Law) -> Needs:
    """Signals that a stack with a law needs."""
    return Needs(calm=law is Law.CAPPED)


class Stack(Controller[StackState]):
    """τ = Σ J_iᵀ h_i, each h_i a fractal impedance at its own frame, then clamped to the torque limits ([Stack] eq. 5).

    It needs no inverse, no projection and, without gravity compensation and `motion_damping`, no inertia. Orientation
    errors are e = log(R_d Rᵀ); the moment is m = J_l⁻¹(e) h, so that m·ω = −h·ė with unequal gains, too.
    Where a moment would exceed its F_max, the three shrink together. Each axis of the capped law accounts for the
    energy that sampling, clamps and changes of its tuning release, see `passivity_account`.

    Forces come from position errors alone: `TaskReference.acceleration` is not used, `.velocity` for `motion_damping`
    alone, `.wrench` not at all. Axes are the world's, or those of `TaskReference.modes`: a "free" one gives no
    force; where they turn, the axes start anew (`cpp/impedance/task.hpp`). While the reference of a task has no
    rotation, its orientation is free.

    `Command.diagnostics` holds the energy ledger and the state of every axis; `channels` says what is in it.
    """

    def __init__(
        self,
        robot: Robot,
        tasks: Sequence[FrameTask],
        period: float,
        *,
        law: Law = Law.CAPPED,
        phases: PhaseSettings | None = None,
        damping: Damping | None = None,
        gravity_compensation: bool = False,
    ) -> None:
        """
        Args:
            robot: kinematics and torque limits.
            tasks: frames to hold, each with its own label.
            period: s between two steps.
            law: force on the way back; `capped` unless you compare.
            phases: thresholds of the phase logic.
            damping: beside that of the attractors, which need none in a prompt loop.
            gravity_compensation: adds the model's gravity torque; leave it off where the robot compensates itself.

        Raises:
            ConfigError: no task, two tasks of one label, or a period that is not above zero.
            RobotError: a frame that the robot does not have.
        """
        check_stack(tasks, period)
        self.robot = robot
        self.tasks = tuple(tasks)
        self.period = period
        self.law = Law(law)
        self.phases = phases or PhaseSettings()
        self.damping = damping or Damping()
        self.gravity_compensation = gravity_compensation
        self._frames = [robot.frame_id(task.frame) for task in tasks]
        self._n, self._biased = robot.n, gravity_compensation or self.damping.any
        self._names = [task.frame for task in tasks]
        self._scratch = robot.model.createData()  # nothing in it outlives a step
        self._arm = _impedance.Arm(tree_of(robot.model), self._names)
        self._core = self._compiled()
        labels_and_axes = [(task.label, task.axes) for task in self.tasks]
        self._table = channel_table(robot.n, labels_and_axes, account=self.law is Law.CAPPED)
        self._size = self._core.output_size
        require_length(self._table, self._size)
        self._layout = layout_of(self._table)

    def _compiled(self) -> _impedance.Stack:
        return _impedance.Stack(
            law=self.law.value,
            period=self.period,
            rate_gain=self.phases.rate_gain(self.period),
            noise_gain=self.phases.noise_gain(self.period),
            hold_limit=self.phases.hold_limit,
            blend_step=self.phases.blend_step(self.period),
            account=AccountSettings().numbers(self.period) if self.law is Law.CAPPED else None,
            torque_limit=self.robot.torque_limit,
            tasks=[
                (
                    task.axes,
                    task.shape.value,
                    self.phases.rate_floor,
                    self.phases.rate_floor_angular,
                    joints_that_move(self.robot, frame),
                )
                for task, frame in zip(self.tasks, self._frames, strict=True)
            ],
        )

    @property
    def needs(self) -> Needs:
        """With the passivity account: positions without white noise, because noise would empty the account and weaken
        the axis."""
        return needs_of_law(self.law)

    @property
    def channels(self) -> Mapping[str, LedgerChannel]:
        """Name → place, size and unit of every channel in `Command.diagnostics`."""
        return self._table

    def init(self, estimate: Estimate) -> StackState:
        """Every axis starts diverging, with an empty ledger. Raises ShapeError for a robot with other joints."""
        self.robot.vector(estimate.q, "q")
        none = (None,) * len(self.tasks)
        tuned = _Tuned(((None, None, None),) * len(self.tasks), none, ((),) * len(self.tasks))
        return StackState(np.zeros(self._core.state_size), tuned)

    def step(self, estimate: Estimate, reference: Reference, state: StackState) -> tuple[Command, StackState]:
        """The torque for the next period, and the next state.

        Raises:
            ConfigError: the reference has no task for a frame of the stack.
            ShapeError: q, a pose or a tuning of the wrong size.
            SignalError: q or a pose that is not finite.
        """
        out, memory = np.empty(self._size), state.memory.copy()
        targets, tuned = reference.tasks, state.tuned
        try:
            bias = self._bias(estimate, reference) if self._biased else None
            code = self._core.step_on(self._arm, memory, out, estimate, targets, tuned.seen, bias, None)
            if code == _CHANGED:
                targets = self._targets(reference)
                tuned = self._tuned(targets)
                retune = self._changed(state.tuned, tuned)
                code = self._core.step_on(self._arm, memory, out, estimate, targets, None, bias, retune)
        except (ValueError, TypeError, RuntimeError) as error:
            raise ShapeError(self._misshapen(estimate, self._targets(reference), error)) from error
        if code:
            raise SignalError(self._not_finite(code, estimate))
        return self._command(estimate.time, out), StackState(memory, tuned)

    def compiled_face(self, estimate: Estimate, state: StackState) -> CompiledStack | None:
        if self._biased:
            return None
        return CompiledStack(self._core, self._arm, self._names, self._size, self._command)

    def _command(self, time: float, out: Array) -> Command:
        n = self._n
        return Command(time, out[:n], out[n : 2 * n], FlatChannels(self._layout, out[2 * n :]))

    def _targets(self, reference: Reference) -> tuple[TaskReference, ...]:
        return tuple([target_of(reference, i, task.frame) for i, task in enumerate(self.tasks)])

    def _bias(self, estimate: Estimate, reference: Reference) -> Array | None:
        """(n,) N·m beside the tasks; None for nothing."""
        model, damping = self.robot.model, None
        q = self.robot.vector(estimate.q, "q")
        if self.damping.any:
            v = self.robot.vector(estimate.v, "v")
            frames = list(zip(self._frames, self._targets(reference), strict=True))
            damping = self.damping.torque(model, self._scratch, q, v, frames)
        if not self.gravity_compensation:
            return damping
        gravity = pin.computeGeneralizedGravity(model, self._scratch, q)
        return gravity if damping is None else gravity + damping

    def kept_back(self, state: StackState, torque: Array) -> StackState:
        """Adds to the accounts that part of the last torque, (n,) N·m, was not sent."""
        memory, start = state.memory.copy(), self._core.kept_back
        memory[start : start + self._n] += torque
        return replace(state, memory=memory)

    def _tuned(self, targets: Sequence[TaskReference]) -> _Tuned:
        tunings = tuple([target.tuning or task.tuning for task, target in zip(self.tasks, targets, strict=True)])
        return _Tuned(seen_of(targets), tunings, tuple([free_axes(target) for target in targets]))

    def _changed(self, last: _Tuned, now: _Tuned) -> tuple[tuple[int, Array], ...] | None:
        changes: list[tuple[int, Array]] = []
        for i, (task, new, free) in enumerate(zip(self.tasks, now.tunings, now.free, strict=True)):
            if new is None or (new is last.tunings[i] and free == last.free[i]):
                continue
            if new.axes != task.axes:
                raise ShapeError(f"task {task.label!r} has {task.axes} axes, its new tuning {new.axes}")
            used = loosened(new, free) if free else new
            changes.append((i, np.concatenate([used.stiffness, used.force_max, used.range, linear_range(used)])))
        return tuple(changes) or None

    def _misshapen(self, estimate: Estimate, targets: Sequence[TaskReference], error: Exception) -> str:
        if np.shape(estimate.q) != (self.robot.n,):
            return f"q must be an array of {self.robot.n} entries for robot {self.robot.name!r}, got {estimate.q!r}"
        for i, task in enumerate(self.tasks):
            position: Any = targets[i].position
            rotation: Any = targets[i].rotation
            if not isinstance(position, np.ndarray) or position.shape != (3,):
                return f"the position of frame {task.frame!r} must be an array of 3 entries, got {position!r}"
            if rotation is not None and (not isinstance(rotation, np.ndarray) or rotation.shape != (3, 3)):
                return f"the rotation of frame {task.frame!r} must be an array of shape (3, 3), got {rotation!r}"
        return f"the stack of robot {self.robot.name!r} cannot use its input: {error}"

    def _not_finite(self, code: int, estimate: Estimate) -> str:
        if code < 200:
            return f"the measured position must be finite, got q = {np.asarray(estimate.q).tolist()}"
        return (
            f"the reference of frame {self.tasks[code - 200].frame!r} must be finite, its position or rotation is not"
        )
