"""The rigid-body tree of a compiled MJCF.

MuJoCo moves a body with its joints one after the other, each about its own anchor p and axis a, both in the body's
axes: T_parent_body(q) = T_0 ∏ T(p_i) R(a_i, q_i − q_0i) T(−p_i) for hinges, T_0 ∏ T(a_i (q_i − q_0i)) for slides
(documentation of MuJoCo, "Kinematic tree"). Each joint becomes one joint of the rigid-body model.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

import mujoco
import numpy as np
import pinocchio as pin

from pliant.robots.description import free_name, set_limits
from pliant.spatial import Array, rotation_of_quaternion

_HINGE = int(mujoco.mjtJoint.mjJNT_HINGE)
_AT_JOINT = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
_SINGLE = (_HINGE, int(mujoco.mjtJoint.mjJNT_SLIDE))


@dataclass
class Tree:
    """A rigid-body model under construction, with maps from the elements of the file to those of the model."""

    model: pin.Model
    joints: dict[int, int] = field(default_factory=dict[int, int])
    """MuJoCo's joint → joint of the model"""
    bodies: list[tuple[int, pin.SE3]] = field(default_factory=list[tuple[int, pin.SE3]])
    """MuJoCo's body → joint of the model that carries it, pose of the body in that joint's axes"""
    frames: dict[int, int] = field(default_factory=dict[int, int])
    """MuJoCo's body → frame of the model"""
    names: set[str] = field(default_factory=set[str])
    notes: list[str] = field(default_factory=list[str])


def joint_name(compiled: mujoco.MjModel, joint: int) -> str:
    """Name of a joint; `joint1`, `joint2`, … counted over all joints where the file gives none."""
    name = compiled.joint(joint).name
    return name or free_name(f"joint{joint + 1}", {compiled.joint(i).name for i in range(compiled.njnt)})


def actuators_of(compiled: mujoco.MjModel, joint: int) -> list[int]:
    """Actuators that act on a joint itself."""
    return [
        a
        for a in range(compiled.nu)
        if int(compiled.actuator_trntype[a]) in _AT_JOINT and int(compiled.actuator_trnid[a][0]) == joint
    ]


def build_tree(compiled: mujoco.MjModel, locked: Collection[str]) -> Tree:
    """The model with every hinge and slide; locked ball and free joints are left out, their bodies stay in place."""
    tree = Tree(pin.Model())
    tree.model.name = str(compiled.names.split(b"\x00")[0].decode("utf-8", "replace")) or "robot"
    off = bool(compiled.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY))
    tree.model.gravity = pin.Motion(np.zeros(3) if off else np.array(compiled.opt.gravity), np.zeros(3))
    tree.bodies.append((0, pin.SE3.Identity()))
    tree.frames[0] = 0
    tree.names.update({"universe", *(joint_name(compiled, i) for i in range(compiled.njnt))})
    for body in range(1, compiled.nbody):
        _add_body(tree, compiled, body)
    for site in range(compiled.nsite):
        _add_site(tree, compiled, site)
    tree.model.upperVelocityLimit = np.full(tree.model.nv, np.inf)  # the format has no speed limits
    unnamed = [joint_name(compiled, i) for i in tree.joints if not compiled.joint(i).name]
    if unnamed:
        tree.notes.append(f"joints without a name in the file are called {', '.join(unnamed)}")
    return tree


def _add_body(tree: Tree, compiled: mujoco.MjModel, body: int) -> None:
    model = tree.model
    parent = int(compiled.body_parentid[body])
    joint, at = tree.bodies[parent]
    above = tree.frames[parent]
    at = at * pose(compiled.body_pos[body], compiled.body_quat[body])
    first = int(compiled.body_jntadr[body])
    for index in range(first, first + int(compiled.body_jntnum[body])):
        if int(compiled.jnt_type[index]) not in _SINGLE:
            continue  # locked: it stays where the file puts it
        joint, at = _add_joint(tree, compiled, index, joint, at)
        name = model.names[joint]
        above = model.addFrame(pin.Frame(name, joint, above, pin.SE3.Identity(), pin.FrameType.JOINT), False)
    inertia = pin.Inertia(float(compiled.body_mass[body]), np.array(compiled.body_ipos[body]), _tensor(compiled, body))
    model.appendBodyToJoint(joint, inertia, at)
    tree.bodies.append((joint, at))
    name = compiled.body(body).name or f"body{body}"
    if name in tree.names and name == model.names[joint] and at.isIdentity(1e-12):
        tree.frames[body] = model.getFrameId(name)  # the joint's frame is the body's
        return
    tree.frames[body] = model.addFrame(
        pin.Frame(_unique(tree, name, "body"), joint, above, at, pin.FrameType.BODY), False
    )


def _add_joint(tree: Tree, compiled: mujoco.MjModel, index: int, parent: int, at: pin.SE3) -> tuple[int, pin.SE3]:
    """Adds one joint. Returns its index in the model, and the body's pose in its axes."""
    model, axis = tree.model, np.array(compiled.jnt_axis[index])
    hinge = int(compiled.jnt_type[index]) == _HINGE
    zero = float(compiled.qpos0[compiled.jnt_qposadr[index]])
    anchor = pin.SE3(np.eye(3), np.array(compiled.jnt_pos[index]) if hinge else np.zeros(3))
    kind = pin.JointModelRevoluteUnaligned(axis) if hinge else pin.JointModelPrismaticUnaligned(axis)
    joint = model.addJoint(parent, kind, at * anchor, joint_name(compiled, index))
    tree.joints[index] = joint
    back = pin.SE3(pin.exp3(-zero * axis), np.zeros(3)) if hinge else pin.SE3(np.eye(3), -zero * axis)
    dof = model.joints[joint].idx_v
    armature = np.array(model.armature)
    armature[dof] = compiled.dof_armature[compiled.jnt_dofadr[index]] + _motor_inertia(compiled, index)
    model.armature = armature
    limited = bool(compiled.jnt_limited[index])
    lower, upper = compiled.jnt_range[index] if limited else (-np.inf, np.inf)
    set_limits(model, model.joints[joint].idx_q, float(lower), float(upper))
    return joint, back * anchor.inverse()


def _motor_inertia(compiled: mujoco.MjModel, joint: int) -> float:
    """Inertia of the motors at a joint as it feels it, gear² · armature, kg m²."""
    return sum(
        float(compiled.actuator_gear[a][0]) ** 2 * float(compiled.actuator_armature[a])
        for a in actuators_of(compiled, joint)
    )


def _add_site(tree: Tree, compiled: mujoco.MjModel, site: int) -> None:
    body = int(compiled.site_bodyid[site])
    joint, at = tree.bodies[body]
    where = at * pose(compiled.site_pos[site], compiled.site_quat[site])
    name = _unique(tree, compiled.site(site).name or f"site{site}", "site")
    tree.model.addFrame(pin.Frame(name, joint, tree.frames[body], where, pin.FrameType.OP_FRAME), False)


def _unique(tree: Tree, name: str, kind: str) -> str:
    """A unique frame name; adds a note if it differs from the file's name."""
    free = name if name not in tree.names else free_name(f"{name}_{kind}", tree.names)
    if free != name:
        tree.notes.append(f"the frame of {kind} {name!r} is called {free!r}: a joint or body has its name already")
    tree.names.add(free)
    return free


def _tensor(compiled: mujoco.MjModel, body: int) -> Array:
    """Inertia about the centre of mass in the body's axes, (3, 3) kg m²."""
    R = pose(np.zeros(3), compiled.body_iquat[body]).rotation
    return np.array(R @ np.diag(compiled.body_inertia[body]) @ R.T)


def pose(pos: Array, quat: Array) -> pin.SE3:
    """A pose from MuJoCo's position (3,) m and quaternion (w, x, y, z)."""
    return pin.SE3(rotation_of_quaternion(quat), np.array(pos))
