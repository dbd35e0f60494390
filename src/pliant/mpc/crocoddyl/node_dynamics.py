"""Dynamics of one node on any pinocchio model: without contact, rigid, visco-elastic; [FFMPC] eq. 4, 16–23."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant.errors import ConfigError
from pliant.mpc.crocoddyl.contact import ContactGeometry, ContactMotion
from pliant.mpc.nodes import PlainNodes
from pliant.mpc.problem import AXES_OF_DIMENSION, MpcProblem
from pliant.mpc.sliding_friction import sliding_rate
from pliant.rigid_body import mass_matrix
from pliant.spatial import Array


@dataclass(frozen=True)
class Dynamics:
    """v̇, λ and λ̇ with their derivatives over the tangent of x = (q, v, e) and over u."""

    acceleration: Array
    acceleration_x: Array
    acceleration_u: Array
    force: Array
    force_x: Array
    force_u: Array
    rate: Array
    rate_x: Array
    rate_u: Array


class NodeDynamics:
    """Accelerations and forces of one node, with their derivatives.

    Args:
        problem: bound to any model.
        terminal: the last node, which has no dynamics.

    Raises:
        ConfigError: the exponential integrator, which only the kernel has; Baumgarte's position term in 6 dimensions.
    """

    def __init__(self, problem: MpcProblem, *, terminal: bool = False) -> None:
        contact = problem.config.contact
        if problem.config.predictive_model.force_state and contact.integrator != "euler":
            raise ConfigError("models in Python integrate the force with 'euler' only, got integrator = 'exponential'")
        springy = contact.baumgarte[0] > 0.0 or problem.config.predictive_model.springy
        if springy and problem.m == 6:
            raise ConfigError("models in Python have no contact spring in 6 dimensions: use dimension 1 or 3")
        self.problem, self.terminal = problem, terminal
        self.model, self.data = problem.model, problem.model.createData()
        self.parameters = PlainNodes.zeros(1, self.model.nq, self.model.nv, problem.nu, problem.m)
        rows = AXES_OF_DIMENSION[problem.m] if problem.m else ()
        frame = self.model.getFrameId(problem.contact_frame)
        self._frame, self._rows = frame, rows
        self._tool = self.model.getFrameId(problem.config.frame)
        extra = problem.config.predictive_model.extra(problem.m, problem.nu)
        self.nx, self.ndx, self.nu = self.model.nq + self.model.nv + extra, 2 * self.model.nv + extra, problem.nu
        self._select = np.zeros((self.model.nv, self.nu))
        self._select[list(problem.driven), np.arange(self.nu)] = 1.0

    @property
    def _contact(self) -> ContactGeometry:
        axes = self.problem.config.contact.axes
        R = self.parameters.task_rotation[0] if axes == "surface" else np.eye(3)
        return ContactGeometry(self._frame, axes, self._rows, R)

    def dynamics(self, q: Array, v: Array, e: Array, u: Array) -> Dynamics:
        kind, nv = self.problem.config.predictive_model, self.model.nv
        torque = e if kind.torque_state else u
        torque_x, torque_u = np.zeros((nv, self.ndx)), self._select
        if kind.torque_state:
            torque_x[:, 2 * nv :], torque_u = self._select, np.zeros((nv, self.nu))
        drive = self._select @ torque
        if self.problem.m == 0 or not self.parameters.contact_active[0]:
            return self._without_contact(q, v, e, drive, torque_x, torque_u)
        if kind.rigid:
            return self._rigid(q, v, drive, torque_x, torque_u)
        return self._soft(q, v, e, drive, torque_x, torque_u)

    def _without_contact(
        self, q: Array, v: Array, e: Array, drive: Array, torque_x: Array, torque_u: Array
    ) -> Dynamics:
        m = self.problem.m
        M_inverse, bias = self._inertia(q, v)
        a = M_inverse @ (drive - bias)
        self._kinematics(q, v, a)
        a_x = M_inverse @ (torque_x - self._inverse_dynamics_x(q, v, a, np.zeros(6)))
        none_x, none_u, none = np.zeros((m, self.ndx)), np.zeros((m, self.nu)), np.zeros(m)
        force = e if self.problem.config.predictive_model.force_state else none  # a state without any effect
        return Dynamics(a, a_x, M_inverse @ torque_u, force, none_x, none_u, none, none_x, none_u)

    def _rigid(self, q: Array, v: Array, drive: Array, torque_x: Array, torque_u: Array) -> Dynamics:
        """[FFMPC] eq. 4: M v̇ − Jᵀλ = τ − h, J v̇ + J̇ v + kd J v + kp e = 0, and the same system for the derivatives."""
        nv, m = self.model.nv, self.problem.m
        kp, kd = self.problem.config.contact.baumgarte
        M_inverse, bias = self._inertia(q, v)
        self._kinematics(q, v, np.zeros(nv))
        still = self._contact.motion(self.model, self.data)
        error, error_q = self._deflection(still.J) if kp > 0.0 else (np.zeros(m), np.zeros((m, nv)))
        M = _solve(M_inverse, np.eye(nv))
        system = np.block([[M, -still.J.T], [still.J, np.zeros((m, m))]])
        wanted = -(still.acceleration + kd * still.velocity + kp * error)
        solution = _solve(system, np.concatenate([drive - bias, wanted]))
        a, force = solution[:nv], solution[nv:]
        self._kinematics(q, v, a)
        motion = self._contact.motion(self.model, self.data)
        wrench = self._contact.local_wrench(self.data, force)
        wanted_x = np.zeros((m, self.ndx))
        wanted_x[:, :nv] = -(motion.acceleration_q + kd * motion.velocity_q + kp * error_q)
        wanted_x[:, nv : 2 * nv] = -(motion.acceleration_v + kd * motion.J)
        right_x = np.vstack([torque_x - self._inverse_dynamics_x(q, v, a, wrench), wanted_x])
        by_x = _solve(system, right_x)
        by_u = _solve(system, np.vstack([torque_u, np.zeros((m, self.nu))]))
        none = np.zeros((m, self.ndx)), np.zeros((m, self.nu))
        return Dynamics(a, by_x[:nv], by_u[:nv], force, by_x[nv:], by_u[nv:], np.zeros(m), *none)

    def _soft(self, q: Array, v: Array, e: Array, drive: Array, torque_x: Array, torque_u: Array) -> Dynamics:
        """Visco-elastic contact: λ is a state with λ̇ = −K J v − B (J v̇ + J̇ v), or λ = −K Δp − B J v."""
        nv, K, B = self.model.nv, self.parameters.stiffness[0], self.parameters.damping[0]
        M_inverse, bias = self._inertia(q, v)
        self._kinematics(q, v, np.zeros(nv))
        still = self._contact.motion(self.model, self.data)
        force, force_x = e, np.zeros((self.problem.m, self.ndx))
        if self.problem.config.predictive_model.force_state:
            force_x[:, 2 * nv :] = np.eye(self.problem.m)
        else:
            deflection, deflection_q = self._deflection(still.J)
            force = -K * deflection - B * still.velocity
            force_x[:, :nv] = -K[:, None] * deflection_q - B[:, None] * still.velocity_q
            force_x[:, nv : 2 * nv] = -B[:, None] * still.J
        a = M_inverse @ (drive - bias + still.J.T @ force)
        self._kinematics(q, v, a)
        motion = self._contact.motion(self.model, self.data)
        wrench = self._contact.local_wrench(self.data, force)
        a_x = M_inverse @ (torque_x - self._inverse_dynamics_x(q, v, a, wrench) + motion.J.T @ force_x)
        a_u = M_inverse @ torque_u
        rate, rate_x, rate_u = self._force_rate(motion, e, a_x, a_u)
        return Dynamics(a, a_x, a_u, force, force_x, np.zeros((self.problem.m, self.nu)), rate, rate_x, rate_u)

    def _force_rate(self, motion: ContactMotion, e: Array, a_x: Array, a_u: Array) -> tuple[Array, Array, Array]:
        """λ̇ and its derivatives, [FFMPC] eq. 18 and 23, with friction; zero where the force is no state."""
        nv, m = self.model.nv, self.problem.m
        if not self.problem.config.predictive_model.force_state:
            return np.zeros(m), np.zeros((m, self.ndx)), np.zeros((m, self.nu))
        K, B = self.parameters.stiffness[0], self.parameters.damping[0]
        velocity_x, acceleration_x = np.zeros((m, self.ndx)), motion.J @ a_x
        velocity_x[:, :nv], velocity_x[:, nv : 2 * nv] = motion.velocity_q, motion.J
        acceleration_x[:, :nv] += motion.acceleration_q
        acceleration_x[:, nv : 2 * nv] += motion.acceleration_v
        rate = -K * motion.velocity - B * motion.acceleration
        rate_x, rate_u = -K[:, None] * velocity_x - B[:, None] * acceleration_x, -B[:, None] * (motion.J @ a_u)
        friction = float(self.parameters.sliding_friction[0])
        if m >= 3 and math.isfinite(friction):
            slide = sliding_rate(rate[:2], e[:3], K[:2], friction, self.problem.config.dt)
            rate[:2] = slide.rate
            rate_x[:2], rate_u[:2] = slide.by_sticking @ rate_x[:2], slide.by_sticking @ rate_u[:2]
            rate_x[:2, 2 * nv : 2 * nv + 3] += slide.by_force
        return rate, rate_x, rate_u

    # ------------------------------------------------------------------ pinocchio

    def _inertia(self, q: Array, v: Array) -> tuple[Array, Array]:
        """M⁻¹ (nv, nv) and the bias h (nv,)."""
        mass = mass_matrix(self.model, self.data, q)
        bias = np.array(pin.nonLinearEffects(self.model, self.data, q, v))
        return _solve(mass, np.eye(self.model.nv)), bias

    def _kinematics(self, q: Array, v: Array, a: Array) -> None:
        pin.computeForwardKinematicsDerivatives(self.model, self.data, q, v, a)
        pin.updateFramePlacements(self.model, self.data)

    def _inverse_dynamics_x(self, q: Array, v: Array, a: Array, wrench: Array) -> Array:
        """(nv, ndx) ∂/∂x of M v̇ + h − Jᵀλ at constant v̇ and λ; call `_kinematics` first."""
        nv = self.model.nv
        correction = self._contact.load_correction(self.model, self.data, wrench)
        forces = self._contact.external(self.model, wrench)
        by_q, by_v, _ = pin.computeRNEADerivatives(self.model, self.data, q, v, a, forces)
        by_x = np.zeros((nv, self.ndx))
        by_x[:, :nv], by_x[:, nv : 2 * nv] = by_q - correction, by_v
        return by_x

    def _deflection(self, J: Array) -> tuple[Array, Array]:
        full = pin.getFrameJacobian(self.model, self.data, self._contact.frame, pin.LOCAL)
        return self._contact.deflection(self.data, self.parameters.anchor_translation[0], J, full)


def _solve(A: Array, b: Array) -> Array:
    return np.asarray(np.linalg.solve(A, b), dtype=np.float64)
