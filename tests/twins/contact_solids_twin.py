"""Solids in closed form and the points of a tool, written to be read."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

Vector = np.ndarray
Found = tuple[float, Vector]
"""signed distance, and the outward normal"""


def on_segments(p: Vector, corners: Sequence[tuple[float, float]]) -> tuple[float, Vector]:
    """Distance from a line of segments in the plane, and the nearest place."""
    best = (np.inf, p)
    for a, b in zip(np.array(corners)[:-1], np.array(corners)[1:], strict=True):
        if np.allclose(a, b, atol=0.0):
            continue
        t = np.clip((p - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        place = a + t * (b - a)
        best = min(best, (float(np.linalg.norm(p - place)), place), key=lambda found: found[0])
    return best


def hole(point: Vector, radius: float, depth: float, chamfer: float) -> Found:
    """A block with a round hole along −z of its face z = 0, seen in the half plane through the point."""
    rho, z = float(np.hypot(point[0], point[1])), float(point[2])
    far = 2.0
    profile = [(far, 0.0), (radius + chamfer, 0.0), (radius, -chamfer), (radius, -depth), (0.0, -depth)]
    distance, place = on_segments(np.array([rho, z]), profile)
    wide = radius + max(0.0, chamfer + z)
    outside = z > 0.0 or (rho < wide and z > -depth)
    sign = 1.0 if outside else -1.0
    flat = sign * (np.array([rho, z]) - place) / distance
    return sign * distance, np.array([flat[0] * point[0] / rho, flat[0] * point[1] / rho, flat[1]])


def edge(point: Vector, angle: float, rounding: float) -> Found:
    """A wedge as the rounding of a smaller, sharp one."""
    first, second = np.array([0.0, 1.0]), np.array([np.sin(angle), -np.cos(angle)])
    tip = np.linalg.solve(np.array([first, second]), [-rounding, -rounding])
    p = point[1:] - tip
    ends = [tip + 2.0 * np.array([-1.0, 0.0]), tip, tip + 1e3 * np.array([-np.cos(angle), -np.sin(angle)])]
    distance, place = on_segments(point[1:], [tuple(end) for end in ends])
    sign = -1.0 if first @ p < 0.0 and second @ p < 0.0 else 1.0
    flat = sign * (point[1:] - place) / distance
    return sign * distance - rounding, np.array([0.0, *flat])


def box(point: Vector, half: Vector) -> Found:
    over = np.abs(point) - half
    side = np.where(point < 0.0, -1.0, 1.0)
    if over.max() <= 0.0:
        axis = int(np.argmax(over))
        return float(over[axis]), side[axis] * np.eye(3)[axis]
    out = side * np.maximum(over, 0.0)
    size = float(np.linalg.norm(out))
    return size, out / size


def cylinder(point: Vector, radius: float, half: float) -> Found:
    """A box in the half plane (rho, z)."""
    rho = float(np.hypot(point[0], point[1]))
    distance, flat = box(np.array([rho, 0.0, point[2]]), np.array([radius, 1e3, half]))
    return distance, np.array([flat[0] * point[0] / rho, flat[0] * point[1] / rho, flat[2]])


def rim(radius: float, z: float, count: int) -> list[Vector]:
    turned = 2.0 * np.pi * np.arange(count) / count
    return [np.array([radius * np.cos(a), radius * np.sin(a), z]) for a in turned]


def corners(half: Vector) -> list[Vector]:
    return [half * np.array([i, j, k]) for k in (-1.0, 1.0) for j in (-1.0, 1.0) for i in (-1.0, 1.0)]
