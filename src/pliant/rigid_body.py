"""Functions of a rigid-body model that pinocchio does not have."""

from __future__ import annotations

from functools import cache

import numpy as np
import pinocchio as pin

from pliant._estimation import Tree
from pliant.spatial import Array


def mass_matrix(model: pin.Model, data: pin.Data, q: Array) -> Array:
    """M(q) (n, n), rotor inertia included, kg m² (kg for prismatic joints). Both triangles are filled."""
    M = np.asarray(pin.crba(model, data, q))
    return np.where(_below(len(M)), M.T, M)  # pinocchio does not fill the lower one reliably


@cache
def _below(n: int) -> Array:
    """(n, n) bool: what lies below the diagonal. Made once: `np.triu` makes it anew, which took longer than M."""
    return np.tri(n, k=-1, dtype=bool)


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


def tree_of(model: pin.Model) -> Tree:
    """Kinematics and inertia as the compiled cores take them, with all frames."""
    motions = joint_motions(model)
    joints = []
    for index in range(1, model.njoints):
        motion, inertia = motions[index - 1], model.inertias[index]
        turns = bool(np.any(motion[3:]))
        joints.append(
            (
                int(model.parents[index]) - 1,
                _pose(model.jointPlacements[index]),
                (motion[3:] if turns else motion[:3]).tolist(),
                not turns,
                float(inertia.mass),
                np.array(inertia.lever).tolist(),
                np.array(inertia.inertia).ravel().tolist(),
                float(model.armature[index - 1]),
            )
        )
    frames = [(frame.name, int(frame.parentJoint) - 1, _pose(frame.placement)) for frame in model.frames]
    return Tree(joints, frames, np.array(model.gravity.linear).tolist())


def _pose(pose: pin.SE3) -> tuple[list[float], list[float]]:
    return np.array(pose.rotation).ravel().tolist(), np.array(pose.translation).tolist()
