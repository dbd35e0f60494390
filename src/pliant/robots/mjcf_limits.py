"""Torque limits of a compiled MJCF: from its actuators and its joints' `actuatorfrcrange`."""

from __future__ import annotations

import mujoco
import numpy as np

from pliant.robots.mjcf_tree import Tree, actuators_of, joint_name
from pliant.spatial import Array


def torque_limits(compiled: mujoco.MjModel, tree: Tree) -> tuple[Array, list[str]]:
    """Largest torque (N·m) or force (N) of each joint of the model, and notes about it.

    An actuator gives gear · forcerange; a motor without one, gear · gain · ctrlrange. Several actuators at a joint add
    up. Where a range is not symmetric the smaller side counts. Infinite where the file limits nothing.
    """
    limits, notes = np.full(tree.model.nv, np.inf), list[str]()
    lopsided, servos = list[str](), list[str]()
    for joint, index in tree.joints.items():
        name, dof = joint_name(compiled, joint), tree.model.joints[index].idx_v
        ranges = [_force_range(compiled, a) for a in actuators_of(compiled, joint)]
        servos += [name for a in actuators_of(compiled, joint) if not _is_motor(compiled, a)]
        total = np.sum(ranges, axis=0) if ranges else np.array([-np.inf, np.inf])
        if compiled.jnt_actfrclimited[joint]:
            low, high = compiled.jnt_actfrcrange[joint]
            total = np.array([max(total[0], low), min(total[1], high)])
        if min(-total[0], total[1]) > 0.0 and not np.isclose(-total[0], total[1], rtol=1e-9):
            lopsided.append(name)
        least = min(-total[0], total[1])
        if least <= 0.0:
            notes.append(
                f"the actuators of {name} cannot push both ways ({total[0]:g} to {total[1]:g}): no limit is taken there"
            )
        limits[dof] = least if least > 0.0 else np.inf
    if servos:
        notes.append(
            f"the actuators of {', '.join(dict.fromkeys(servos))} are servos: their force limits count, their gains"
            " play no part, since torques are sent"
        )
    if lopsided:
        notes.append(f"the force range of {', '.join(lopsided)} is not symmetric: its smaller side is the torque limit")
    free = [tree.model.names[i] for i in tree.joints.values() if not np.isfinite(limits[tree.model.joints[i].idx_v])]
    if free:
        notes.append(f"no torque limit in the file for {', '.join(free)}: nothing is clamped there")
    return limits, notes


def _is_motor(compiled: mujoco.MjModel, actuator: int) -> bool:
    return (
        int(compiled.actuator_gaintype[actuator]) == int(mujoco.mjtGain.mjGAIN_FIXED)
        and int(compiled.actuator_biastype[actuator]) == int(mujoco.mjtBias.mjBIAS_NONE)
        and int(compiled.actuator_dyntype[actuator]) == int(mujoco.mjtDyn.mjDYN_NONE)
    )


def _force_range(compiled: mujoco.MjModel, actuator: int) -> Array:
    """Least and most generalised force (2,) of an actuator at its joint."""
    low, high = -np.inf, np.inf
    if compiled.actuator_forcelimited[actuator]:
        low, high = compiled.actuator_forcerange[actuator]
    if compiled.actuator_ctrllimited[actuator] and _is_motor(compiled, actuator):
        ends = compiled.actuator_gainprm[actuator][0] * compiled.actuator_ctrlrange[actuator]
        low, high = max(low, float(ends.min())), min(high, float(ends.max()))
    gear = float(compiled.actuator_gear[actuator][0])
    with np.errstate(invalid="ignore"):
        ends = np.nan_to_num(gear * np.array([low, high]), nan=0.0, posinf=np.inf, neginf=-np.inf)
    return np.array([ends.min(), ends.max()])
