"""Robots and surfaces as the compiled estimators take them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant._estimation import Plane, PythonSurface, Surface, Tree
from pliant.rigid_body import joint_motions
from pliant.robot import Robot
from pliant.surfaces import PlaneSurface, SurfaceGeometry


def tree_of(robot: Robot) -> Tree:
    """Kinematics and inertia of a robot, with all of its frames."""
    model = robot.model
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


def surface_facing(normal: npt.ArrayLike | SurfaceGeometry) -> SurfaceGeometry:
    """A believed surface, or the plane through the origin with an outward normal (3,) of any length above zero.

    Raises:
        ConfigError: a normal without length.
    """
    return normal if isinstance(normal, SurfaceGeometry) else PlaneSurface.facing(normal)


def compiled_surface(surface: SurfaceGeometry) -> Surface:
    """A plane in C++; every other surface is asked in Python."""
    if type(surface) is PlaneSurface:
        return Plane(surface.origin.tolist(), surface.rotation[:, 2].tolist())
    return PythonSurface(surface.near)


def _pose(pose: pin.SE3) -> tuple[list[float], list[float]]:
    return np.array(pose.rotation).ravel().tolist(), np.array(pose.translation).tolist()
