"""One node of the problem on any pinocchio model: trees and free bases for the bridge, a cross-check of the kernel.

The same mathematics as the compiled kernel, written with pinocchio's analytic derivatives: [FFMPC] eq. 4–8
(classical), 11–14 (torque feedback), 16–17 (naive visco-elastic), 20–24 (force feedback); costs eq. 25–29 with the full
Gauss–Newton Hessian.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant.mpc.crocoddyl.contact import ContactGeometry
from pliant.mpc.crocoddyl.node_dynamics import Dynamics, NodeDynamics
from pliant.sampling import kept_share
from pliant.spatial import Array


@dataclass(frozen=True)
class NodeValues:
    """Results of a node; names and shapes as the compiled `NodeResult`, rows and columns of the tangent space."""

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


Residual = tuple[Array, Array, Array, Array]
"""value (k,), weight (k,), derivative over x (k, ndx), over u (k, nu)"""


class PinocchioNode(NodeDynamics):
    """One node: its cost and its next state; arguments as `NodeDynamics`."""

    def evaluate(self, x: Array, u: Array) -> NodeValues:
        """Dynamics, cost and all derivatives. Args: x (nx,), u (nu,)."""
        nq, nv = self.model.nq, self.model.nv
        q, v, e = x[:nq], x[nq : nq + nv], x[nq + nv :]
        dynamics = self.dynamics(q, v, e, u)
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

    def _step(self, q: Array, v: Array, e: Array, u: Array, d: Dynamics) -> tuple[Array, Array, Array]:
        """Semi-implicit Euler, [FFMPC] eq. 8, 14, 24."""
        nv, dt, kind = self.model.nv, self.problem.config.dt, self.problem.config.predictive_model
        v_next = v + dt * d.acceleration
        v_x, v_u = dt * d.acceleration_x, dt * d.acceleration_u
        v_x[:, nv : 2 * nv] += np.eye(nv)
        by_q, by_v = (np.array(part) for part in pin.dIntegrate(self.model, q, dt * v_next))
        q_x, q_u = dt * by_v @ v_x, dt * by_v @ v_u
        q_x[:, :nv] += by_q
        e_next, e_x, e_u = e, np.zeros((len(e), self.ndx)), np.zeros((len(e), self.nu))
        if kind.force_state:
            e_next, e_x, e_u = e + dt * d.rate, dt * d.rate_x, dt * d.rate_u
            e_x[:, 2 * nv :] += np.eye(len(e))
        elif kind.torque_state:
            alpha = kept_share(self.problem.config.torque_bandwidth, dt)
            e_next = alpha * e + (1.0 - alpha) * u
            e_x[:, 2 * nv :], e_u = alpha * np.eye(len(e)), (1.0 - alpha) * np.eye(self.nu)
        x_next = np.concatenate([pin.integrate(self.model, q, dt * v_next), v_next, e_next])
        return x_next, np.vstack([q_x, v_x, e_x]), np.vstack([q_u, v_u, e_u])

    # ------------------------------------------------------------------ costs

    def _residuals(self, q: Array, v: Array, e: Array, u: Array, d: Dynamics) -> list[Residual]:
        residuals = [self._state_residual(q, v), *self._placement_residuals(q, v)]
        kind, p = self.problem.config.predictive_model, self.parameters
        active = self.problem.m > 0 and bool(p.contact_active[0])
        if active and (kind.force_state or not self.terminal):
            residuals.append((d.force - p.force_reference[0], p.force_weight[0], d.force_x, d.force_u))
        if self.terminal:
            return residuals
        residuals += self._torque_residuals(q, e, u, d)
        if active and kind.force_state:
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

    def _torque_residuals(self, q: Array, e: Array, u: Array, d: Dynamics) -> list[Residual]:
        """τ − (g(q) − Jᵀλ), [FFMPC] eq. 25.3 and 28, and τ against its reference."""
        nv, p, driven = self.model.nv, self.parameters, list(self.problem.driven)
        filtered = self.problem.config.predictive_model.torque_state
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
