"""Rounds the corners of a polyline by arcs."""

from __future__ import annotations

import math

import numpy as np

from pliant.spatial import Array

_STRAIGHT = 1e-3  # rad; less is no corner
_REVERSAL = math.pi - 0.05  # rad; a larger angle is a reversal, which is not rounded


def rounded(points: Array, radius: float, step: float) -> Array:
    """The same path with each corner replaced by an arc that is tangent to both sides.

    An arc takes at most half of the shorter side, so neighbours do not overlap; at a reversal there is none.

    Args:
        points: (k, d) m, d = 2 or 3.
        radius: m, of the arcs; less where the sides are short.
        step: m between two points that are returned, at most.

    Returns:
        (m, d): the whole path in small steps, with the first and last point kept.
    """
    points = _without_repeats(points)
    if len(points) < 2:
        return points
    sides = np.diff(points, axis=0)
    lengths = np.linalg.norm(sides, axis=1)
    ways = sides / lengths[:, None]
    pieces = [points[:1]]
    for i in range(1, len(points) - 1):
        before, after = ways[i - 1], ways[i]
        angle = math.acos(float(np.clip(before @ after, -1.0, 1.0)))
        if angle < _STRAIGHT or angle > _REVERSAL:
            pieces.append(points[i : i + 1])
            continue
        cut = min(radius * math.tan(0.5 * angle), 0.5 * lengths[i - 1], 0.5 * lengths[i])
        arc_radius = cut / math.tan(0.5 * angle)
        pieces.append(_arc(points[i], before, after, cut, arc_radius, angle, step))
    pieces.append(points[-1:])
    return subdivided(np.vstack(pieces), step)


def subdivided(points: Array, step: float) -> Array:
    """Straight pieces cut into equal parts no longer than `step`."""
    points = _without_repeats(points)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    counts = np.maximum(np.ceil(lengths / step - 1e-9), 1).astype(int)
    piece = np.repeat(np.arange(len(counts)), counts)
    nth = np.arange(len(piece)) - np.repeat(np.cumsum(counts) - counts, counts) + 1
    share = np.where(nth == counts[piece], 1.0, nth * (1.0 / counts[piece]))[:, None]
    return np.vstack([points[:1], points[piece] + share * (points[piece + 1] - points[piece])])


def _arc(corner: Array, before: Array, after: Array, cut: float, radius: float, angle: float, step: float) -> Array:
    """Points of the arc that leaves `before` at `cut` in front of the corner and joins `after` as far behind it."""
    inward = after - before * float(before @ after)
    inward = inward / np.linalg.norm(inward)
    start = corner - cut * before
    count = max(math.ceil(radius * angle / step), math.ceil(angle / 0.05), 2)
    turned = np.linspace(0.0, angle, count + 1)[:, None]
    return start + radius * (np.sin(turned) * before + (1.0 - np.cos(turned)) * inward)


def _without_repeats(points: Array) -> Array:
    moved = np.concatenate([[True], np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-9])
    return points[moved]
