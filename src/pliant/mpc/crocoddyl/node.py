"""One node of the problem on any pinocchio model: trees and free bases for the bridge, a second opinion on the kernel.

The same mathematics as the compiled kernel, written with pinocchio's analytic derivatives: [FFMPC] eq. 4–8
(classical), 11–14 (torque feedback), 16–17 (naive visco-elastic), 20–24 (force feedback); costs eq. 25–29 with the full
Gauss–Newton Hessian.
"""

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
from pliant.spatial import Array


@dataclass(frozen=True)
class NodeValues:
    """What a node yields; names and shapes as the compiled `NodeResult`, rows and columns of the tangent space."""

    cost: float
    x_next: Array
    acceleration: Array
    force: Array
    force_rate: Array
    fx: Array
    fu: Array
    Lx: Array
    Lu: Array
    Lxx: Array
    Lxu: Array
    Luu: Array


@dataclass(frozen=True)
class _Dynamics:
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


Residual = tuple[Array, Array, Array, Array]
"""value (k,), weight (k,), derivative over x (k, ndx), over u (k, nu)"""


class PinocchioNode:
    """One node.

    Args:
        problem: bound to any model.
        terminal: the last node, which has no dynamics.

    Raises:
        ConfigError: the exponential integrator, which only the kernel has; Baumgarte's position term in 6 dimensions.
    """

    def __init__(self, problem: MpcProblem, *, terminal: bool = False) -> None:
        contact = problem.config.contact
        if problem.config.kind == "force_feedback" and contact.integrator != "euler":
            raise ConfigError("models in Python integrate the force with 'euler' only, got integrator = 'exponential'")
        springy = contact.baumgarte[0] > 0.0 or problem.config.kind == "naive_viscoelastic"
        if springy and problem.m == 6:
            raise ConfigError("models in Python have no contact spring in 6 dimensions: use dimension 1 or 3")
        self.problem, self.terminal = problem, terminal
        self.model, self.data = problem.model, problem.model.createData()
        self.parameters = PlainNodes.zeros(1, self.model.nq, self.model.nv, problem.nu, problem.m)
        rows = AXES_OF_DIMENSION[problem.m] if problem.m else ()
        frame = self.model.getFrameId(problem.contact_frame)
        self._frame, self._rows = frame, rows
        self._tool = self.model.getFrameId(problem.config.frame)
        extra = {"force_feedback": problem.m, "torque_feedback": problem.nu}.get(problem.config.kind, 0)
        self.nx, self.ndx, self.nu = self.model.nq + self.model.nv + extra, 2 * self.model.nv + extra, problem.nu
        self._select = np.zeros((self.model.nv, self.nu))
        self._select[list(problem.driven), np.arange(self.nu)] = 1.0

    @property
    def _contact(self) -> ContactGeometry:
        axes = self.problem.config.contact.axes
        R = self.parameters.task_rotation[0] if axes == "surface" else np.eye(3)
        return ContactGeometry(self._frame, axes, self._rows, R)

    # ------------------------------------------------------------------ evaluation

    def evaluate(self, x: Array, u: Array) -> NodeValues:
        """Dynamics, cost and all derivatives. Args: x (nx,), u (nu,)."""
        nq, nv = self.model.nq, self.model.nv
        q, v, e = x[:nq], x[nq : nq + nv], x[nq + nv :]
        dynamics = self._dynamics(q, v, e, u)
        x_next, fx, fu = self._step(q, v, e, u, dynamics)
        residuals = self._residuals(q, v, e, u, dynamics)
        scale = 1.0 if self.terminal else self.problem.config.dt
        cost, gradient, hessian = 0.0, np.zeros(self.ndx + self.nu), np.zeros((self.ndx + self.nu,) * 2)
        for value, weight, by_x, by_u in residuals:
            by = np.hstack([by_x, by_u])
            cost += 0.5 * scale * float(weight @ (value * value))
            gradient += scale * by.T @ (weight * value)
            hessian += scale * by.T @ (weight[:, None] * by)
        n = self.ndx
        return NodeValues(
            cost,
            x_next,
            dynamics.acceleration,
            dynamics.force,
            dynamics.rate,
            fx,
            fu,
            gradient[:n],
            gradient[n:],
            hessian[:n, :n],
            hessian[:n, n:],
            hessian[n:, n:],
        )

    # ------------------------------------------------------------------ dynamics

    def _dynamics(self, q: Array, v: Array, e: Array, u: Array) -> _Dynamics:
        kind, nv = self.problem.config.kind, self.model.nv
        torque = e if kind == "torque_feedback" else u
        torque_x, torque_u = np.zeros((nv, self.ndx)), self._select
        if kind == "torque_feedback":
            torque_x[:, 2 * nv :], torque_u = self._select, np.zeros((nv, self.nu))
        drive = self._select @ torque
        if self.problem.m == 0 or not self.parameters.contact_active[0]:
            return self._without_contact(q, v, e, drive, torque_x, torque_u)
        if kind in ("classical", "torque_feedback"):
            return self._rigid(q, v, drive, torque_x, torque_u)
        return self._soft(q, v, e, drive, torque_x, torque_u)

    def _without_contact(
        self, q: Array, v: Array, e: Array, drive: Array, torque_x: Array, torque_u: Array
    ) -> _Dynamics:
        m = self.problem.m
        M_inverse, bias = self._inertia(q, v)
        a = M_inverse @ (drive - bias)
        self._kinematics(q, v, a)
        a_x = M_inverse @ (torque_x - self._inverse_dynamics_x(q, v, a, np.zeros(6)))
        none_x, none_u, none = np.zeros((m, self.ndx)), np.zeros((m, self.nu)), np.zeros(m)
        force = e if self.problem.config.kind == "force_feedback" else none  # a state that acts on nothing
        return _Dynamics(a, a_x, M_inverse @ torque_u, force, none_x, none_u, none, none_x, none_u)

    def _rigid(self, q: Array, v: Array, drive: Array, torque_x: Array, torque_u: Array) -> _Dynamics:
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
        return _Dynamics(a, by_x[:nv], by_u[:nv], force, by_x[nv:], by_u[nv:], np.zeros(m), *none)

    def _soft(self, q: Array, v: Array, e: Array, drive: Array, torque_x: Array, torque_u: Array) -> _Dynamics:
        """Visco-elastic contact: λ is a state with λ̇ = −K J v − B (J v̇ + J̇ v), or λ = −K Δp − B J v."""
        nv, K, B = self.model.nv, self.parameters.stiffness[0], self.parameters.damping[0]
        M_inverse, bias = self._inertia(q, v)
        self._kinematics(q, v, np.zeros(nv))
        still = self._contact.motion(self.model, self.data)
        force, force_x = e, np.zeros((self.problem.m, self.ndx))
        if self.problem.config.kind == "force_feedback":
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
        return _Dynamics(a, a_x, a_u, force, force_x, np.zeros((self.problem.m, self.nu)), rate, rate_x, rate_u)

    def _force_rate(self, motion: ContactMotion, e: Array, a_x: Array, a_u: Array) -> tuple[Array, Array, Array]:
        """λ̇ and its derivatives, [FFMPC] eq. 18 and 23, with friction; zero where the force is no state."""
        nv, m = self.model.nv, self.problem.m
        if self.problem.config.kind != "force_feedback":
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

    def _step(self, q: Array, v: Array, e: Array, u: Array, d: _Dynamics) -> tuple[Array, Array, Array]:
        """Semi-implicit Euler, [FFMPC] eq. 8, 14, 24."""
        nv, dt, kind = self.model.nv, self.problem.config.dt, self.problem.config.kind
        v_next = v + dt * d.acceleration
        v_x, v_u = dt * d.acceleration_x, dt * d.acceleration_u
        v_x[:, nv : 2 * nv] += np.eye(nv)
        by_q, by_v = (np.array(part) for part in pin.dIntegrate(self.model, q, dt * v_next))
        q_x, q_u = dt * by_v @ v_x, dt * by_v @ v_u
        q_x[:, :nv] += by_q
        e_next, e_x, e_u = e, np.zeros((len(e), self.ndx)), np.zeros((len(e), self.nu))
        if kind == "force_feedback":
            e_next, e_x, e_u = e + dt * d.rate, dt * d.rate_x, dt * d.rate_u
            e_x[:, 2 * nv :] += np.eye(len(e))
        elif kind == "torque_feedback":
            alpha = math.exp(-2.0 * math.pi * self.problem.config.torque_bandwidth * dt)
            e_next = alpha * e + (1.0 - alpha) * u
            e_x[:, 2 * nv :], e_u = alpha * np.eye(len(e)), (1.0 - alpha) * np.eye(self.nu)
        x_next = np.concatenate([pin.integrate(self.model, q, dt * v_next), v_next, e_next])
        return x_next, np.vstack([q_x, v_x, e_x]), np.vstack([q_u, v_u, e_u])

    # ------------------------------------------------------------------ costs

    def _residuals(self, q: Array, v: Array, e: Array, u: Array, d: _Dynamics) -> list[Residual]:
        residuals = [self._state_residual(q, v), *self._placement_residuals(q, v)]
        kind, p = self.problem.config.kind, self.parameters
        active = self.problem.m > 0 and bool(p.contact_active[0])
        if active and (kind == "force_feedback" or not self.terminal):
            residuals.append((d.force - p.force_reference[0], p.force_weight[0], d.force_x, d.force_u))
        if self.terminal:
            return residuals
        residuals += self._torque_residuals(q, e, u, d)
        if active and kind == "force_feedback":
            residuals.append((d.rate, p.force_rate_weight[0], d.rate_x, d.rate_u))
        return residuals

    def _state_residual(self, q: Array, v: Array) -> Residual:
        nq, nv, reference = self.model.nq, self.model.nv, self.parameters.state_reference[0]
        by_x = np.zeros((2 * nv, self.ndx))
        by_x[:nv, :nv] = pin.dDifference(self.model, reference[:nq], q)[1]
        by_x[nv:, nv : 2 * nv] = np.eye(nv)
        value = np.concatenate([pin.difference(self.model, reference[:nq], q), v - reference[nq:]])
        return value, self.parameters.state_weight[0], by_x, np.zeros((2 * nv, self.nu))

    def _placement_residuals(self, q: Array, v: Array) -> list[Residual]:
        """Tool position and twist in task axes, orientation."""
        nv, p = self.model.nv, self.parameters
        self._kinematics(q, v, np.zeros(nv))
        placement = self.data.oMf[self._tool]
        R, J = np.array(placement.rotation), pin.getFrameJacobian(self.model, self.data, self._tool, pin.LOCAL)
        error = pin.log3(p.rotation_reference[0].T @ R)
        log_slope = pin.Jlog3(p.rotation_reference[0].T @ R)
        to_task = p.task_rotation[0].T
        whole = ContactGeometry(self._tool, "surface", (0, 1, 2, 3, 4, 5), to_task.T).motion(self.model, self.data)
        twist = np.concatenate([to_task @ p.velocity_reference[0, :3], to_task @ p.velocity_reference[0, 3:]])
        offset = to_task @ (placement.translation - p.translation_reference[0])

        def over_q(by_q: Array) -> Array:
            return np.hstack([by_q, np.zeros((len(by_q), self.ndx - nv))])

        twist_x = over_q(whole.velocity_q)
        twist_x[:, nv : 2 * nv] = whole.J
        none = np.zeros((6, self.nu))
        return [
            (offset, p.translation_weight[0], over_q(to_task @ R @ J[:3]), none[:3]),
            (np.array(error), p.rotation_weight[0], over_q(log_slope @ J[3:]), none[:3]),
            (whole.velocity - twist, p.velocity_weight[0], twist_x, none),
        ]

    def _torque_residuals(self, q: Array, e: Array, u: Array, d: _Dynamics) -> list[Residual]:
        """τ − (g(q) − Jᵀλ), [FFMPC] eq. 25.3 and 28, and τ against its reference."""
        nv, p, driven = self.model.nv, self.parameters, list(self.problem.driven)
        filtered = self.problem.config.kind == "torque_feedback"
        load, load_x = np.zeros(nv), np.zeros((nv, self.ndx))
        load_u = np.zeros((nv, self.nu))
        wrench = np.zeros(6)
        if self.problem.m and p.contact_active[0]:
            wrench = self._contact.local_wrench(self.data, d.force)
            J = self._contact.motion(self.model, self.data).J
            load_x, load_u = -J.T @ d.force_x, -J.T @ d.force_u
        forces = self._contact.external(self.model, wrench)
        correction = self._contact.load_correction(self.model, self.data, wrench)
        load_x[:, :nv] += pin.computeStaticTorqueDerivatives(self.model, self.data, q, forces) - correction
        load = np.array(pin.computeStaticTorque(self.model, self.data, q, forces))
        load, load_x, load_u = load[driven], load_x[driven], load_u[driven]
        direct, state = np.eye(self.nu), np.zeros((self.nu, self.ndx))
        control = (u - p.control_reference[0], p.control_weight[0], state, direct)
        about_gravity = (u - load, p.torque_gravity_weight[0], -load_x, direct - load_u)
        if not filtered:
            return [control, about_gravity]
        state[:, 2 * nv :] = direct
        torque = (e - load, p.torque_gravity_weight[0], state - load_x, -load_u)
        control = (u - p.control_reference[0], p.control_weight[0], np.zeros_like(state), direct)
        return [control, torque, (u - load, p.control_gravity_weight[0], -load_x, direct - load_u)]

    # ------------------------------------------------------------------ pinocchio

    def _inertia(self, q: Array, v: Array) -> tuple[Array, Array]:
        """M⁻¹ (nv, nv) and the bias h (nv,)."""
        upper = np.triu(pin.crba(self.model, self.data, q))
        bias = np.array(pin.nonLinearEffects(self.model, self.data, q, v))
        return _solve(upper + np.triu(upper, 1).T, np.eye(self.model.nv)), bias

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
