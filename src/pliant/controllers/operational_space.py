"""The operational-space controller: a baseline that inverts the model's dynamics."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import pinocchio as pin

from pliant.controllers.axis_selection import Selection, selection_of
from pliant.errors import ConfigError, SignalError, options
from pliant.interfaces import ChannelUnit, Controller, HasUnit, Needs
from pliant.rigid_body import mass_matrix
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Reference, TaskReference
from pliant.spatial import Array, all_finite, log3

Compensation = Literal["none", "coriolis", "gravity+coriolis"]

_LONGEST_PERIOD = 0.02  # s; after a longer pause the integral is not advanced
_MOST = (20.0, 2.0)  # N and N·m, of the integral


@dataclass(frozen=True)
class OperationalSpaceState:
    """State of the force integral; without it the law has no state."""

    data: pin.Data
    """scratch space of the dynamics"""
    time: float
    """s of the last step"""
    integral: Array
    """(6,) world axes, N and N·m"""


@dataclass(frozen=True)
class OperationalSpace(Controller[OperationalSpaceState]):
    """Khatib, IEEE J. Robotics and Automation 3(1), 1987, with the dynamically consistent null space.

    τ = Jᵀ Λ (ẍ* − J̇ v) + (I − Jᵀ J̄ᵀ) M (k_p (q_p − q) − k_d v) + compensation,

    with Λ = (J M⁻¹ Jᵀ + δ² I)⁻¹, J̄ = M⁻¹ Jᵀ Λ, and ẍ* = a_d + 2 ζ √k (v_d − J v) + k x̃. J has 6 rows where the
    reference has a rotation, otherwise 3. The posture is `Reference.posture`, or the robot's home.

    With `force_integral` it also regulates force: in the axes of `TaskReference.modes` (else those of its wrench)
    motion axes keep ẍ*, force axes have 2 ζ √k (v_d − J v) alone and −(F_d + k_i ∫(F_d − F)) beside it as long as there
    is contact; until then they move. Free axes drop out of J.

    Raises:
        RobotError: the robot lacks the frame.
        ConfigError: a gain that is negative or not finite.
    """

    robot: Robot = field(repr=False)
    frame: str
    stiffness: float = 400.0
    """k, 1/s²"""
    damping_ratio: float = 1.0
    """ζ"""
    posture_stiffness: float = 50.0
    """k_p, 1/s²; k_d = 2 √k_p"""
    singularity_damping: float = 0.02
    """δ, kg^-1/2"""
    compensation: Compensation = "gravity+coriolis"
    """what the model adds"""
    force_integral: float = 0.0
    """k_i, 1/s; 0: it regulates no force"""
    label: str = "ee"
    """in channel names"""

    def __post_init__(self) -> None:
        self.robot.frame_id(self.frame)
        for name in ("stiffness", "damping_ratio", "posture_stiffness", "singularity_damping", "force_integral"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise ConfigError(f"{name} must be finite and not negative, got {value}")
        if self.compensation not in ("none", "coriolis", "gravity+coriolis"):
            valid = options(["none", "coriolis", "gravity+coriolis"], self.compensation)
            raise ConfigError(f"unknown compensation {self.compensation!r}; {valid}")

    @property
    def needs(self) -> Needs:
        """A posture for the null space of the task; the contact wrench where it regulates a force."""
        return Needs(posture=True, wrench=self.force_integral > 0.0)

    @property
    def regulates_force(self) -> bool:
        return self.force_integral > 0.0

    @property
    def channels(self) -> Mapping[str, HasUnit]:
        """Name → unit of every channel in `Command.diagnostics`."""
        return {f"{self.label}/error": ChannelUnit("m, rad"), f"{self.label}/wrench": ChannelUnit("N, N·m")}

    def init(self, estimate: Estimate) -> OperationalSpaceState:
        """Scratch space. Raises ShapeError for a robot with other joints."""
        self.robot.vector(estimate.q, "q")
        return OperationalSpaceState(self.robot.model.createData(), estimate.time, np.zeros(6))

    def step(
        self, estimate: Estimate, reference: Reference, state: OperationalSpaceState
    ) -> tuple[Command, OperationalSpaceState]:
        """The torque for the next period.

        Raises:
            ConfigError: the reference has no task for the frame.
            ShapeError, SignalError: q or v of the wrong size or not finite; a reference that is not finite.
        """
        q, v = self.robot.vector(estimate.q, "q"), self.robot.vector(estimate.v, "v")
        target = self._target(reference)
        model, data, last = self.robot.model, state.data, state
        pin.forwardKinematics(model, data, q, v, np.zeros_like(v))
        mass = mass_matrix(model, data, q)
        J_world, x_tilde, drift = self._kinematics(q, target, data)
        rows = J_world.shape[0]
        x_dot_tilde = target.velocity[:rows] - J_world @ v
        damped = 2.0 * self.damping_ratio * math.sqrt(self.stiffness) * x_dot_tilde - drift
        wanted = target.acceleration[:rows] + self.stiffness * x_tilde + damped
        selection = selection_of(
            target, touches=estimate.contacts.get(self.frame, False), presses=self.force_integral > 0.0
        )
        pressed, state = np.zeros(rows), replace(state, time=estimate.time)
        if selection is not None:
            damped, wanted = selection.into @ damped, selection.into @ wanted
            wanted = np.where(selection.force, damped, wanted)
            pressed, state = self._pressed(selection, estimate, target, state, last)
        J = J_world if selection is None else selection.into @ J_world
        M_inv_JT = np.linalg.solve(mass, J.T)
        mobility = J @ M_inv_JT + self.singularity_damping**2 * np.eye(len(J))
        wrench = np.asarray(np.linalg.solve(mobility, wanted), dtype=np.float64) - pressed
        posture = mass @ self._posture(q, v, reference)
        torque = J.T @ (wrench - np.linalg.solve(mobility, M_inv_JT.T @ posture)) + posture
        torque = torque + self._compensation(q, v, data)
        wrench = wrench if selection is None else selection.into.T @ wrench
        if not all_finite(torque):
            raise SignalError(f"the reference of frame {self.frame!r} must be finite, got {target}")
        sent = np.clip(torque, -self.robot.torque_limit, self.robot.torque_limit)
        channels: dict[str, float | Array] = {f"{self.label}/error": x_tilde, f"{self.label}/wrench": wrench}
        return Command(estimate.time, sent, torque - sent, channels), state

    def _pressed(
        self,
        selection: Selection,
        estimate: Estimate,
        target: TaskReference,
        state: OperationalSpaceState,
        last: OperationalSpaceState,
    ) -> tuple[Array, OperationalSpaceState]:
        """F_d + k_i ∫(F_d − F) (k,) along the axes that press, and the state with the integral.

        It is reset where no axis presses, and held without a usable signal.
        """
        rows = selection.into.shape[1]
        if not selection.force.any():
            return np.zeros(len(selection.force)), replace(state, integral=np.zeros(6))
        felt = estimate.wrenches.get(self.frame)
        integral = selection.into @ last.integral[:rows]
        if felt is not None and np.isfinite(felt).all():
            period = min(max(estimate.time - last.time, 0.0), _LONGEST_PERIOD)
            integral = integral + self.force_integral * period * (selection.wrench - selection.into @ felt[:rows])
        most = np.where(np.arange(rows) < 3, *_MOST)
        integral = np.where(selection.force, integral, 0.0)
        kept = np.zeros(6)
        kept[:rows] = np.clip(selection.into.T @ integral, -most, most)
        pressed = selection.wrench + selection.into @ kept[:rows]
        return np.where(selection.force, pressed, 0.0), replace(state, integral=kept)

    def _target(self, reference: Reference) -> TaskReference:
        for task in reference.tasks:
            if task.frame == self.frame:
                return task
        known = options([task.frame for task in reference.tasks], self.frame)
        raise ConfigError(f"the reference has no task for frame {self.frame!r}; {known}")

    def _kinematics(self, q: Array, target: TaskReference, data: pin.Data) -> tuple[Array, Array, Array]:
        """J (rows, n), x̃ (rows,) and J̇ v (rows,), with 3 or 6 rows. Needs the kinematics computed with zero
        acceleration."""
        frame, axes = self.robot.frame_id(self.frame), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J = pin.computeFrameJacobian(self.robot.model, data, q, frame, axes)
        pose = pin.updateFramePlacement(self.robot.model, data, frame)
        drift = pin.getFrameClassicalAcceleration(self.robot.model, data, frame, axes).vector
        position_error = target.position - pose.translation
        if target.rotation is None:
            return J[:3], position_error, drift[:3]
        return J, np.concatenate([position_error, log3(target.rotation @ pose.rotation.T)]), drift

    def _posture(self, q: Array, v: Array, reference: Reference) -> Array:
        posture = self.robot.home if reference.posture is None else self.robot.vector(reference.posture, "the posture")
        return self.posture_stiffness * (posture - q) - 2.0 * math.sqrt(self.posture_stiffness) * v

    def _compensation(self, q: Array, v: Array, data: pin.Data) -> Array:
        if self.compensation == "none":
            return np.zeros_like(q)
        bias = np.array(pin.nonLinearEffects(self.robot.model, data, q, v))
        if self.compensation == "coriolis":
            bias -= pin.computeGeneralizedGravity(self.robot.model, data, q)
        return bias
