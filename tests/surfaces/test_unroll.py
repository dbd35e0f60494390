"""Laying a way flat: distances on surfaces that can be unrolled, lengths on those that cannot."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.spatial import exp3
from pliant.surfaces import CylinderSurface, PlaneSurface, SphereSurface, SurfaceGeometry
from pliant.surfaces.unroll import unrolled

R, ORIGIN = exp3([0.4, -0.7, 0.3]), np.array([0.5, -0.1, 0.2])


def distances(points: np.ndarray) -> np.ndarray:
    return np.linalg.norm(points[:, None] - points[None], axis=2)


def wave(surface: SurfaceGeometry) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A way in the chart (k, 2), and its places and normals."""
    s = np.linspace(0.0, 1.0, 400)
    uv = np.stack([0.12 * s, 0.03 * np.sin(9.0 * s)], axis=1)
    start = surface.near(surface.top()).point
    places, normals = surface.chart(start, surface.tangent(start, surface.first_axis(surface.normal(start))), uv)
    return uv, places, normals


@pytest.mark.parametrize("surface", [PlaneSurface(ORIGIN, R), CylinderSurface(ORIGIN, R, 0.1)])
def test_what_can_be_unrolled_keeps_its_distances(surface: SurfaceGeometry) -> None:
    uv, places, normals = wave(surface)
    np.testing.assert_allclose(distances(unrolled(places, normals)), distances(uv), atol=1e-5)


def test_a_sphere_keeps_lengths_and_a_great_circle_is_straight() -> None:
    surface = SphereSurface(ORIGIN, R, 0.2)
    uv, places, normals = wave(surface)
    flat = unrolled(places, normals)
    way = np.linalg.norm(np.diff(places, axis=0), axis=1).sum()
    assert np.linalg.norm(np.diff(flat, axis=0), axis=1).sum() == pytest.approx(way, rel=1e-9)
    assert np.abs(distances(flat) - distances(uv)).max() > 1e-4  # baseline: it cannot be unrolled
    start = surface.top()
    line = np.stack([np.linspace(0.0, 0.2, 200), np.zeros(200)], axis=1)
    places, normals = surface.chart(start, surface.tangent(start, R[:, 0]), line)
    assert np.abs(unrolled(places, normals)[:, 1]).max() < 1e-12


def test_few_places() -> None:
    assert unrolled(np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]])).tolist() == [[0.0, 0.0]]
    up = np.tile([0.0, 0.0, 1.0], (3, 1))
    there_and_back = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert distances(unrolled(there_and_back, up))[0] == pytest.approx([0.0, 0.1, 0.0])
