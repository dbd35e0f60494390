"""What a tree of hinges and slides cannot represent is refused by name; what plays no part is said."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import mujoco
import numpy as np

from pliant.errors import RobotError
from pliant.robots.mjcf_tree import Tree, joint_name

_KINDS = {int(mujoco.mjtJoint.mjJNT_BALL): "a ball joint", int(mujoco.mjtJoint.mjJNT_FREE): "a free joint"}


def check_joints(compiled: mujoco.MjModel, path: Path, locked: Collection[str]) -> None:
    """Raises RobotError for a ball or free joint that is not locked."""
    for joint in range(compiled.njnt):
        kind, name = _KINDS.get(int(compiled.jnt_type[joint])), joint_name(compiled, joint)
        if kind is not None and name not in locked:
            raise RobotError(
                f"{path}: joint {name!r} is {kind}; joints must be hinges or slides, or be locked where the file puts"
                f" them: locked={{{name!r}: 0}}"
            )


def check_couplings(compiled: mujoco.MjModel, path: Path, locked: Collection[str]) -> None:
    """Raises RobotError for an equality that binds joints or bodies which move."""
    for index in range(compiled.neq):
        if not compiled.eq_active0[index]:
            continue
        kind, one, other = (int(a[index]) for a in (compiled.eq_type, compiled.eq_obj1id, compiled.eq_obj2id))
        if kind == int(mujoco.mjtEq.mjEQ_JOINT):
            _check_joint_coupling(compiled, path, locked, one, other)
        else:
            name = compiled.equality(index).name or f"number {index + 1}"
            what = mujoco.mjtEq(kind).name.removeprefix("mjEQ_").lower()
            raise RobotError(
                f"{path}: equality {name!r} ({what}) closes a loop or ties bodies together, which a tree of joints"
                " cannot represent; remove it, or set active='false' and lock the joints that it moves"
            )


def _check_joint_coupling(compiled: mujoco.MjModel, path: Path, locked: Collection[str], one: int, other: int) -> None:
    follower = joint_name(compiled, one)
    master = joint_name(compiled, other) if other >= 0 else None
    if follower in locked:
        return
    told = f"follows joint {master!r}" if master is not None else "is held at a fixed position"
    raise RobotError(
        f"{path}: joint {follower!r} {told} (an equality of the file), and coupled joints are not simulated; lock it:"
        f" locked={{{follower!r}: 0.0}}"
    )


def refuse_unread(compiled: mujoco.MjModel, path: Path) -> None:
    """Raises RobotError for what MuJoCo has and a rigid-body tree has not."""
    if compiled.nflex:
        raise RobotError(f"{path}: {compiled.nflex} deformable bodies (flex) cannot be part of a robot; remove them")
    tied = [compiled.tendon(t).name or f"number {t + 1}" for t in np.flatnonzero(compiled.tendon_armature)]
    if tied:
        raise RobotError(f"{path}: tendon {tied[0]!r} has armature, which couples joints' inertia; remove it")


def notes_on_forces(compiled: mujoco.MjModel, tree: Tree) -> list[str]:
    """What of the file's forces plays no part."""
    notes: list[str] = []
    names = [(joint, tree.model.names[index]) for joint, index in tree.joints.items()]
    dof = compiled.jnt_dofadr
    damped = [
        name for joint, name in names if compiled.dof_damping[dof[joint]] or compiled.dof_frictionloss[dof[joint]]
    ]
    if damped:
        notes.append(
            f"joint damping and friction of the file play no part ({', '.join(damped)}): say them in the plant"
        )
    sprung = [name for joint, name in names if compiled.jnt_stiffness[joint]]
    if sprung:
        notes.append(f"joint springs of the file play no part ({', '.join(sprung)})")
    if np.any(compiled.body_gravcomp):
        notes.append("the file's gravity compensation (gravcomp) plays no part: say it in the plant")
    if compiled.ntendon:
        notes.append(f"{compiled.ntendon} tendons of the file play no part")
    return notes
