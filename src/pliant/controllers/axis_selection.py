"""Motion, force and free axes of a task (Mason 1981; Khatib 1987)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from pliant.axis_modes import AxisModes, modes_of_wrench
from pliant.signals import TaskReference
from pliant.spatial import Array

Flags = npt.NDArray[np.bool_]


class Selection(NamedTuple):
    """The axes of a task of 3 or 6 rows, k of which are not free."""

    into: Array
    """(k, rows) that takes vectors of world axes into those of the task, free ones left out"""
    force: Flags
    """(k,) which axes press; the others move"""
    wrench: Array
    """(k,) desired wrench along them, N and N·m"""


def selection_of(task: TaskReference, *, touches: bool, presses: bool) -> Selection | None:
    """The axes of a task; None where all axes are motion axes; world axes are then sufficient.

    An axis on which a force is asked for moves until there is contact, and presses from then on; an axis with a desired
    force of 0 N is a force axis at once.

    Args:
        task: with its modes, or with a wrench that implies them.
        touches: whether there is contact.
        presses: whether the controller regulates forces; if not, only free axes count.
    """
    modes = task.modes
    if modes is None:
        if not presses or not task.wrench.any():
            return None
        axes = np.eye(3) if task.task_rotation is None else task.task_rotation
        told = AxisModes(("motion",) * 6, axes).into(task.wrench)
        told[np.abs(told) < 1e-9 * np.abs(told).max()] = 0.0
        modes = AxisModes(modes_of_wrench(told.tolist(), oriented=True), axes)
    rows = 3 if task.rotation is None else 6
    kept = ~np.array(modes.having("free")[:rows])
    wanted = modes.into(task.wrench)[:rows]
    force = np.array(modes.having("force")[:rows]) & (touches | (np.abs(wanted) < 1e-9)) & presses
    if kept.all() and not force.any():
        return None
    into = np.zeros((rows, rows))
    for part in range(0, rows, 3):
        into[part : part + 3, part : part + 3] = modes.rotation.T
    return Selection(into[kept], force[kept], wanted[kept])
