"""Along which directions a list of phases presses: the axes of its tasks, and the planes that a controller believes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pliant.axis_modes import AXIS_NAMES, Mode
from pliant.references.force_axes import task_axes
from pliant.references.stages import Stage, StageChange
from pliant.signals import TaskReference
from pliant.spatial import Array
from pliant.surfaces import FacetSurface, PlaneSurface, SurfaceGeometry

_SAME = 1e-9
"""1 − cosine of the angle below which two directions are one"""


def with_axes(stages: Sequence[Stage]) -> tuple[Stage, ...]:
    """The stages with the axes of their forces; one without a force has those of the next that presses, or of the
    last."""
    own = [task_axes(_frame(stage.task), pressed_along(stage.task)) for stage in stages]
    after: Array | None = None
    filled = list[Array | None]()
    for axes in reversed(own):
        after = after if axes is None else axes
        filled.insert(0, after)
    last = next((axes for axes in reversed(own) if axes is not None), None)
    return tuple(
        replace(stage, task=replace(stage.task, task_rotation=last if axes is None else axes))
        for stage, axes in zip(stages, filled, strict=True)
    )


def pressed_along(task: TaskReference) -> Array:
    """(3,) along which a task presses, of any length: its force, or the last force axis on which 0 N are asked for;
    zero without one."""
    if np.any(task.wrench[:3]) or task.modes is None:
        return task.wrench[:3]
    asked = [axis for axis in range(3) if task.modes.modes[axis] == "force"]
    return task.modes.rotation[:, asked[-1]] if asked else np.zeros(3)


def asked_of(task: TaskReference) -> tuple[Mode, ...]:
    """(6,) modes of a task; empty where it has none."""
    return () if task.modes is None else task.modes.modes


def beside_the_force(stage: Stage) -> tuple[str, ...]:
    """Axes of which a phase asks something else than a motion or a part of its force: 0 N, a moment, or nothing; three
    free rotations are an orientation that is left alone."""
    modes, told = asked_of(stage.task), stage.task.modes
    if told is None:
        return ()
    wrench = told.into(stage.task.wrench)
    small = 1e-9 * max(float(np.abs(wrench).max()), 1e-9)
    silent = [place for place in range(6) if modes[place] == "force" and (place >= 3 or abs(wrench[place]) <= small)]
    loose = [place for place in range(3) if modes[place] == "free"]
    if "free" in modes[3:] and set(modes[3:]) != {"free"}:
        loose += [place for place in range(3, 6) if modes[place] == "free"]
    return tuple(AXIS_NAMES[place] for place in sorted(silent + loose))


def _frame(task: TaskReference) -> Array:
    return np.eye(3) if task.modes is None else task.modes.rotation


def pressed_planes(stages: Sequence[Stage], changes: Sequence[StageChange]) -> SurfaceGeometry | None:
    """The planes across the forces through the targets, one per direction; None: nothing is pressed."""
    found: list[PlaneSurface] = []
    for task in (stage.task for stage in stages):
        _add(found, pressed_along(task), task.position)
    place = stages[-1].task.position
    for change in changes:
        place = place if change.target is None else change.target
        if change.wrench is not None:
            _add(found, change.wrench, place)
    return FacetSurface.of(found) if found else None


def _add(found: list[PlaneSurface], wrench: Array, place: Array) -> None:
    size = float(np.linalg.norm(wrench[:3]))
    if size == 0.0:
        return
    direction = wrench[:3] / size
    if all(1.0 - float(plane.rotation[:, 2] @ direction) > _SAME for plane in found):
        found.append(PlaneSurface.facing(direction, place))
