"""Previews from rows of numbers: an instant is packed once and used in the previews of many ticks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pliant.signals import Preview
from pliant.spatial import Array

Moved = tuple[Array, float, float]
"""displacement of an instant: offset (3,) m; height along the normal, m, and its rate, m/s"""

_POSITION, _VELOCITY, _WRENCH = slice(0, 3), slice(12, 18), slice(18, 24)
_ROTATION, _AXES = slice(3, 12), slice(24, 33)
_NORMAL, _NORMAL_RATE = slice(33, 36), slice(36, 42)
_POSTURE = 42
_WORLD = np.eye(3).ravel()


def packed(
    position: Array,
    rotation: Array,
    velocity: Array,
    wrench: Array,
    axes: Array | None,
    normal: tuple[Array, Array, Array] | None,
    posture: Array | None,
) -> Array:
    """One instant as a row.

    Args:
        position: (3,) m.
        rotation: (3, 3).
        velocity: (6,) m/s, rad/s.
        wrench: (6,) N, N·m.
        axes: (3, 3) R_world_task; None: the world's.
        normal: the third of the axes and its first two time derivatives, (6,) each; None: it does not turn.
        posture: (n,) rad; None: none.
    """
    row = np.zeros(_POSTURE + (0 if posture is None else len(posture)))
    row[_POSITION], row[_ROTATION] = position, rotation.ravel()
    row[_VELOCITY], row[_WRENCH] = velocity, wrench
    row[_AXES] = _WORLD if axes is None else axes.ravel()
    if normal is not None:
        row[_NORMAL], row[_NORMAL_RATE] = normal[0][:3], normal[1]
    if posture is not None:
        row[_POSTURE:] = posture
    return row


def preview_of_rows(
    times: Array, rows: Sequence[Array], moved: Sequence[Moved], phase: tuple[str, ...], *, turning: bool
) -> Preview:
    """The preview of some instants; a posture is part of it where every instant has one.

    Args:
        times: (N+1,) s.
        rows: N + 1 of `packed`.
        moved: displacement of each of them.
        phase: (N+1,) names.
        turning: whether the preview has the task's axes.
    """
    count = len(times)
    width = min(map(len, rows))
    table = np.array(rows if width == max(map(len, rows)) else [row[:_POSTURE] for row in rows])
    position, velocity = table[:, _POSITION], table[:, _VELOCITY]
    position += np.array([offset for offset, _, _ in moved])
    if any(height != 0.0 or rate != 0.0 for _, height, rate in moved):
        height = np.array([[by, rate] for _, by, rate in moved])
        position += height[:, :1] * table[:, _NORMAL]
        velocity += height[:, :1] * table[:, _NORMAL_RATE]
        velocity[:, :3] += height[:, 1:] * table[:, _NORMAL]
    return Preview(
        time=times,
        position=position,
        rotation=table[:, _ROTATION].reshape(count, 3, 3),
        velocity=velocity,
        wrench=table[:, _WRENCH],
        phase=phase,
        posture=table[:, _POSTURE:] if table.shape[1] > _POSTURE else None,
        task_rotation=table[:, _AXES].reshape(count, 3, 3) if turning else None,
    )
