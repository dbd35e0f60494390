"""The compiled triangles and samples against twins that are written to be read."""

from __future__ import annotations

import itertools

import numpy as np
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant._contact import SampledMesh, TriangleMesh
from tests.surfaces.meshes import cap

Vector = np.ndarray


def nearest_of_triangle(p: Vector, corners: Vector) -> Vector:
    """By the least of its inside, its edges and its corners."""
    a, b, c = corners
    E = np.stack([b - a, c - a], axis=1)
    u, v = np.linalg.lstsq(E, p - a, rcond=None)[0]
    if u >= 0 and v >= 0 and u + v <= 1:
        return a + E @ [u, v]
    found = []
    for start, end in ((a, b), (b, c), (c, a)):
        way = end - start
        found.append(start + np.clip((p - start) @ way / (way @ way), 0.0, 1.0) * way)
    return min(found, key=lambda place: float(np.linalg.norm(p - place)))


def nearest_of_mesh(p: Vector, vertices: Vector, faces: Vector) -> Vector:
    places = [nearest_of_triangle(p, vertices[face]) for face in faces]
    return min(places, key=lambda place: float(np.linalg.norm(p - place)))


def cubic(t: float) -> tuple[Vector, Vector]:
    """Weights of four samples at −1, 0, 1, 2 and their derivatives: Hermite with central differences as slopes."""
    hermite = np.array([2 * t**3 - 3 * t**2 + 1, t**3 - 2 * t**2 + t, -2 * t**3 + 3 * t**2, t**3 - t**2])
    slope = np.array([6 * t**2 - 6 * t, 3 * t**2 - 4 * t + 1, -6 * t**2 + 6 * t, 3 * t**2 - 2 * t])
    of_samples = np.array([[0, 1, 0, 0], [-0.5, 0, 0.5, 0], [0, 0, 1, 0], [0, -0.5, 0, 0.5]])
    return hermite @ of_samples, slope @ of_samples


def sampled_at(p: Vector, low: Vector, step: float, values: Vector) -> tuple[float, Vector]:
    """Distance and gradient."""
    place = (p - low) / step
    cell = np.floor(place).astype(int)
    found, gradient = 0.0, np.zeros(3)
    (x, dx), (y, dy), (z, dz) = (cubic(t) for t in (place - cell).tolist())
    for i, j, k in itertools.product(range(4), repeat=3):
        value = values[cell[0] + i - 1, cell[1] + j - 1, cell[2] + k - 1]
        found += x[i] * y[j] * z[k] * value
        gradient += value / step * np.array([dx[i] * y[j] * z[k], x[i] * dy[j] * z[k], x[i] * y[j] * dz[k]])
    return found, gradient


@settings(max_examples=15)
@given(seed=st.integers(0, 2**31))
def test_the_nearest_place_and_the_side(seed: int) -> None:
    """Random stars: closed, with ridges and valleys. The side is where a ray that leaves it is cut an odd number of
    times, by angles seen from the point."""
    rng = np.random.default_rng(seed)
    star = trimesh.creation.icosphere(subdivisions=1)
    vertices = np.asarray(star.vertices) * rng.uniform(0.3, 1.0, (len(star.vertices), 1))
    faces = np.asarray(star.faces, dtype=np.int32)
    points = rng.uniform(-1.0, 1.0, (12, 3))
    distance, places, normals = TriangleMesh(vertices, faces).nearest(points)
    for point, d, place, normal in zip(points, distance, places, normals, strict=True):
        wanted = nearest_of_mesh(point, vertices, faces)
        np.testing.assert_allclose(np.linalg.norm(point - place), np.linalg.norm(point - wanted), atol=1e-12)
        a, b, c = (vertices[faces[:, i]] - point for i in range(3))
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        triple = np.einsum("ij,ij->i", a, np.cross(b, c))
        under = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
        winding = 2.0 * np.arctan2(triple, under).sum() / (4.0 * np.pi)
        assert (d < 0.0) == (winding > 0.5)
        assert abs(abs(d) - np.linalg.norm(point - wanted)) < 1e-12
        assert abs(np.linalg.norm(normal) - 1.0) < 1e-12


@given(seed=st.integers(0, 2**31))
def test_samples_are_joined_by_cubics(seed: int) -> None:
    rng = np.random.default_rng(seed)
    step, low = float(rng.uniform(0.005, 0.02)), rng.uniform(-0.1, 0.1, 3)
    axes = np.stack(np.meshgrid(*[np.arange(8)] * 3, indexing="ij"), axis=-1)
    tilted = rng.standard_normal(3)
    values: Vector = (low + step * axes) @ (tilted / np.linalg.norm(tilted)) + 0.1 * step * rng.standard_normal(
        (8, 8, 8)
    )
    shell = cap(0.03)
    mesh = TriangleMesh(np.array(shell.vertices), np.array(shell.faces, dtype=np.int32))
    point = low + step * rng.uniform(2.5, 4.5, 3)
    values -= sampled_at(point, low, step, values)[0] - step  # the surface is one step away
    sampled = SampledMesh(mesh, low, step, values, 10.0)
    wanted, _ = sampled_at(point, low, step, values)
    distance, place, normal = (found[0] for found in sampled.nearest(point[None]))
    assert abs(distance - wanted) < 1e-14
    p = point
    for _ in range(4):
        value, gradient = sampled_at(p, low, step, values)
        p = p - value * gradient / np.linalg.norm(gradient)
        if not np.all(((p - low) / step > 1.1) & ((p - low) / step < 5.9)):
            return  # the way leads out of the samples
    _, gradient = sampled_at(p, low, step, values)
    np.testing.assert_allclose(place, p, atol=1e-12)
    np.testing.assert_allclose(normal, gradient / np.linalg.norm(gradient), atol=1e-9)
