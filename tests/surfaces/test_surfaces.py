"""Surfaces: distance, normal and chart against each other, by finite differences and known places."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import ConfigError, ShapeError
from pliant.spatial import exp3
from pliant.surfaces import CylinderSurface, EdgeSurface, PlaneSurface, SphereSurface, SurfaceGeometry

R = exp3([0.4, -0.7, 0.3])
ORIGIN = np.array([0.5, -0.1, 0.2])
SURFACES: list[SurfaceGeometry] = [
    PlaneSurface(ORIGIN, R),
    CylinderSurface(ORIGIN, R, 0.15),
    CylinderSurface(ORIGIN, R, 0.15, hollow=True),
    SphereSurface(ORIGIN, R, 0.2),
    SphereSurface(ORIGIN, R, 0.2, hollow=True),
    EdgeSurface(ORIGIN, R, 1.4, 0.03),
    EdgeSurface(ORIGIN, R, 2.5, 0.05),
]
EACH = pytest.mark.parametrize("surface", SURFACES, ids=lambda s: f"{type(s).__name__}{getattr(s, 'hollow', '')}")


@EACH
def test_the_normal_is_the_gradient_of_the_distance(surface: SurfaceGeometry) -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        point = surface.top() + rng.normal(0.0, 0.03, 3)
        found = surface.near(point)
        slope = [(surface.near(point + h).distance - surface.near(point - h).distance) / 2e-6 for h in 1e-6 * np.eye(3)]
        np.testing.assert_allclose(slope, found.normal, atol=1e-8)
        np.testing.assert_allclose(point, found.point + found.distance * found.normal, atol=1e-12)
        assert abs(surface.near(found.point).distance) < 1e-12


@EACH
def test_the_chart_lies_on_the_surface_and_measures_lengths_from_its_origin(surface: SurfaceGeometry) -> None:
    start = surface.near(surface.top() + np.array([0.02, 0.01, 0.0])).point
    along = surface.tangent(start, [0.3, 1.0, 0.1])
    rng = np.random.default_rng(1)
    uv = rng.uniform(-0.05, 0.05, (20, 2))
    places, normals = surface.chart(start, along, uv)
    for place, normal in zip(places, normals, strict=True):
        assert abs(surface.near(place).distance) < 1e-12
        np.testing.assert_allclose(surface.normal(place), normal, atol=1e-12)
    # the line to each place, in small pieces, is as long as (u, v) is
    for entry in uv[:5]:
        line, _ = surface.chart(start, along, np.linspace(0.0, 1.0, 2001)[:, None] * entry)
        assert np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx(np.linalg.norm(entry), rel=1e-6)
    step = surface.chart(start, along, np.array([[1e-6, 0.0], [0.0, 1e-6]]))[0] - start
    np.testing.assert_allclose(step[0] / 1e-6, along, atol=1e-5)
    np.testing.assert_allclose(step[1] / 1e-6, np.cross(surface.normal(start), along), atol=1e-5)


@EACH
def test_the_normal_turns_by_the_curvature(surface: SurfaceGeometry) -> None:
    """Over a small step the normal turns by at most the larger principal curvature, and somewhere by it."""
    start = surface.top()
    turns = []
    for angle in np.linspace(0.0, np.pi, 61):
        first = surface.tangent(start, surface.rotation @ [1.0, 0.3, 0.2])
        direction = np.cos(angle) * first + np.sin(angle) * np.cross(surface.normal(start), first)
        after = surface.normal(start + 1e-5 * direction)
        turns.append(float(direction @ (after - surface.normal(start))) / 1e-5)
    larger, smaller = surface.curvatures(start)
    assert sorted([max(turns, key=abs), min(turns, key=abs)], key=abs) == pytest.approx(
        [smaller, larger], abs=2e-2 * max(1.0, abs(larger))
    )


def test_known_places() -> None:
    pipe = CylinderSurface(np.zeros(3), np.eye(3), 0.1, hollow=True)
    assert pipe.near([0.04, 0.0, 3.0]).distance == pytest.approx(0.06)  # free inside
    np.testing.assert_allclose(pipe.near([0.04, 0.0, 3.0]).normal, [-1.0, 0.0, 0.0])
    ball = SphereSurface(np.zeros(3), np.eye(3), 0.2)
    assert ball.near([0.0, 0.0, 0.15]).distance == pytest.approx(-0.05)
    np.testing.assert_allclose(ball.top(), [0.0, 0.0, 0.2])
    quarter, normal = ball.chart(ball.top(), np.array([1.0, 0.0, 0.0]), np.array([[0.2 * np.pi / 2, 0.0]]))
    np.testing.assert_allclose(quarter[0], [0.2, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(normal[0], [1.0, 0.0, 0.0], atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from(SURFACES),
    st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3),
    st.lists(st.floats(-0.3, 0.3), min_size=3, max_size=3),
    st.lists(st.floats(-0.2, 0.2), min_size=3, max_size=3),
)
def test_moving_a_surface_moves_its_distances(
    surface: SurfaceGeometry, turn: list[float], shift: list[float], at: list[float]
) -> None:
    pivot = surface.top()
    point = pivot + np.array(at)
    turned = exp3(turn)
    moved = surface.moved(shift, turn, pivot)
    after = pivot + turned @ (point - pivot) + shift
    assert moved.near(after).distance == pytest.approx(surface.near(point).distance, abs=1e-12)


def test_what_is_not_a_surface_is_refused() -> None:
    with pytest.raises(ConfigError, match="rotation matrix"):
        PlaneSurface(np.zeros(3), 2.0 * np.eye(3))
    with pytest.raises(ShapeError, match="3 entries"):
        PlaneSurface(np.zeros(2), np.eye(3))
    with pytest.raises(ConfigError, match="radius of a cylinder must be above zero"):
        CylinderSurface(np.zeros(3), np.eye(3), -0.1)
    with pytest.raises(ConfigError, match="radius of a sphere must be above zero"):
        SphereSurface(np.zeros(3), np.eye(3), float("nan"))
    with pytest.raises(ConfigError, match="is normal to the surface"):
        PlaneSurface(np.zeros(3), np.eye(3)).tangent([0.0, 0.0, 0.0], [0.0, 0.0, 1.0])
