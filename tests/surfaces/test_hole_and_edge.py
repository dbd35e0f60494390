"""Holes and edges: distance and normal by finite differences and against samples of the surface, at random places."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import ConfigError
from pliant.spatial import Array, exp3
from pliant.surfaces import EdgeSurface, HoleSurface, SurfaceGeometry

R = exp3([0.4, -0.7, 0.3])
ORIGIN = np.array([0.5, -0.1, 0.2])
HOLES = [HoleSurface(ORIGIN, R, 0.02, 0.05, chamfer) for chamfer in (0.0, 0.004)]
EDGES = [EdgeSurface(ORIGIN, R, math.radians(a), r) for a, r in ((90.0, 0.0), (60.0, 0.01), (140.0, 0.02), (10.0, 0.0))]
_SPACING = 5e-4  # m


def samples(surface: HoleSurface | EdgeSurface) -> Array:
    """(k, 3) places of the surface in its own axes, every half millimetre, from its definition alone."""
    if isinstance(surface, EdgeSurface):
        lines = []
        bend, way = surface.rounding, np.arange(0.0, 0.1, _SPACING)
        middle = -bend * (1.0 + math.cos(surface.angle)) / math.sin(surface.angle)
        lines.append(np.column_stack([middle - way, np.zeros_like(way)]))
        turned = np.arange(0.0, math.pi - surface.angle, _SPACING / max(bend, 1.0))
        lines.append(np.column_stack([middle + bend * np.sin(turned), bend * (np.cos(turned) - 1.0)]))
        end = math.pi - surface.angle
        start = np.array([middle + bend * math.sin(end), bend * (math.cos(end) - 1.0)])
        lines.append(start - way[:, None] * np.array([math.cos(surface.angle), math.sin(surface.angle)]))
        flat = np.concatenate(lines)
        return np.column_stack([np.zeros(len(flat)), flat])
    r, d, c = surface.radius, surface.depth, surface.chamfer
    wall = np.arange(-d, -c, _SPACING)
    profile = [
        np.column_stack([np.arange(r + c, 0.1, _SPACING), np.zeros_like(np.arange(r + c, 0.1, _SPACING))]),
        np.column_stack([r + c + np.arange(-c, 0.0, _SPACING), np.arange(-c, 0.0, _SPACING)]),
        np.column_stack([np.full_like(wall, r), wall]),
        np.column_stack([np.arange(0.0, r, _SPACING), np.full_like(np.arange(0.0, r, _SPACING), -d)]),
    ]
    flat = np.concatenate(profile)
    return np.column_stack([flat[:, 0], np.zeros(len(flat)), flat[:, 1]])


def beside(surface: HoleSurface | EdgeSurface, local: Array) -> Array:
    """A local place, brought into the half plane (or the plane across the edge) of the samples."""
    if isinstance(surface, EdgeSurface):
        return np.array([0.0, local[1], local[2]])
    return np.array([np.hypot(local[0], local[1]), 0.0, local[2]])


def kinked(surface: SurfaceGeometry, point: Array) -> bool:
    """Whether two faces are about as near."""
    turned = [surface.normal(point + h) @ surface.normal(point - h) for h in 2e-6 * np.eye(3)]
    return min(turned) < 0.99


places = st.lists(st.floats(-0.07, 0.07), min_size=3, max_size=3)


@settings(max_examples=300, deadline=None)
@given(st.sampled_from([*HOLES, *EDGES]), places)
def test_the_normal_is_the_gradient_of_a_distance_that_is_the_nearest_place_away(
    surface: HoleSurface | EdgeSurface, at: list[float]
) -> None:
    local = np.array(at)
    point = ORIGIN + R @ local
    found = surface.near(point)
    assert np.linalg.norm(found.normal) == pytest.approx(1.0, abs=1e-9)
    np.testing.assert_allclose(point, found.point + found.distance * found.normal, atol=1e-12)
    assert abs(surface.near(found.point).distance) < 1e-9
    nearest = float(np.linalg.norm(samples(surface) - beside(surface, local), axis=1).min())
    assert nearest - 1.5 * _SPACING <= abs(found.distance) <= nearest + 1e-9
    if abs(found.distance) > 1e-5 and not kinked(surface, point):
        slope = [(surface.near(point + h).distance - surface.near(point - h).distance) / 2e-6 for h in 1e-6 * np.eye(3)]
        np.testing.assert_allclose(slope, found.normal, atol=2e-3)


@settings(max_examples=200, deadline=None)
@given(st.sampled_from([*HOLES, *EDGES]), places)
def test_material_is_where_the_definition_has_it(surface: HoleSurface | EdgeSurface, at: list[float]) -> None:
    x, y, z = at
    inside = surface.near(ORIGIN + R @ np.array(at)).distance < 0.0
    if isinstance(surface, HoleSurface):
        air = z > 0.0 or (z > -surface.depth and math.hypot(x, y) < surface.radius + max(0.0, surface.chamfer + z))
    elif surface.rounding == 0.0:
        air = z > 0.0 or y * math.sin(surface.angle) - z * math.cos(surface.angle) > 0.0
    else:
        return  # the sharp one says what the faces are; the rounding is seen above
    if abs(surface.near(ORIGIN + R @ np.array(at)).distance) > 1e-9:
        assert inside != air


def test_known_places() -> None:
    hole = HoleSurface(np.zeros(3), np.eye(3), 0.02, 0.05, 0.004)
    assert hole.near([0.0, 0.0, -0.045]).distance == pytest.approx(0.005)  # over the bottom
    assert hole.near([0.017, 0.0, -0.02]).distance == pytest.approx(0.003)  # by the wall
    np.testing.assert_allclose(hole.near([0.017, 0.0, -0.02]).normal, [-1.0, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(hole.near([0.0219, 0.0, -0.0019]).normal, [-np.sqrt(0.5), 0.0, np.sqrt(0.5)], atol=1e-9)
    assert hole.near([0.1, 0.0, -0.01]).distance == pytest.approx(-0.01)
    assert hole.curvatures([0.019, 0.0, -0.03]) == (pytest.approx(-50.0), 0.0)
    assert hole.curvatures(hole.top()) == (0.0, 0.0)
    edge = EdgeSurface(np.zeros(3), np.eye(3), 0.5 * math.pi, 0.01)
    assert edge.near([3.0, 0.01, 0.01]).distance == pytest.approx(0.01 * (2.0 * math.sqrt(2.0) - 1.0))
    assert edge.near([0.0, 0.02, -0.5]).distance == pytest.approx(0.02)
    assert edge.curvatures([0.0, 0.0, 0.0]) == (pytest.approx(100.0), 0.0)


def test_the_face_round_a_hole_is_its_chart() -> None:
    hole = HOLES[1]
    uv = np.array([[0.01, 0.02], [0.03, -0.01]])
    places_, normals = hole.chart(hole.top(), R[:, 0], uv)
    for place, normal in zip(places_, normals, strict=True):
        assert abs(hole.near(place).distance) < 1e-12
        np.testing.assert_allclose(hole.normal(place), normal, atol=1e-12)


def test_what_is_no_hole_and_no_edge_is_refused() -> None:
    for sizes in ((0.0, 0.1, 0.0), (0.1, 0.1, 0.1), (0.1, 0.1, -0.01), (float("nan"), 0.1, 0.0)):
        with pytest.raises(ConfigError, match="a hole needs a radius above zero and a bevel"):
            HoleSurface(np.zeros(3), np.eye(3), *sizes)
    with pytest.raises(ConfigError, match="from 10 to 170 degrees, got 5"):
        EdgeSurface(np.zeros(3), np.eye(3), math.radians(5.0))
    with pytest.raises(ConfigError, match="must not be negative"):
        EdgeSurface(np.zeros(3), np.eye(3), 1.0, -0.1)
