"""A robot as a MuJoCo specification, made from its pinocchio model.

It starts from pinocchio's model and not from the robot's file. So locked joints, tools, MJCF and `package://` meshes
need no second implementation, and both libraries have the same numbers: mass matrix, bias and frame Jacobians agree to
1e-9.
"""

from __future__ import annotations

import coal
import mujoco
import numpy as np
import pinocchio as pin

from pliant.rigid_body import joint_motions
from pliant.robot import Robot
from pliant.spatial import Array, quaternion

VISUAL_GROUP = 2
"""geom group of shapes that are drawn and never touch anything"""
_LEAST = 1e-12
"""kg, kg m²: MuJoCo requires mass on every moving body, also between two joints at one point"""


def spec_from_robot(robot: Robot, looks: bool = True) -> mujoco.MjSpec:
    """A MuJoCo specification with the robot's bodies, joints, frames (as sites of the same name) and looks.

    The robot stands in an empty world under gravity; there is no joint damping, friction, actuator or contact in it.
    Joints have the names and the order of `robot.joint_names`, bodies have the name of the joint that moves them.

    Args:
        robot: any robot; joints are revolute or prismatic.
        looks: whether its shapes are in it, of which meshes take longer than all else.

    Returns:
        A specification that can be extended and compiled.
    """
    spec = mujoco.MjSpec()
    spec.modelname = robot.name
    spec.compiler.degree = False
    spec.option.gravity = np.array(robot.model.gravity.linear)
    bodies = [spec.worldbody]
    motions = joint_motions(robot.model)
    for index in range(1, robot.model.njoints):
        bodies.append(_add_body(robot, bodies, index, motions[index - 1]))
    _add_frames(robot, bodies)
    if looks:
        _add_visuals(robot, spec, bodies)
    return spec


def _add_body(robot: Robot, bodies: list[mujoco.MjsBody], index: int, axis: Array) -> mujoco.MjsBody:
    model = robot.model
    placement = model.jointPlacements[index]
    body = bodies[model.parents[index]].add_body(
        name=model.names[index], pos=placement.translation, quat=quaternion(placement.rotation)
    )
    _set_inertia(body, model.inertias[index])
    revolute = bool(np.any(axis[3:]))
    joint = body.add_joint(
        name=model.names[index],
        type=mujoco.mjtJoint.mjJNT_HINGE if revolute else mujoco.mjtJoint.mjJNT_SLIDE,
        axis=axis[3:] if revolute else axis[:3],
    )
    at = model.joints[index].idx_v
    joint.armature = model.armature[at]
    lower, upper = float(model.lowerPositionLimit[at]), float(model.upperPositionLimit[at])
    if np.isfinite([lower, upper]).all() and lower < upper and upper - lower < 1e3:
        joint.limited = mujoco.mjtLimited.mjLIMITED_TRUE
        joint.range = [lower, upper]
    return body


def _set_inertia(body: mujoco.MjsBody, inertia: pin.Inertia) -> None:
    # MuJoCo's own eigenvalue iteration stops early; doing it here keeps the mass matrix equal to 1e-9.
    values, vectors = np.linalg.eigh(np.array(inertia.inertia))
    if np.linalg.det(vectors) < 0.0:
        vectors[:, 0] *= -1.0
    if values[0] + values[1] < values[2] * (1.0 - 1e-6) - 1e-12:  # not the rounding of a rod or a point
        values[:] = values.mean()  # no body has these; MuJoCo refuses them. The plant refuses such a robot by name
    elif values[0] + values[1] < values[2]:
        values[0] = values[2] * (1.0 + 1e-15) - values[1]  # a rod or point masses, off by rounding only
    body.explicitinertial = True
    body.mass = max(inertia.mass, _LEAST)
    body.ipos = inertia.lever
    body.inertia = np.maximum(values, _LEAST)
    body.iquat = quaternion(vectors)


def _add_frames(robot: Robot, bodies: list[mujoco.MjsBody]) -> None:
    seen: set[str] = set()
    for frame in robot.model.frames:
        if frame.name in seen or frame.name == "universe":
            continue
        seen.add(frame.name)
        bodies[frame.parentJoint].add_site(
            name=frame.name,
            pos=frame.placement.translation,
            quat=quaternion(frame.placement.rotation),
            size=[0.005, 0.005, 0.005],
            group=4,
        )


def _add_visuals(robot: Robot, spec: mujoco.MjSpec, bodies: list[mujoco.MjsBody]) -> None:
    if robot.visual is None or len(robot.visual.geometryObjects) == 0:
        _add_sticks(robot, bodies)
        return
    for index, shape in enumerate(robot.visual.geometryObjects):
        _add_shape(spec, bodies[shape.parentJoint], shape, f"visual{index}")


def _add_shape(spec: mujoco.MjSpec, body: mujoco.MjsBody, shape: pin.GeometryObject, name: str) -> None:
    geometry = shape.geometry
    if isinstance(geometry, coal.Sphere):
        kind, size = mujoco.mjtGeom.mjGEOM_SPHERE, [geometry.radius, 0.0, 0.0]
    elif isinstance(geometry, coal.Cylinder):
        kind, size = mujoco.mjtGeom.mjGEOM_CYLINDER, [geometry.radius, geometry.halfLength, 0.0]
    elif isinstance(geometry, coal.Capsule):
        kind, size = mujoco.mjtGeom.mjGEOM_CAPSULE, [geometry.radius, geometry.halfLength, 0.0]
    elif isinstance(geometry, coal.Box):
        kind, size = mujoco.mjtGeom.mjGEOM_BOX, list(geometry.halfSide)
    elif isinstance(geometry, coal.BVHModelBase):
        _add_mesh(spec, body, shape, name)
        return
    else:
        return  # a shape that cannot be drawn; it plays no part in the physics
    _finish_visual(body.add_geom(name=name, type=kind, size=size), shape)


def _add_mesh(spec: mujoco.MjSpec, body: mujoco.MjsBody, shape: pin.GeometryObject, name: str) -> None:
    vertices = np.array(shape.geometry.vertices()) * np.array(shape.meshScale)
    triangles = map(shape.geometry.tri_indices, range(shape.geometry.num_tris))
    faces = np.array([(t[0], t[1], t[2]) for t in triangles], dtype=np.int32)
    if len(vertices) < 4 or len(faces) < 4:
        return
    mesh = spec.add_mesh(name=name, uservert=vertices.ravel(), userface=faces.ravel())
    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL  # closed or not, it carries no mass here
    _finish_visual(body.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name), shape)


def _finish_visual(geom: mujoco.MjsGeom, shape: pin.GeometryObject) -> None:
    geom.pos = shape.placement.translation
    geom.quat = quaternion(shape.placement.rotation)
    geom.rgba = np.array(shape.meshColor)
    geom.contype, geom.conaffinity, geom.mass, geom.group = 0, 0, 0.0, VISUAL_GROUP


def _add_sticks(robot: Robot, bodies: list[mujoco.MjsBody]) -> None:
    """A stick figure: a capsule from each joint to the next."""
    for index in range(1, robot.model.njoints):
        offset = np.array(robot.model.jointPlacements[index].translation)
        if np.linalg.norm(offset) < 1e-3:
            continue
        geom = bodies[robot.model.parents[index]].add_geom(
            type=mujoco.mjtGeom.mjGEOM_CAPSULE, size=[0.02, 0.0, 0.0], fromto=[0.0, 0.0, 0.0, *offset]
        )
        geom.rgba = [0.62, 0.64, 0.67, 1.0]
        geom.contype, geom.conaffinity, geom.mass, geom.group = 0, 0, 0.0, VISUAL_GROUP
