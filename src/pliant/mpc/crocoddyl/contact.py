"""Velocity and acceleration of a contact frame in any axes, with derivatives, from pinocchio."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from pliant.mpc.config import Axes
from pliant.spatial import Array, skew


@dataclass(frozen=True)
class ContactMotion:
    """Motion of the contact frame; m rows in contact axes."""

    J: Array
    """(m, nv) velocity = J v"""
    velocity: Array
    """(m,) m/s, rad/s"""
    velocity_q: Array
    """(m, nv) ∂(J v)/∂q"""
    acceleration: Array
    """(m,) d(J v)/dt = J v̇ + J̇ v: the classical acceleration in axes that stand still, else the spatial one"""
    acceleration_q: Array
    """(m, nv), at constant v̇"""
    acceleration_v: Array
    """(m, nv)"""


@dataclass(frozen=True)
class ContactGeometry:
    """Contact frame, and the effect of its forces on the joints."""

    frame: int
    axes: Axes
    rows: tuple[int, ...]
    """components of the (6,) contact force that the model has"""
    R_world_axes: Array
    """(3, 3) axes of the contact that do not turn with the frame"""

    def motion(self, model: pin.Model, data: pin.Data) -> ContactMotion:
        """Needs `pin.computeForwardKinematicsDerivatives` at (q, v, v̇) and updated frames in `data`."""
        v_q, J = (np.array(part) for part in pin.getFrameVelocityDerivatives(model, data, self.frame, pin.LOCAL))
        _, a_q, a_v, _ = (
            np.array(part) for part in pin.getFrameAccelerationDerivatives(model, data, self.frame, pin.LOCAL)
        )
        twist = pin.getFrameVelocity(model, data, self.frame, pin.LOCAL)
        spatial = pin.getFrameAcceleration(model, data, self.frame, pin.LOCAL)
        velocity, acceleration = np.array(twist.vector), np.array(spatial.vector)
        if self.axes != "local":  # the axes stand still while the frame turns with J[3:] dq
            W, V = skew(twist.angular), skew(twist.linear)
            acceleration[:3] += np.cross(twist.angular, twist.linear)  # classical from spatial
            a_q[:3] += W @ v_q[:3] - V @ v_q[3:]
            a_v[:3] += W @ J[:3] - V @ J[3:]
            v_q -= _turning(velocity, J[3:])
            a_q -= _turning(acceleration, J[3:])
        A = self.rotation(data)
        return ContactMotion(
            *(self._rows(A, part) for part in (J, velocity, v_q, acceleration, a_q, a_v)),
        )

    def rotation(self, data: pin.Data) -> Array:
        """(3, 3) from the frame's own axes to the contact axes."""
        if self.axes == "local":
            return np.eye(3)
        R_world_frame = np.array(data.oMf[self.frame].rotation)
        return self.R_world_axes.T @ R_world_frame

    def local_wrench(self, data: pin.Data, force: Array) -> Array:
        """(6,) wrench in the frame's own axes of a contact force (m,) in contact axes."""
        wrench = np.zeros(6)
        wrench[list(self.rows)] = force
        A = self.rotation(data)
        return np.concatenate([A.T @ wrench[:3], A.T @ wrench[3:]])

    def external(self, model: pin.Model, wrench: Array) -> pin.StdVec_Force:
        """The wrench (6,) as external forces on the joints, in pinocchio's format."""
        forces = pin.StdVec_Force([pin.Force.Zero() for _ in range(model.njoints)])
        frame = model.frames[self.frame]
        forces[frame.parentJoint] = frame.placement.act(pin.Force(wrench))
        return forces

    def load_correction(self, model: pin.Model, data: pin.Data, wrench: Array) -> Array:
        """(nv, nv) ∂(Jᵀλ)/∂q of a force whose axes stand still, minus that of one that turns with the frame.

        pinocchio differentiates external forces as if they were constant in the body's axes; d(Rᵀ f) = (Rᵀ f) × ω dt.
        """
        if self.axes == "local":
            return np.zeros((model.nv, model.nv))
        J = pin.getFrameJacobian(model, data, self.frame, pin.LOCAL)
        return J[:3].T @ skew(wrench[:3]) @ J[3:] + J[3:].T @ skew(wrench[3:]) @ J[3:]

    def deflection(self, data: pin.Data, anchor: Array, J: Array, full: Array) -> tuple[Array, Array]:
        """Displacement (m,) from an anchor (3,) m in contact axes, dimensions 1 and 3, and its (m, nv) derivative.

        Args:
            data: frames updated.
            anchor: m.
            J: (m, nv) contact Jacobian.
            full: (6, nv) Jacobian in the frame's own axes.
        """
        placement = data.oMf[self.frame]
        local = placement.rotation.T @ (placement.translation - anchor)
        A = self.rotation(data)
        derivative = J if self.axes != "local" else J + (skew(local) @ full[3:])[list(self.rows)]
        return (A @ local)[list(self.rows)], derivative

    def _rows(self, A: Array, part: Array) -> Array:
        return np.concatenate([A @ part[:3], A @ part[3:]])[list(self.rows)]


def _turning(vector: Array, angular: Array) -> Array:
    """(6, nv) change of a (6,) vector's local components when the axes turn with `angular` (3, nv) dq."""
    return np.vstack([skew(vector[:3]) @ angular, skew(vector[3:]) @ angular])
