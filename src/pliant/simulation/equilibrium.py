"""The torque that keeps a robot at rest where it stands."""

from __future__ import annotations

import mujoco
import numpy as np

from pliant.spatial import Array

_NOTHING = 1e-9  # N·m; less is rounding


def holding_torque(model: mujoco.MjModel, data: mujoco.MjData, n: int, limit: Array) -> Array:
    """Joint torques for zero acceleration of the robot, (n,) N·m.

    They balance the weight that is not compensated otherwise, and the forces of contacts and stops.

    Args:
        model: compiled; the robot's n joints come first.
        data: at rest, after `mj_forward` with whatever acts besides; its accelerations are changed.
        n: number of joints.
        limit: (n,) the result stays within it, N·m.
    """
    acting = data.qfrc_smooth + data.qfrc_bias - data.qfrc_passive  # joint torques and forces on bodies, as applied
    data.qacc[:n] = 0.0
    mujoco.mj_inverse(model, data)
    torque = data.qfrc_inverse[:n] - acting[:n]
    return np.clip(np.where(np.abs(torque) > _NOTHING, torque, 0.0), -limit, limit)
