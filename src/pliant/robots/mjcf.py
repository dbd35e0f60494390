"""Reads an MJCF: MuJoCo parses and compiles it, the rigid-body model is made from the compiled `mjModel`.

So defaults, includes, `<frame>`s, angles in degrees, masses from geoms and every other rule of the format are MuJoCo's
own; mass matrix, bias, gravity and frame placements agree with MuJoCo's reading of the file to 1e-9.
"""

from __future__ import annotations

import warnings
from collections.abc import Collection
from pathlib import Path

import mujoco
import numpy as np

from pliant.errors import RobotError
from pliant.robots.description import Description, require_movement
from pliant.robots.mjcf_checks import check_finite, check_joints, notes_on_forces, notes_on_units, refuse_unread
from pliant.robots.mjcf_couplings import check_couplings
from pliant.robots.mjcf_limits import torque_limits
from pliant.robots.mjcf_tree import Tree, build_tree, joint_name
from pliant.robots.mjcf_visual import visual_of
from pliant.spatial import Array


def read_mjcf(path: Path, locked: Collection[str]) -> Description:
    """Reads an MJCF of a robot on a fixed base.

    Args:
        path: the file; what it includes is found beside it.
        locked: joints that will not move. Ball and free joints among them stay where the file puts them; a coupling
            whose joint is among them no longer counts.

    Raises:
        RobotError: MuJoCo cannot compile the file, or it holds something that a tree of hinges and slides cannot
            represent; the sentence names it.
    """
    compiled = _compile(path)
    check_joints(compiled, path, locked)
    check_couplings(compiled, path, locked)
    refuse_unread(compiled, path)
    tree = build_tree(compiled, locked)
    require_movement(tree.model, path)
    limits, about_limits = torque_limits(compiled, tree)
    tree.model.upperEffortLimit = limits
    return Description(
        model=tree.model,
        visual=visual_of(compiled, tree),
        homes=_keyframes(compiled, tree),
        welded=frozenset(joint_name(compiled, i) for i in range(compiled.njnt) if i not in tree.joints),
        notes=(*tree.notes, *about_limits, *notes_on_forces(compiled, tree), *notes_on_units(compiled, tree)),
    )


def _compile(path: Path) -> mujoco.MjModel:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what matters of a file is refused or said by the checks, in their words
            compiled = mujoco.MjSpec.from_file(str(path)).compile()
    except (ValueError, RuntimeError, mujoco.FatalError, mujoco.UnexpectedError) as error:
        reason = " ".join(str(error).split())
        remedy = "; put the file where the MJCF looks for it" if "opening file" in reason else ""
        raise RobotError(f"{path} could not be read as an MJCF: MuJoCo says «{reason}»{remedy}") from error
    check_finite(compiled, path)
    return compiled


def _keyframes(compiled: mujoco.MjModel, tree: Tree) -> dict[str, Array]:
    homes: dict[str, Array] = {}
    for key in range(compiled.nkey):
        q = np.zeros(tree.model.nq)
        for joint, index in tree.joints.items():
            q[tree.model.joints[index].idx_q] = compiled.key_qpos[key][compiled.jnt_qposadr[joint]]
        homes[compiled.key(key).name or f"key{key}"] = q
    return homes
