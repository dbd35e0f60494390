"""The axes of a force: where its third one points, and which the other two are."""

from __future__ import annotations

import numpy as np

from pliant.spatial import Array, frame_with_z_along

_SAME = 1e-9
"""1 − cosine of the angle below which two directions are one"""


def task_axes(frame: Array, wrench: Array) -> Array | None:
    """R_world_task (3, 3) of a wrench: its third column is the direction of the force, where that is an axis of the
    frame the other two are the frame's; None without a force.

    Args:
        frame: (3, 3) R_world_frame.
        wrench: (6,) or (3,) desired reaction, world axes, N.
    """
    size = float(np.linalg.norm(wrench[:3]))
    if size == 0.0:
        return None
    direction = wrench[:3] / size
    along = frame.T @ direction
    axis = int(np.argmax(np.abs(along)))
    if 1.0 - abs(along[axis]) > _SAME:
        return frame_with_z_along(direction)
    after, last = (axis + 1) % 3, (axis + 2) % 3
    if along[axis] < 0.0:  # a frame whose third axis is turned round keeps its handedness
        after, last = last, after
    return np.column_stack([frame[:, after], frame[:, last], direction])
