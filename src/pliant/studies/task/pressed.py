"""Along which directions a list of phases presses: the axes of its tasks, and the planes that a controller believes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pliant.references.force_axes import task_axes
from pliant.references.stages import Stage, StageChange
from pliant.spatial import Array
from pliant.surfaces import FacetSurface, PlaneSurface, SurfaceGeometry

_SAME = 1e-9
"""1 − cosine of the angle below which two directions are one"""


def with_axes(stages: Sequence[Stage], frames: Sequence[Array]) -> tuple[Stage, ...]:
    """The stages with the axes of their forces; one without a force has those of the next that presses, or of the last.

    Args: frames: (3, 3) R_world_frame of each.
    """
    own = [task_axes(frame, stage.task.wrench) for stage, frame in zip(stages, frames, strict=True)]
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


def pressed_planes(stages: Sequence[Stage], changes: Sequence[StageChange]) -> SurfaceGeometry | None:
    """The planes across the forces through the targets, one per direction; None: nothing is pressed."""
    found: list[PlaneSurface] = []
    for task in (stage.task for stage in stages):
        _add(found, task.wrench, task.position)
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
