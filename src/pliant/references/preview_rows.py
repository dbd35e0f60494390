"""References of a phase as rows of numbers, one per instant, and previews made of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pliant.references.task_phase import TaskPhase
from pliant.references.trajectories.rotation import Orientation
from pliant.signals import Preview
from pliant.spatial import Array

POSITION, ROTATION, VELOCITY, ACCELERATION = slice(0, 3), slice(3, 12), slice(12, 18), slice(18, 24)
WRENCH, AXES = slice(24, 30), slice(30, 39)
NORMAL, NORMAL_RATE, NORMAL_BEND = slice(39, 45), slice(45, 51), slice(51, 57)
"""the third of the axes and its first two time derivatives; the last three entries of each are zero"""
_POSTURE = 57
POSTURE = slice(_POSTURE, None)
_WORLD = np.eye(3).ravel()


class Stretch(NamedTuple):
    """Consecutive nodes of a preview within one phase."""

    name: str
    """of the phase"""
    rows: Array
    """(m, w), this stretch's own: written into"""
    offset: Array | None
    """(3,) m, displacement of all of them; None: none"""
    heights: Sequence[tuple[float, float, float]]
    """m, m/s, m/s² along the normal, of each node; empty: none"""


def sampled(phase: TaskPhase, times: Array, rotation: Array, posture: Array | None) -> Array:
    """A phase at many instants of its own clock, before it is anchored.

    Args:
        phase: which one.
        times: (m,) s, m ≥ 1.
        rotation: (3, 3) R_world_frame, of a phase that has none of its own.
        posture: (n,) rad, likewise; None for none.

    Returns:
        (m, 57 + n), or (m, 57) without a posture.
    """
    if phase.posture is not None:
        posture = phase.posture.rows(times).value
    table = np.zeros((len(times), _POSTURE + (0 if posture is None else posture.shape[-1])))
    motion = phase.motion.rows(times)
    table[:, POSITION], table[:, 12:15], table[:, 18:21] = motion
    table[:, ROTATION] = rotation.ravel()
    if phase.rotation is not None:
        R, spin, change = phase.rotation.rows(times)
        table[:, ROTATION], table[:, 15:18], table[:, 21:24] = R.reshape(-1, 9), spin, change
    if phase.wrench is not None:
        table[:, WRENCH] = phase.wrench.rows(times).value
    table[:, AXES] = _WORLD
    if phase.axes is not None:
        axes = phase.axes.rows(times)
        table[:, AXES] = axes.rotation.reshape(-1, 9)
        table[:, 39:42], table[:, 45:48], table[:, 51:54] = _third_axes(axes)
    if posture is not None:
        table[:, POSTURE] = posture
    return table


def _third_axes(axes: Orientation) -> tuple[Array, Array, Array]:
    """`rotation.third_axis` of many instants, (m, 3) each."""
    R, spin, change = axes
    n = R[:, :, 2]
    if not (spin.any() or change.any()):
        return n, np.zeros_like(n), np.zeros_like(n)
    n_dot = np.cross(spin, n)
    return n, n_dot, np.cross(change, n) + np.cross(spin, n_dot)


def preview_of_rows(times: Array, stretches: Sequence[Stretch], *, turning: bool) -> Preview:
    """The preview of some instants; a posture is part of it where every instant has one.

    Args:
        times: (N+1,) s.
        stretches: in order, with N + 1 rows in all.
        turning: whether the preview has the task's axes.
    """
    for _, rows, offset, heights in stretches:
        if offset is not None:
            rows[:, POSITION] += offset
        if heights:
            lifts = np.array(heights)
            rows[:, POSITION] += lifts[:, :1] * rows[:, NORMAL][:, :3]
            rows[:, VELOCITY] += lifts[:, :1] * rows[:, NORMAL_RATE] + lifts[:, 1:2] * rows[:, NORMAL]
    tables = [stretch.rows for stretch in stretches]
    table = tables[0]
    if len(tables) > 1:
        width = min(rows.shape[1] for rows in tables)
        table = np.concatenate([rows[:, :width] for rows in tables])
    count = len(times)
    return Preview(
        time=times,
        position=table[:, POSITION],
        rotation=table[:, ROTATION].reshape(count, 3, 3),
        velocity=table[:, VELOCITY],
        wrench=table[:, WRENCH],
        phase=sum(((stretch.name,) * len(stretch.rows) for stretch in stretches), ()),
        posture=table[:, POSTURE] if table.shape[1] > _POSTURE else None,
        task_rotation=table[:, AXES].reshape(count, 3, 3) if turning else None,
    )
