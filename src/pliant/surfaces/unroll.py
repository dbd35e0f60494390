"""A path on a curved surface, unrolled into a plane."""

from __future__ import annotations

import numpy as np

from pliant.spatial import Array

_FIRST = 0.02  # of the way, which tells its first direction


def unrolled(places: Array, normals: Array) -> Array:
    """(k, 2) m: the path unrolled into a plane.

    Lengths along the way are kept, and so is how it bends within the surface. On a plane and a cylinder places
    keep their distances too; on other surfaces, places where two parts of a way meet lie apart by what the surface
    between them is curved both ways. The first axis is the way's first direction.

    Args:
        places: (k, 3) m, close together.
        normals: (k, 3) unit, of the surface there.
    """
    found = np.zeros((len(places), 2))
    if len(places) < 2:
        return found
    n = normals[0]
    done = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
    first = places[int(np.searchsorted(done, _FIRST * done[-1]))] - places[0]
    ways = [first, *np.eye(3)]
    u = next(way for way in (way - n * float(n @ way) for way in ways) if np.linalg.norm(way) > 1e-9)
    u = u / np.linalg.norm(u)
    for k in range(1, len(places)):
        middle = normals[k - 1] + normals[k]
        middle = middle / np.linalg.norm(middle)
        u = _turned(u, normals[k - 1], middle)
        step = places[k] - places[k - 1]
        flat = step - middle * float(middle @ step)
        length, size = float(np.linalg.norm(step)), float(np.linalg.norm(flat))
        if size > 0.0:
            found[k] = length / size * np.array([u @ flat, np.cross(middle, u) @ flat])
        u = _turned(u, middle, normals[k])
    return np.cumsum(found, axis=0)


def _turned(u: Array, n: Array, to: Array) -> Array:
    """A unit tangent after its normal was turned the shortest way into another one."""
    flat = u - (n + to) * float(to @ u) / (1.0 + float(n @ to))
    return flat / np.linalg.norm(flat)
