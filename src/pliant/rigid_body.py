"""Functions of a rigid-body model that pinocchio does not have."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from pliant.spatial import Array


def mass_matrix(model: pin.Model, data: pin.Data, q: Array) -> Array:
    """M(q) (n, n), rotor inertia included, kg m² (kg for prismatic joints). Both triangles are filled."""
    upper = np.triu(np.asarray(pin.crba(model, data, q)))  # pinocchio does not fill the lower one reliably
    return upper + np.triu(upper, 1).T


def joint_motions(model: pin.Model) -> list[Array]:
    """Motion of each joint in its own axes, (6,) linear first: of unit length, either linear or angular."""
    data = model.createData()
    neutral = pin.neutral(model)
    return [
        np.array(pin.computeJointJacobian(model, data, neutral, index)).reshape(6, -1)[:, model.joints[index].idx_v]
        for index in range(1, model.njoints)
    ]


def mass_along(model: pin.Model, q: Array, frame: int, direction: Array) -> float:
    """1 / (dᵀ J M⁻¹ Jᵀ d), kg: what a frame weighs for a force along a unit vector d (3,) of the world at q (n,)."""
    data = model.createData()
    J = pin.computeFrameJacobian(model, data, q, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    along = direction @ np.array(J)[:3]
    return 1.0 / float(along @ np.linalg.solve(mass_matrix(model, data, q), along))
