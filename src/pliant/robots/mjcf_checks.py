"""Checks of an MJCF: content that a tree of hinges and slides cannot represent is refused by name; ignored content is
noted."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import mujoco
import numpy as np

from pliant.errors import RobotError
from pliant.robots.description import lock_hint
from pliant.robots.mjcf_tree import Tree, actuators_of, joint_name
from pliant.robots.urdf_numbers import LONGEST, WIDEST

_NARROWEST = 0.07
"""rad, 4°: a range below that was most likely written in rad and read in degrees"""
_KINDS = {int(mujoco.mjtJoint.mjJNT_BALL): "a ball joint", int(mujoco.mjtJoint.mjJNT_FREE): "a free joint"}


def check_joints(compiled: mujoco.MjModel, path: Path, locked: Collection[str]) -> None:
    """Raises RobotError for a ball or free joint that is not locked."""
    for joint in range(compiled.njnt):
        kind, name = _KINDS.get(int(compiled.jnt_type[joint])), joint_name(compiled, joint)
        if kind is not None and name not in locked:
            raise RobotError(
                f"{path}: joint {name!r} is {kind}; joints must be hinges or slides, or be locked where the file puts"
                f" them: {lock_hint(name)}"
            )


def check_finite(compiled: mujoco.MjModel, path: Path) -> None:
    """Raises RobotError for a number that is not finite, which MuJoCo would compile."""
    for what, values in (
        ("gravity", compiled.opt.gravity),
        ("the place of a body", compiled.body_pos),
        ("the direction of a body", compiled.body_quat),
        ("the centre of mass of a body", compiled.body_ipos),
        ("the mass of a body", compiled.body_mass),
        ("the inertia of a body", compiled.body_inertia),
        ("the place of a joint", compiled.jnt_pos),
        ("the range of a joint", compiled.jnt_range),
        ("the zero of a joint (ref)", compiled.qpos0),
        ("the place of a site", compiled.site_pos),
        ("a keyframe", compiled.key_qpos),
    ):
        if not np.isfinite(values).all():
            raise RobotError(f"{path}: {what} is not a finite number; look for nan and inf in the file")


def refuse_unread(compiled: mujoco.MjModel, path: Path) -> None:
    """Raises RobotError for features of MuJoCo that a rigid-body tree does not have."""
    if compiled.nflex:
        raise RobotError(f"{path}: {compiled.nflex} deformable bodies (flex) cannot be part of a robot; remove them")
    tied = [compiled.tendon(t).name or f"number {t + 1}" for t in np.flatnonzero(compiled.tendon_armature)]
    if tied:
        raise RobotError(f"{path}: tendon {tied[0]!r} has armature, which couples joints' inertia; remove it")


def notes_on_units(compiled: mujoco.MjModel, tree: Tree) -> list[str]:
    """Notes about ranges and lengths that seem to be in another unit; MuJoCo accepts them."""
    notes: list[str] = []
    wide, narrow = list[str](), list[str]()
    for joint, index in tree.joints.items():
        if int(compiled.jnt_type[joint]) != int(mujoco.mjtJoint.mjJNT_HINGE) or not compiled.jnt_limited[joint]:
            continue
        size = float(np.abs(compiled.jnt_range[joint]).max())
        (wide if size > WIDEST else narrow if size < _NARROWEST else list[str]()).append(tree.model.names[index])
    if wide:
        notes.append(
            f"the range of {', '.join(wide)} is more than four turns; angles in degrees need <compiler angle='degree'>"
        )
    if narrow:
        notes.append(
            f"the range of {', '.join(narrow)} is narrower than ±4°; angles in rad need <compiler angle='radian'>"
        )
    far = [compiled.body(b).name or f"body{b}" for b in range(1, compiled.nbody) if _far(compiled, b)]
    if far:
        notes.append(f"{far[0]!r} lies more than {LONGEST:g} m from its parent; lengths are in metres")
    return notes


def _far(compiled: mujoco.MjModel, body: int) -> bool:
    return compiled.body_parentid[body] > 0 and bool(np.linalg.norm(compiled.body_pos[body]) > LONGEST)


def notes_on_forces(compiled: mujoco.MjModel, tree: Tree) -> list[str]:
    """Notes about forces of the file that are ignored."""
    notes: list[str] = []
    names = [(joint, tree.model.names[index]) for joint, index in tree.joints.items()]
    dof = compiled.jnt_dofadr
    damped = [
        name for joint, name in names if compiled.dof_damping[dof[joint]] or compiled.dof_frictionloss[dof[joint]]
    ]
    if damped:
        notes.append(f"joint damping and friction of the file are ignored ({', '.join(damped)}): set them in the plant")
    sprung = [name for joint, name in names if compiled.jnt_stiffness[joint]]
    if sprung:
        notes.append(f"joint springs of the file are ignored ({', '.join(sprung)})")
    at_joints = {a for joint in range(compiled.njnt) for a in actuators_of(compiled, joint)}
    if len(at_joints) < compiled.nu:
        notes.append(f"{compiled.nu - len(at_joints)} actuators of the file act on no joint and are ignored")
    if compiled.opt.density > 0.0 or compiled.opt.viscosity > 0.0:
        notes.append("the file's medium (density, viscosity) is ignored")
    if np.any(compiled.body_gravcomp):
        notes.append("the file's gravity compensation (gravcomp) is ignored: set it in the plant")
    if compiled.ntendon:
        notes.append(f"{compiled.ntendon} tendons of the file are ignored")
    return notes
