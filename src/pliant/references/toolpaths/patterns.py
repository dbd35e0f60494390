"""Patterns in a plane: polylines in metres, centred unless stated otherwise.

Straight pieces are given by their corners, curves by points closer than `STEP`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from pliant.errors import ConfigError
from pliant.spatial import Array

STEP = 2e-4  # m between two points of a curve


def raster(size: tuple[float, float], spacing: float) -> Array:
    """Parallel lines along u, joined at alternating ends. The lines fill `size`; `spacing` is met or less.

    Args:
        size: m along u and v.
        spacing: m, largest distance of two lines.

    Returns:
        (k, 2) corners.
    """
    _positive("size", *size)
    _positive("spacing", spacing)
    lines = max(math.ceil(size[1] / spacing - 1e-9), 1) + 1
    v = np.linspace(-0.5, 0.5, lines) * size[1]
    ends = np.array([-0.5, 0.5]) * size[0]
    return np.array([(u, row) for index, row in enumerate(v) for u in (ends if index % 2 == 0 else ends[::-1])])


def spiral(size: tuple[float, float], spacing: float) -> Array:
    """From the middle outwards, Archimedes' spiral; elliptic if the sizes differ. Args as `raster`: outer diameters."""
    _positive("size", *size)
    _positive("spacing", spacing)
    radius = 0.5 * max(size)
    turns = radius / spacing
    # r = spacing/(2π) φ; points evenly spaced along the arc, s ≈ r²·π/spacing
    count = max(math.ceil(math.pi * radius**2 / spacing / STEP), 64)
    r = radius * np.sqrt(np.linspace(0.0, 1.0, count))
    angle = 2.0 * math.pi * turns * r / radius
    return np.column_stack([r * np.cos(angle) * size[0], r * np.sin(angle) * size[1]]) / max(size)


def circle(size: tuple[float, float], turns: float) -> Array:
    """Circle from (+u, 0) towards +v, several turns; an ellipse if the sizes differ.

    Args:
        size: m, diameters along u and v.
        turns: number of turns, also a fraction.
    """
    _positive("size", *size)
    _positive("turns", turns)
    count = max(math.ceil(math.pi * max(size) * turns / STEP), 64)
    angle = np.linspace(0.0, 2.0 * math.pi * turns, count)
    return np.column_stack([0.5 * size[0] * np.cos(angle), 0.5 * size[1] * np.sin(angle)])


def lemniscate(size: tuple[float, float], turns: float) -> Array:
    """A figure-8 with its crossing in the middle, whole width along u. Args as `circle`."""
    _positive("size", *size)
    _positive("turns", turns)
    count = max(math.ceil(3.1 * max(size) * turns / STEP), 64)
    angle = np.linspace(0.0, 2.0 * math.pi * turns, count)
    return np.column_stack([0.5 * size[0] * np.sin(angle), 0.5 * size[1] * np.sin(2.0 * angle)])


def line(size: tuple[float, float]) -> Array:
    """From −u to +u and from −v to +v at once. Args: size: m along u and v, one of them may be 0."""
    if not (min(size) >= 0.0 and max(size) > 0.0):
        raise ConfigError(f"the size of a line must not be negative and not zero along both (m), got {list(size)}")
    return np.array([[-0.5, -0.5], [0.5, 0.5]]) * np.array(size)


def square(size: tuple[float, float], turns: float) -> Array:
    """Along the edges of a rectangle, from its corner (−u, −v) towards +u. Args as `circle`; turns: whole ones."""
    _positive("size", *size)
    if turns < 1.0 or turns != round(turns):
        raise ConfigError(f"a square is drawn a whole number of turns, got {turns:g}")
    corners = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) * np.array(size)
    return np.vstack([np.tile(corners, (round(turns), 1)), corners[:1]])


PATTERNS: Mapping[str, Callable[[tuple[float, float], float, float], Array]] = {
    "raster": lambda size, spacing, turns: raster(size, spacing),
    "spiral": lambda size, spacing, turns: spiral(size, spacing),
    "circle": lambda size, spacing, turns: circle(size, turns),
    "lemniscate": lambda size, spacing, turns: lemniscate(size, turns),
    "line": lambda size, spacing, turns: line(size),
    "square": lambda size, spacing, turns: square(size, turns),
}
"""name → pattern of (size in m, spacing in m, turns)"""


def _positive(name: str, *values: float) -> None:
    if not all(math.isfinite(value) and value > 0.0 for value in values):
        raise ConfigError(f"the {name} of a pattern must be above zero, got {list(values)}")
