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
            jacobians = [np.array(pin.computeFrameJacobian(model, data, q, frame, axes)) for frame, _ in frames]
            against = _self_motion(M, np.vstack(jacobians), v)
            for J, (_, task) in zip(jacobians, frames, strict=True):
                against = against + _beside_reference(M, J, v, task)
            found = found + self.motion_damping * against
        return found


def _self_motion(M: Array, J: Array, v: Array) -> Array:
    """(n,) −(M − Jᵀ Λ J) v, N·m·s: against what the joints do while no frame moves, Λ as below.

    An arm with more joints than its frames have axes drifts where the model's gravity errs: a Panda of twice the mass
    turned joint 2 by 1.3 rad within 6 s, to where joints 1 and 3 are in line, and ran away there.

    Args:
        M: (n, n).
        J: (6 f, n) of f frames, world axes.
        v: (n,) rad/s.
    """
    mobility = J @ np.linalg.solve(M, J.T) + _NEAR_SINGULAR * np.eye(len(J))
    return J.T @ np.linalg.solve(mobility, J @ v) - M @ v


def _beside_reference(M: Array, J: Array, v: Array, task: TaskReference) -> Array:
    """(n,) Jᵀ Λ (ẋ_d − J v), N·m·s: multiplied by a rate in 1/s, the rate at which that difference decays.

    Λ = (J M⁻¹ Jᵀ + δ² I)⁻¹ is the inertia of the frame (Khatib 1987, "A unified approach for motion and force control
    of robot manipulators", eq. 14), δ as in operational-space control. It takes power from the difference, whatever
    the posture. Rotations count where the reference has one; axes whose mode is "free" are left out.

    Args:
        M: (n, n).
        J: (6, n) of the frame, world axes.
        v: (n,) rad/s.
        task: of the frame.
    """
    rows = 3 if task.rotation is None else 6
    motion, wanted = J[:rows], task.velocity[:rows]
    if task.modes is not None:
        kept, R = ~np.array(task.modes.having("free")[:rows]), task.modes.rotation.T
        motion = np.vstack([R @ J[:3], R @ J[3:]])[:rows][kept]
        wanted = task.modes.into(task.velocity)[:rows][kept]
    mobility = motion @ np.linalg.solve(M, motion.T) + _NEAR_SINGULAR * np.eye(len(motion))
    return motion.T @ np.linalg.solve(mobility, wanted - motion @ v)
