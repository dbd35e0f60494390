"""Orientation of a tool on a surface: its z axis into the surface, tilted relative to the direction of travel."""

from __future__ import annotations

import numpy as np

from pliant.spatial import Array, unit_rows


def tool_rotations(
    places: Array, normals: Array, heading: Array, tilt: float = 0.0, lean: float = 0.0, smooth: float = 0.01
) -> Array:
    """Orientations along a path.

    Args:
        places: (k, 3) m.
        normals: (k, 3) outward.
        heading: (3,) direction that the tool's x axis follows as far as it can, world axes.
        tilt: rad, from the normal in the direction of travel: the tool's end trails.
        lean: rad, from the normal to the left of the direction of travel.
        smooth: m of path length before and after a point over which the direction of travel is averaged, so that the
            tilt changes continuously at a reversal.

    Returns:
        R_world_tool (k, 3, 3): z = −n but for tilt and lean.
    """
    z = -normals
    if tilt or lean:
        travel = _smooth_travel(places, smooth)
        travel = travel - normals * np.sum(travel * normals, axis=1, keepdims=True)
        left = np.cross(normals, travel)
        # the handle leans forward (left): z = −n rotated towards −travel (−left)
        z = unit_rows(z - np.tan(tilt) * travel - np.tan(lean) * left)
    return np.stack(_axes(z, heading), axis=2)


def task_rotations(normals: Array, heading: Array) -> Array:
    """R_world_task (k, 3, 3): the third axis is the outward normal, the first one follows `heading` (3,)."""
    return np.stack(_axes(normals, heading), axis=2)


def _axes(z: Array, heading: Array) -> tuple[Array, Array, Array]:
    """x, y, z axes (k, 3) each; x is `heading` laid across z, carried along where that has no length."""
    x = np.empty_like(z)
    last = heading / np.linalg.norm(heading)
    for i, axis in enumerate(z):
        flat = heading - axis * float(axis @ heading)
        if float(flat @ flat) < 1e-2 * float(heading @ heading):  # z within 6° of the heading: carry x along
            flat = last - axis * float(axis @ last)
        last = x[i] = flat / np.linalg.norm(flat)
    return x, np.cross(z, x), z


def _smooth_travel(places: Array, window: float) -> Array:
    """(k, 3) mean unit direction of travel within ± window m of path length; shorter than one where the path turns."""
    steps = np.diff(places, axis=0)
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(steps, axis=1))])
    low, high = np.maximum(s - window, 0.0), np.minimum(s + window, s[-1])
    along = np.column_stack([np.interp(high, s, column) - np.interp(low, s, column) for column in places.T])
    return along / np.maximum(high - low, 1e-9)[:, None]
