"""A default home configuration for an arm without one: bent, tool down, away from singularities.

Poses drawn in the inner part of the joints' ranges start an inverse kinematics towards a place in front of the base;
the best conditioned of what it reaches is the home. The draws are seeded: the same file gives the same home.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from pliant.robots.chain import Arm
from pliant.spatial import Array

_DRAWS, _STARTS, _STEPS = 200, 10, 80
_INNER, _REACHED = 0.8, 0.95
"""share of each joint's range in which poses are drawn and sought; the wider one where the other has none"""
_FULL = 6
"""joints with which a place and a direction can be reached"""
_TOLERANCE = 1e-3
"""m, and 1 for the direction"""


def bent_home(model: pin.Model, arm: Arm) -> tuple[Array, bool]:
    """A configuration (n,) of the arm, and whether its flange points down.

    Joints beside the arm are at zero, or at the nearest angle in their limits.
    """
    data = model.createData()
    low, high = _inner_range(model, arm)
    rng = np.random.default_rng(0)
    draws = [np.where(high > low, rng.uniform(low, np.maximum(high, low + 1e-12)), low) for _ in range(_DRAWS)]
    draws.sort(key=lambda q: -_comfort(model, data, arm, q))
    for share in (_INNER, _REACHED) if len(arm.joints) >= _FULL else ():
        ends = _inner_range(model, arm, share)
        reached = [_reach_down(model, data, arm, q, *ends) for q in draws[:_STARTS]]
        found = [q for q in reached if q is not None]
        if found:
            return max(found, key=lambda q: _comfort(model, data, arm, q)), True
    return draws[0], False


def zero_home(model: pin.Model) -> Array:
    """(n,) zero, or the nearest angle within the limits."""
    return np.clip(np.zeros(model.nq), np.array(model.lowerPositionLimit), np.array(model.upperPositionLimit))


def _inner_range(model: pin.Model, arm: Arm, share: float = _INNER) -> tuple[Array, Array]:
    still = zero_home(model)
    low, high = still.copy(), still.copy()
    for joint in arm.joints:
        at = model.joints[joint].idx_q
        lower = max(float(model.lowerPositionLimit[at]), -np.pi)
        upper = min(float(model.upperPositionLimit[at]), np.pi)
        if lower < upper:
            middle, half = 0.5 * (lower + upper), 0.5 * share * (upper - lower)
            low[at], high[at] = middle - half, middle + half
    return low, high


def _up(model: pin.Model) -> Array:
    gravity = np.array(model.gravity.linear)
    size = float(np.linalg.norm(gravity))
    return -gravity / size if size > 0.0 else np.array([0.0, 0.0, 1.0])


def _comfort(model: pin.Model, data: pin.Data, arm: Arm, q: Array) -> float:
    """Least singular value of the Jacobian, lengths in reaches; less where the arm goes below its base."""
    whole = np.array(pin.computeFrameJacobian(model, data, q, arm.flange, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED))
    J = whole[:, [model.joints[j].idx_v for j in arm.joints]]
    J[:3] /= max(arm.reach, 1e-6)
    rows = J if J.shape[1] >= _FULL else J[:3]
    value = float(np.linalg.svd(rows, compute_uv=False)[-1])
    pin.framesForwardKinematics(model, data, q)
    heights = [float(_up(model) @ (data.oMi[j].translation - data.oMi[arm.joints[0]].translation)) for j in arm.joints]
    heights.append(float(_up(model) @ (data.oMf[arm.flange].translation - data.oMi[arm.joints[0]].translation)))
    depth = max(0.0, -min(heights)) / max(arm.reach, 1e-6)
    return value - depth if np.dot(_up(model), [0.0, 0.0, 1.0]) > 0.0 else value


def _reach_down(model: pin.Model, data: pin.Data, arm: Arm, q: Array, low: Array, high: Array) -> Array | None:
    """Damped least squares from q to a place in front of the base, the flange's z axis along gravity."""
    up = _up(model)
    pin.forwardKinematics(model, data, q)
    shoulder = np.array(data.oMi[arm.joints[1]].translation)
    target = shoulder + arm.reach * (0.5 * np.array([1.0, 0.0, 0.0]) + 0.05 * up)
    for _ in range(_STEPS):
        pin.framesForwardKinematics(model, data, q)
        pose = data.oMf[arm.flange]
        turn = np.cross(pose.rotation[:, 2], -up)
        if pose.rotation[:, 2] @ up > 0.99:
            turn = np.array(pose.rotation[:, 0])  # exactly opposite: any rotation helps
        error = np.concatenate([target - pose.translation, turn])
        if np.linalg.norm(error) < _TOLERANCE and pose.rotation[:, 2] @ up < 0.0:
            return q
        J = np.array(pin.computeFrameJacobian(model, data, q, arm.flange, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED))
        step = J.T @ np.linalg.solve(J @ J.T + 1e-4 * np.eye(6), np.clip(error, -0.3, 0.3))
        q = np.clip(q + step, low, high)
    return None
