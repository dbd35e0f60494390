"""Equalities of an MJCF: couplings of joints or bodies that move are refused by name; those of locked joints are
ignored."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import mujoco

from pliant.errors import RobotError
from pliant.robots.description import lock_hint
from pliant.robots.mjcf_tree import joint_name


def check_couplings(compiled: mujoco.MjModel, path: Path, locked: Collection[str]) -> None:
    """Raises RobotError for an equality that binds joints or bodies which move."""
    for index in range(compiled.neq):
        if not compiled.eq_active0[index]:
            continue
        if int(compiled.eq_type[index]) == int(mujoco.mjtEq.mjEQ_JOINT):
            _check_joint_coupling(compiled, path, locked, index)
        else:
            _check_tie(compiled, path, locked, index)


def _check_joint_coupling(compiled: mujoco.MjModel, path: Path, locked: Collection[str], index: int) -> None:
    one, other = int(compiled.eq_obj1id[index]), int(compiled.eq_obj2id[index])
    follower = joint_name(compiled, one)
    master = joint_name(compiled, other) if other >= 0 else None
    if follower in locked:
        return
    told = f"follows joint {master!r}" if master is not None else "is held at a fixed position"
    raise RobotError(
        f"{path}: joint {follower!r} {told} (an equality of the file), and coupled joints are not simulated; lock it:"
        f" {lock_hint(follower, float(compiled.eq_data[index][0]))}"
    )


def _check_tie(compiled: mujoco.MjModel, path: Path, locked: Collection[str], index: int) -> None:
    """An equality between bodies or tendons is refused if one of its joints is free."""
    free = [name for name in (joint_name(compiled, j) for j in _tied_joints(compiled, index)) if name not in locked]
    if not free:
        return
    name = compiled.equality(index).name or f"number {index + 1}"
    what = mujoco.mjtEq(int(compiled.eq_type[index])).name.removeprefix("mjEQ_").lower()
    raise RobotError(
        f"{path}: equality {name!r} ({what}) closes a loop or ties bodies together, which a tree of joints cannot"
        f" represent; remove it, or lock the joints that it binds: {', '.join(free)}"
    )


def _tied_joints(compiled: mujoco.MjModel, index: int) -> list[int]:
    """Joints that an equality between bodies, sites or tendons binds; all joints where the kind is another."""
    kind, one, other = (int(a[index]) for a in (compiled.eq_type, compiled.eq_obj1id, compiled.eq_obj2id))
    if kind == int(mujoco.mjtEq.mjEQ_TENDON):
        return sorted({j for tendon in (one, other) if tendon >= 0 for j in _joints_of_tendon(compiled, tendon)})
    if kind not in (int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD)):
        return list(range(compiled.njnt))
    if int(compiled.eq_objtype[index]) == int(mujoco.mjtObj.mjOBJ_SITE):
        one, other = int(compiled.site_bodyid[one]), int(compiled.site_bodyid[other])
    above, beyond = _bodies_above(compiled, one), _bodies_above(compiled, max(other, 0))
    return sorted(j for body in above ^ beyond for j in _joints_at(compiled, body))


def _bodies_above(compiled: mujoco.MjModel, body: int) -> set[int]:
    found: set[int] = set()
    while body > 0:
        found.add(body)
        body = int(compiled.body_parentid[body])
    return found


def _joints_at(compiled: mujoco.MjModel, body: int) -> range:
    first = int(compiled.body_jntadr[body])
    return range(first, first + int(compiled.body_jntnum[body]))


def _joints_of_tendon(compiled: mujoco.MjModel, tendon: int) -> list[int]:
    first = int(compiled.tendon_adr[tendon])
    wraps = range(first, first + int(compiled.tendon_num[tendon]))
    at_joints = [w for w in wraps if int(compiled.wrap_type[w]) == int(mujoco.mjtWrap.mjWRAP_JOINT)]
    return [int(compiled.wrap_objid[w]) for w in at_joints] or list(range(compiled.njnt))
