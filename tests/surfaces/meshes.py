"""Meshes that tests make."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh

BALL = 0.2  # m


def cap(step: float = 3e-3, reach: float = 0.09) -> trimesh.Trimesh:
    """The top of a ball of 0.2 m about the origin as an open shell of triangles `step` m long."""
    x = np.linspace(-reach, reach, round(2.0 * reach / step) + 1)
    X, Y = np.meshgrid(x, x, indexing="ij")
    vertices = np.stack([X, Y, np.sqrt(BALL**2 - X**2 - Y**2)], axis=-1).reshape(-1, 3)
    corner = np.arange(X.size).reshape(X.shape)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    return trimesh.Trimesh(vertices, faces, process=False)


def box() -> trimesh.Trimesh:
    """A closed block of 0.2 × 0.1 × 0.06 m."""
    return trimesh.creation.box((0.2, 0.1, 0.06))


def written(mesh: trimesh.Trimesh, file: Path) -> Path:
    """The mesh as a file, whose ending says of which kind."""
    mesh.export(file)
    return file
