"""Visual meshes of a plate with a hole, and of an edge."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from pliant.spatial import Array
from pliant.surfaces import EdgeSurface, HoleSurface

Integers = npt.NDArray[np.int32]
_ROUND = 48  # corners of a circle
_BEND = 8  # of a rounded edge


def hole_triangles(hole: HoleSurface, half: float) -> tuple[Array, Integers]:
    """Corners (nv, 3) m in the hole's axes and triangles (nt, 3), anticlockwise from outside.

    Args:
        hole: to be shown.
        half: m, half an edge of the square face round it; at least 1.5 times the radius of the mouth.
    """
    mouth = hole.radius + hole.chamfer
    angles = 2.0 * np.pi * np.arange(_ROUND) / _ROUND
    round_ = np.column_stack([np.cos(angles), np.sin(angles)])
    square = max(half, 1.5 * mouth) * round_ / np.abs(round_).max(axis=1, keepdims=True)
    rings = [(square, 0.0), (mouth * round_, 0.0)]
    if hole.chamfer > 0.0:
        rings.append((hole.radius * round_, -hole.chamfer))
    rings += [(hole.radius * round_, -hole.depth), (1e-4 * hole.radius * round_, -hole.depth)]
    return _strips([np.column_stack([xy, np.full(_ROUND, z)]) for xy, z in rings], closed=True)


def edge_triangles(edge: EdgeSurface, half: float) -> tuple[Array, Integers]:
    """The same of an edge. Args: half: m, half its length, and as far as its faces go."""
    bend = edge.rounding * (math.pi - edge.angle)
    ways = [-half, *np.linspace(0.0, bend, _BEND if bend > 0.0 else 1).tolist(), bend + half]
    local = EdgeSurface(np.zeros(3), np.eye(3), edge.angle, edge.rounding)
    start = local.top()
    flat = np.column_stack([np.zeros(len(ways)), np.array(ways) - local.across(start)])
    places, _ = local.chart(start, np.array([1.0, 0.0, 0.0]), flat)
    lines = [place + np.array([[half, 0.0, 0.0], [-half, 0.0, 0.0]]) for place in places]
    return _strips(lines, closed=False)


def _strips(lines: list[Array], closed: bool) -> tuple[Array, Integers]:
    """Strips of triangles between lines of as many corners each."""
    count = len(lines[0])
    found: list[tuple[int, int, int]] = []
    for strip in range(len(lines) - 1):
        for i in range(count if closed else count - 1):
            a, b = strip * count + i, strip * count + (i + 1) % count
            found += [(a, b, a + count), (b, b + count, a + count)]
    return np.concatenate(lines), np.array(found, dtype=np.int32)
