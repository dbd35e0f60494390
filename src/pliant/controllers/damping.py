"""What damps a stack beside its impedances: its joints, and motion beside the reference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import pinocchio as pin

from pliant.controllers.operational_space import OperationalSpace
from pliant.errors import ConfigError
from pliant.rigid_body import mass_matrix
from pliant.signals import TaskReference
from pliant.spatial import Array

_NEAR_SINGULAR = OperationalSpace.singularity_damping**2  # 1/kg


@dataclass(frozen=True)
class Damping:
    """Raises ConfigError on construction for a number that no damper has."""

    joint_damping: float = 0.0
    """N·m·s/rad"""
    motion_damping: float = 0.0
    """1/s, times Λ and what a frame's velocity differs from its reference's by, and times the inertia of self-motion"""

    def __post_init__(self) -> None:
        for one in fields(self):
            value = getattr(self, one.name)
            if not (np.isfinite(value) and value >= 0.0):
                raise ConfigError(f"{one.name} must be finite and not negative, got {value}")

    @property
    def any(self) -> bool:
        """Whether it damps anything."""
        return self.joint_damping > 0.0 or self.motion_damping > 0.0

    def torque(
        self,
        model: pin.Model,
        data: pin.Data,
        q: Array,
        v: Array,
        frames: Sequence[tuple[int, TaskReference]],
    ) -> Array:
        """(n,) N·m.

        Args:
            model: of the robot.
            data: scratch space, which is changed.
            q: (n,) rad.
            v: (n,) rad/s.
            frames: index and reference of each frame.
        """
        found = -self.joint_damping * v
        if self.motion_damping:
            M = mass_matrix(model, data, q)
            axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
            J = np.vstack([pin.computeFrameJacobian(model, data, q, frame, axes) for frame, _ in frames])
            against = J.T @ _wrench(M, J, v, [task for _, task in frames]) - M @ v
            found = found + self.motion_damping * against
        return found


def _wrench(M: Array, J: Array, v: Array, tasks: Sequence[TaskReference]) -> Array:
    """(6 f,) N·s and N·m·s, world axes, of two dampings: Λ J v of self-motion, and Λ (ẋ_d − J v) of each frame.

    Jᵀ Λ J v − M v is against what the joints do while no frame moves. An arm with more joints than its frames have axes
    drifts where the model's gravity errs: a Panda of twice the mass turned joint 2 by 1.3 rad within 6 s, to where
    joints 1 and 3 are in line, and ran away there.

    Λ = (J M⁻¹ Jᵀ + δ² I)⁻¹ is the inertia of the frames (Khatib 1987, "A unified approach for motion and force control
    of robot manipulators", eq. 14), δ as in operational-space control. Of one frame whose axes are all held it is the
    same in both, and Λ ẋ_d is their sum.

    Args:
        M: (n, n).
        J: (6 f, n) of f frames, world axes.
        v: (n,) rad/s.
        tasks: of the frames.
    """
    mobility = J @ np.linalg.solve(M, J.T)
    mobility.flat[:: len(J) + 1] += _NEAR_SINGULAR
    if len(tasks) == 1 and _holds_all(tasks[0]):
        return np.asarray(np.linalg.solve(mobility, tasks[0].velocity), dtype=np.float64)
    twist = J @ v
    found = np.asarray(np.linalg.solve(mobility, twist), dtype=np.float64)
    for index, task in enumerate(tasks):
        own = slice(6 * index, 6 * index + 6)
        found[own] += _beside_reference(mobility[own, own], twist[own], task)
    return found


def _holds_all(task: TaskReference) -> bool:
    return task.rotation is not None and (task.modes is None or "free" not in task.modes.modes)


def _beside_reference(mobility: Array, twist: Array, task: TaskReference) -> Array:
    """(6,) Λ (ẋ_d − J v), N·s and N·m·s: multiplied by a rate in 1/s, the rate at which that difference decays.

    It takes power from the difference, whatever the posture. Rotations count where the reference has one; axes whose
    mode is "free" are left out.

    Args:
        mobility: (6, 6) Λ⁻¹ of the frame, world axes.
        twist: (6,) J v.
        task: of the frame.
    """
    rows = np.eye(6)
    if task.modes is not None:
        rows[:3, :3] = rows[3:, 3:] = task.modes.rotation.T
        rows = rows[~np.array(task.modes.having("free"))]
    if task.rotation is None:
        rows = rows[~rows[:, 3:].any(axis=1)]
    return rows.T @ np.linalg.solve(rows @ mobility @ rows.T, rows @ (task.velocity - twist))
