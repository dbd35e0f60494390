"""Shapes, paths and forces as markers of a 3-D view."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from pliant.spatial import Array, rotation_of_quaternion
from pliant.telemetry.mcap.scene_messages import Marker, MarkerKind
from pliant.visual_shapes import Look

_MOST_TRIANGLES = 20_000  # of one shape; a finer mesh is drawn coarser
_CELLS = 64  # along the longest edge of a mesh that is drawn coarser
_ARROW = 5e-3  # m/N
_RED = (0.85, 0.15, 0.15, 1.0)
_LEAST_FORCE = 0.05  # N


def markers_of(looks: Sequence[Look], frame_of: Callable[[int], str]) -> list[Marker]:
    """Every shape as markers. Args: frame_of: number of a body → the frame that it moves with."""
    found: list[Marker] = []
    for look in looks:
        group = "robot" if look.robot else "scene"
        for kind, scale, offset, points in _parts(look):
            position = np.array(look.position) + offset * rotation_of_quaternion(look.quaternion)[:, 2]
            frame = frame_of(look.body)
            found.append(Marker(frame, group, len(found), kind, scale, look.rgba, position, look.quaternion, points))
    return found


def line(group: str, rgba: tuple[float, float, float, float], points: Array, number: int) -> Marker:
    """A path (n, 3) in m through the world."""
    return Marker("world", group, number, "line", (0.003, 0.0, 0.0), rgba, points=points)


def arrow(frame: str, number: int) -> Marker:
    """The force at a frame; where it points is told with each time, see `arrow_points`."""
    points = np.zeros((2, 3))
    return Marker("world", f"force at {frame}", number, "arrow", (0.008, 0.016, 0.0), _RED, points=points)


def arrow_points(places: Array, forces: Array) -> tuple[npt.NDArray[np.bool_], Array]:
    """Start and end (k, 2, 3) in m of arrows, 5 mm per newton, and which of them (k,) can be seen.

    Args:
        places: (k, 3) m.
        forces: (k, 3) N.
    """
    points = np.stack([places, places + _ARROW * forces], axis=1)
    return np.isfinite(points).all(axis=(1, 2)) & (np.linalg.norm(forces, axis=1) >= _LEAST_FORCE), points


Triple = tuple[float, float, float]


def _parts(look: Look) -> list[tuple[MarkerKind, Triple, float, Array | None]]:
    """Kind, scale, shift along the shape's z axis in m and points of the markers that make up a shape."""
    radius, half, _ = look.size
    ball: Triple = (2.0 * radius, 2.0 * radius, 2.0 * radius)
    rod: Triple = (2.0 * radius, 2.0 * radius, 2.0 * half)
    match look.kind:
        case "sphere":
            return [("sphere", ball, 0.0, None)]
        case "cylinder":
            return [("cylinder", rod, 0.0, None)]
        case "capsule":
            ends: list[tuple[MarkerKind, Triple, float, Array | None]] = [
                ("sphere", ball, z, None) for z in (-half, half)
            ]
            return [("cylinder", rod, 0.0, None), *ends]
        case "box":
            return [("cube", (2.0 * radius, 2.0 * half, 2.0 * look.size[2]), 0.0, None)]
        case "mesh":
            return [("triangles", (1.0, 1.0, 1.0), 0.0, _corners(look))]


def _corners(look: Look) -> Array:
    """(3 f, 3) m, three corners for each triangle of a mesh; of a fine one the corners on a grid."""
    assert look.vertices is not None
    assert look.faces is not None
    vertices = np.asarray(look.vertices, dtype=float)
    corners = vertices[look.faces]
    if len(corners) > _MOST_TRIANGLES:
        cell = max(float(np.ptp(vertices, axis=0).max()) / _CELLS, 1e-9)
        cells = np.round((corners - vertices.min(axis=0)) / cell).astype(np.int64)
        a, b, c = cells[:, 0], cells[:, 1], cells[:, 2]
        whole = (a != b).any(axis=1) & (b != c).any(axis=1) & (c != a).any(axis=1)
        corners = np.unique(cells[whole], axis=0) * cell + vertices.min(axis=0)
    return corners.reshape(-1, 3)
