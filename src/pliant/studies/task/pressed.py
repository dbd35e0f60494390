"""Along which directions a list of phases presses: the axes of its tasks, and the planes that a controller believes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pliant.axis_modes import AXIS_NAMES, Asked, AxisModes, Mode
from pliant.references.force_axes import task_axes
from pliant.references.placed_phases import PhaseChange, PlacedPhase
from pliant.signals import TaskReference
from pliant.spatial import Array
from pliant.surfaces import FacetSurface, PlaneSurface, SurfaceGeometry
from pliant.tasks.phase import Phase

_ALIGNED = 0.02
"""rad, by which an axis of a phase may be off one of the moved frame and still be called the same"""
_SAME = 1e-9
"""1 − cosine of the angle below which two directions are one"""
_PLAIN: tuple[Asked, ...] = ("motion", "motion", "press")
_MOTION: tuple[Asked, ...] = ("motion", "motion", "motion")


def with_axes(all_placed: Sequence[PlacedPhase]) -> tuple[PlacedPhase, ...]:
    """The phases with the axes of their forces; one without a force has those of the next that presses, or of the
    last."""
    own = [task_axes(_frame(placed.task), pressed_along(placed.task)) for placed in all_placed]
    after: Array | None = None
    filled = list[Array | None]()
    for axes in reversed(own):
        after = after if axes is None else axes
        filled.insert(0, after)
    last = next((axes for axes in reversed(own) if axes is not None), None)
    return tuple(
        replace(placed, task=replace(placed.task, task_rotation=last if axes is None else axes))
        for placed, axes in zip(all_placed, filled, strict=True)
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


def asked_axes(task: TaskReference) -> tuple[Asked, ...] | None:
    """What a task asks of its three axes, the third along its force; None where they are not those of its modes."""
    modes, axes = task.modes, task.task_rotation
    if modes is None:
        return None
    turn = (np.eye(3) if axes is None else axes).T @ modes.rotation
    place = np.argmax(np.abs(turn), axis=1)
    if 1.0 - float(np.abs(turn[np.arange(3), place]).min()) > _SAME:
        return None
    presses = bool(np.any(task.wrench[:3]))
    forces: tuple[Asked, ...] = ("yield", "yield", "press" if presses else "yield")
    told = [modes.modes[axis] for axis in place.tolist()]
    return tuple(force if mode == "force" else mode for mode, force in zip(told, forces, strict=True))


def axes_of(all_placed: Sequence[PlacedPhase], turns: Mapping[str, tuple[bool, ...]]) -> dict[str, tuple[Asked, ...]]:
    """Phase → what it asks of the three axes of its task; empty where no phase asks for more than one force that
    presses, a motion beside it and an orientation. Args: turns: what single rotations are asked for."""
    found = {placed.name: asked_axes(placed.task) or _PLAIN for placed in all_placed}
    told = any(one not in (_PLAIN, _MOTION) for one in found.values()) or turns
    return found if told else {}


def turns_of(
    all_placed: Sequence[PlacedPhase], phases: Sequence[Phase], rotation: Array | None = None
) -> dict[str, tuple[bool, ...]]:
    """Phase → which of the moved frame's own three rotations it holds, for each phase whose modes leave some of them
    free.

    Args:
        phases: of a list.
        phases: the same, as the file says them.
        rotation: R_world_frame that every phase is given; None: each has its own, or none.
    """
    both = zip(all_placed, phases, strict=True)
    found = {placed.name: _held_turns(placed.task, rotation) for placed, phase in both if phase.modes is not None}
    return {name: held for name, held in found.items() if held is not None and not all(held)}


def _held_turns(task: TaskReference, rotation: Array | None) -> tuple[bool, ...] | None:
    """(3,) about the moved frame's axes; None where a phase says nothing of them, or what it leaves free is about
    axes that are not the frame's own."""
    R = task.rotation if rotation is None else rotation
    if task.modes is None or R is None:
        return None
    into = R.T @ task.modes.rotation
    kept = into @ np.diag([float(mode != "free") for mode in task.modes.modes[3:]]) @ into.T
    held = np.diag(kept) > 0.5
    if np.abs(kept - np.diag(held.astype(np.float64))).max() > _ALIGNED:
        return None
    return tuple(held.tolist())


def beside_the_axes(placed: PlacedPhase, *, feels: bool, rotation: Array | None = None) -> tuple[str, ...]:
    """Axes of which a phase asks what weights on the axes of its task cannot say: a moment, a free rotation about what
    is no axis of the moved frame, or 0 N and freedom beside a force that is along none of them. Three free rotations
    are an orientation that is left alone.

    Args:
        phase: of the phase.
        feels: whether the measured force is predicted; if not, no axis yields to it.
        rotation: as `turns_of`.
    """
    told = placed.task.modes
    if told is None:
        return ()
    odd = [place for place in range(3, 6) if told.modes[place] == "force"]
    if "free" in told.modes[3:] and set(told.modes[3:]) != {"free"} and _held_turns(placed.task, rotation) is None:
        odd += [place for place in range(3, 6) if told.modes[place] == "free"]
    turned = asked_axes(placed.task) is None
    odd += [place for place in _silent(told, placed.task.wrench) if place < 3 and (turned or not feels)]
    odd += [place for place in range(3) if turned and told.modes[place] == "free"]
    return tuple(AXIS_NAMES[place] for place in sorted(odd))


def silent_axes(placed: PlacedPhase) -> tuple[str, ...]:
    """Axes on which a phase asks for 0 N or 0 N·m."""
    told = placed.task.modes
    return () if told is None else tuple(AXIS_NAMES[place] for place in _silent(told, placed.task.wrench))


def _silent(modes: AxisModes, wrench: Array) -> list[int]:
    told = modes.into(wrench)
    small = 1e-9 * max(float(np.abs(told).max()), 1e-9)
    return [place for place in range(6) if modes.modes[place] == "force" and abs(told[place]) <= small]


def _frame(task: TaskReference) -> Array:
    return np.eye(3) if task.modes is None else task.modes.rotation


def pressed_planes(all_placed: Sequence[PlacedPhase], changes: Sequence[PhaseChange]) -> SurfaceGeometry | None:
    """The planes across the forces through the targets, one per direction; None: nothing is pressed."""
    found: list[PlaneSurface] = []
    for task in (placed.task for placed in all_placed):
        _add(found, pressed_along(task), task.position)
    place = all_placed[-1].task.position
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
