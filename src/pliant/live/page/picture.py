"""The scene at one instant, from a tick of a loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pliant.live.link.messages import Picture
from pliant.live.page.curves import Columns
from pliant.live.page.task_error import TaskError
from pliant.signals import Reference, Tick
from pliant.simulation import Push
from pliant.spatial import Array
from pliant.visual_shapes import Poser

_NOTHING = np.zeros(3)


def picture(
    run: int, tick: Tick, columns: Columns, body: Poser, ghost: Poser, pushes: Sequence[Push], offset: Array
) -> Picture:
    """The scene of a tick.

    Args:
        run: number of the run.
        tick: what happened.
        columns: says which frame and which channels matter.
        body: of the robot and the things.
        ghost: a second one, for the reference posture.
        pushes: that act.
        offset: (3,) m of the target, from the page.
    """
    truth, reference = tick.truth, tick.reference
    q, objects = (tick.measurement.q, {}) if truth is None else (truth.q, truth.objects)
    positions, quaternions = body.bodies(q, objects)
    posture = reference.posture
    task = reference.tasks[0] if reference.tasks else None
    target = None if task is None else task.position
    here = body.frame(columns.frame) if columns.frame else None
    asked = _asked(tick, columns)
    return Picture(
        run=run,
        time=tick.measurement.time,
        positions=positions,
        quaternions=quaternions,
        ghost=None if posture is None else ghost.bodies(posture, objects),
        tool=positions[-1] if here is None else here,
        target=target,
        nominal=None if target is None else target - offset,
        contacts=_forces(tick, body),
        asked=asked,
        predicted_path=_predicted(tick, "mpc/predicted_path", reference),
        predicted_force=_predicted(tick, "mpc/predicted_force", None),
        pushes=_pushes(pushes, body),
        phase=reference.phase,
        error=_error(tick),
        environments=dict(tick.estimate.environments),
        surfaces=dict(tick.estimate.surfaces),
    )


def _forces(tick: Tick, body: Poser) -> Mapping[str, tuple[Array, Array]]:
    source = tick.estimate.wrenches if tick.truth is None else tick.truth.wrenches
    found: dict[str, tuple[Array, Array]] = {}
    for frame, wrench in source.items():
        at = body.frame(frame)
        if at is not None:
            found[frame] = at, wrench[:3]
    return found


def _error(tick: Tick) -> TaskError | None:
    """Of the first task, on what really happens; of a robot that is not simulated nothing is known for sure."""
    if tick.truth is None or not tick.reference.tasks:
        return None
    task = tick.reference.tasks[0]
    place, wrench = tick.truth.positions.get(task.frame), tick.truth.wrenches.get(task.frame)
    return None if place is None or wrench is None else TaskError.of(task, place, wrench[:3])


def _asked(tick: Tick, columns: Columns) -> Array:
    """(3,) N, desired reaction on the robot: from the reference if it has a wrench, else from the controller."""
    if tick.reference.tasks and np.any(tick.reference.tasks[0].wrench[:3]):
        return tick.reference.tasks[0].wrench[:3]
    if columns.command_wrench:
        pull: Array = np.asarray(tick.command.diagnostics[columns.command_wrench])[:3]
        return pull
    return _NOTHING


def _predicted(tick: Tick, channel: str, reference: Reference | None) -> Array | None:
    value = tick.command.diagnostics.get(channel)
    if value is not None:
        rows = np.asarray(value)
        if rows.ndim == 2 and rows.shape[1] >= 3 and np.isfinite(rows).all():
            return rows[:, :3]
    if reference is not None and reference.preview is not None:
        return reference.preview.position
    return None


def _pushes(pushes: Sequence[Push], body: Poser) -> Mapping[str, tuple[Array, Array]]:
    found: dict[str, tuple[Array, Array]] = {}
    for push in pushes:
        at = body.frame(push.frame)
        if at is not None:
            found[push.frame] = at, found.get(push.frame, (at, _NOTHING))[1] + np.array(push.force)
    return found
