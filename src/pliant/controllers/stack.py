"""A stack of passive task-space controllers: joint torques from fractal impedances at several frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pinocchio as pin

from pliant import _impedance
from pliant.controllers.attractor import Law
from pliant.controllers.damping import Damping
from pliant.controllers.energy_ledger import Diagnostics, LedgerChannel, channel_table, require_length
from pliant.controllers.passivity_account import AccountSettings
from pliant.controllers.phase_settings import PhaseSettings
from pliant.controllers.profiles import linear_range
from pliant.controllers.stack_input import check_stack, free_axes, joints_that_move, loosened, target_of
from pliant.controllers.task import FrameTask
from pliant.errors import ShapeError, SignalError
from pliant.interfaces import Controller, Needs
from pliant.robot import Robot
from pliant.signals import Command, Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class StackState:
    """State between two ticks: phases, turning points, filters and ledger in one array, and the active tunings."""

    memory: Array
    tunings: tuple[ImpedanceTuning | None, ...]
    free: tuple[tuple[bool, ...], ...]
    """of each task, which axes are free; empty: none"""
    workspace: _Workspace
    """scratch memory of the kinematics; nothing in it outlives a step"""


class _Workspace:
    """pinocchio's data, and views into it that stay valid while it lives."""

    __slots__ = ("data", "jacobian", "poses")

    def __init__(self, model: pin.Model, frames: Sequence[int]) -> None:
        self.data = model.createData()
        self.jacobian: Array = self.data.J
        poses = [self.data.oMf[frame] for frame in frames]
        self.poses: tuple[Any, ...] = tuple(part for pose in poses for part in (pose.translation, pose.rotation))


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
        self._scratch = robot.model.createData()  # nothing in it outlives a step
        self._core = _impedance.Stack(
            law=self.law.value,
            period=period,
            rate_gain=self.phases.rate_gain(period),
            noise_gain=self.phases.noise_gain(period),
            hold_limit=self.phases.hold_limit,
            blend_step=self.phases.blend_step(period),
            account=AccountSettings().numbers(period) if self.law is Law.CAPPED else None,
            torque_limit=robot.torque_limit,
            tasks=[
                (
                    task.axes,
                    task.shape.value,
                    self.phases.rate_floor,
                    self.phases.rate_floor_angular,
                    joints_that_move(robot, frame),
                )
                for task, frame in zip(self.tasks, self._frames, strict=True)
            ],
        )
        labels_and_axes = [(task.label, task.axes) for task in self.tasks]
        self._table = channel_table(robot.n, labels_and_axes, account=self.law is Law.CAPPED)
        require_length(self._table, self._core.output_size)

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
        memory = np.zeros(self._core.state_size)
        none, work = (None,) * len(self.tasks), _Workspace(self.robot.model, self._frames)
        return StackState(memory, none, ((),) * len(self.tasks), work)

    def step(self, estimate: Estimate, reference: Reference, state: StackState) -> tuple[Command, StackState]:
        """The torque for the next period, and the next state.

        Raises:
            ConfigError: the reference has no task for a frame of the stack.
            ShapeError: q, a pose or a tuning of the wrong size.
            SignalError: q or a pose that is not finite.
        """
        model, work = self.robot.model, state.workspace
        targets = [target_of(reference, i, task.frame) for i, task in enumerate(self.tasks)]
        desired = tuple([part for target in targets for part in (target.position, target.rotation)])
        tunings, free = self._tunings(targets, state)
        same = tunings is state.tunings and free == state.free
        retune = None if same else self._changed(state, tunings, free)
        axes = tuple([None if target.modes is None else target.modes.rotation for target in targets])
        memory, out = state.memory.copy(), np.empty(self._core.output_size)
        try:
            pin.computeJointJacobians(model, work.data, estimate.q)
            for frame in self._frames:
                pin.updateFramePlacement(model, work.data, frame)
            bias = self._bias(estimate, targets, work.data)
            code = self._core.step(memory, out, estimate.q, work.jacobian, work.poses, desired, bias, retune, axes)
        except (ValueError, TypeError, RuntimeError) as error:
            raise ShapeError(self._misshapen(estimate, desired, error)) from error
        if code:
            raise SignalError(self._not_finite(code, estimate))
        n = self.robot.n
        command = Command(estimate.time, out[:n], out[n : 2 * n], Diagnostics(self._table, out))
        return command, StackState(memory, tunings, free, work)

    def _bias(self, estimate: Estimate, targets: Sequence[TaskReference], data: pin.Data) -> Array | None:
        """(n,) N·m beside the tasks; None for nothing."""
        model, damping = self.robot.model, None
        if self.damping.any:
            v, frames = self.robot.vector(estimate.v, "v"), list(zip(self._frames, targets, strict=True))
            damping = self.damping.torque(model, self._scratch, estimate.q, v, frames)
        if not self.gravity_compensation:
            return damping
        gravity = pin.computeGeneralizedGravity(model, data, estimate.q)
        return gravity if damping is None else gravity + damping

    def kept_back(self, state: StackState, torque: Array) -> StackState:
        """Adds to the accounts that part of the last torque, (n,) N·m, was not sent."""
        memory, start = state.memory.copy(), self._core.kept_back
        memory[start : start + self.robot.n] += torque
        return replace(state, memory=memory)

    def _tunings(
        self, targets: Sequence[TaskReference], last: StackState
    ) -> tuple[tuple[ImpedanceTuning | None, ...], tuple[tuple[bool, ...], ...]]:
        """The tunings, those of `last` themselves if none changed, and the free axes."""
        tunings = last.tunings
        for i, (task, target) in enumerate(zip(self.tasks, targets, strict=True)):
            tuning = target.tuning or task.tuning
            if tuning is not tunings[i]:
                tunings = (*tunings[:i], tuning, *tunings[i + 1 :])
        return tunings, tuple([free_axes(target) for target in targets])

    def _changed(
        self, last: StackState, tunings: tuple[ImpedanceTuning | None, ...], free: tuple[tuple[bool, ...], ...]
    ) -> tuple[tuple[int, Array], ...]:
        changes: list[tuple[int, Array]] = []
        for i, new in enumerate(tunings):
            if new is None or (new is last.tunings[i] and free[i] == last.free[i]):
                continue
            if new.axes != self.tasks[i].axes:
                raise ShapeError(
                    f"task {self.tasks[i].label!r} has {self.tasks[i].axes} axes, its new tuning {new.axes}"
                )
            used = loosened(new, free[i]) if free[i] else new
            changes.append((i, np.concatenate([used.stiffness, used.force_max, used.range, linear_range(used)])))
        return tuple(changes)

    def _misshapen(self, estimate: Estimate, desired: Sequence[Any], error: Exception) -> str:
        if np.shape(estimate.q) != (self.robot.n,):
            return f"q must be an array of {self.robot.n} entries for robot {self.robot.name!r}, got {estimate.q!r}"
        for i, task in enumerate(self.tasks):
            position, rotation = desired[2 * i], desired[2 * i + 1]
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
