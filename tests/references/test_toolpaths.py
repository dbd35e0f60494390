"""Paths on surfaces: they lie on them, keep their speed and their limits, and turn without a flip."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pliant.errors import ConfigError, OutputError, PliantError
from pliant.references.toolpaths.corners import rounded
from pliant.references.toolpaths.files import read_path
from pliant.references.toolpaths.pace import pace
from pliant.references.toolpaths.patterns import PATTERNS, STEP, circle, lemniscate, line, raster, spiral, square
from pliant.references.toolpaths.toolpath import PathMotion, Toolpath, on_chart, through
from pliant.spatial import exp3, log3
from pliant.surfaces import CylinderSurface, PlaneSurface, SphereSurface, SurfaceGeometry

X = np.array([1.0, 0.0, 0.0])
SURFACES: list[SurfaceGeometry] = [
    PlaneSurface(np.array([0.5, 0.0, 0.1]), exp3([0.3, -0.4, 0.2])),
    CylinderSurface(np.array([0.5, 0.0, 0.1]), exp3([0.0, 0.5 * math.pi, 0.0]), 0.15),
    SphereSurface(np.array([0.5, 0.0, 0.0]), np.eye(3), 0.2),
    CylinderSurface(np.array([0.5, 0.0, 0.5]), exp3([0.5 * math.pi, 0.0, 0.0]), 0.3, hollow=True),
]


def laid(surface: SurfaceGeometry, uv: np.ndarray, motion: PathMotion | None = None) -> Toolpath:
    return on_chart(surface, surface.top(), X, uv, motion or PathMotion(), X)


def test_a_raster_fills_its_size_with_no_larger_spacing() -> None:
    corners = raster((0.12, 0.08), 0.03)  # 2.67 spacings: three, of 26.7 mm
    assert len(corners) == 8
    np.testing.assert_allclose(corners.min(axis=0), [-0.06, -0.04])
    np.testing.assert_allclose(corners.max(axis=0), [0.06, 0.04])
    np.testing.assert_allclose(np.diff(corners[::2, 1]), 0.08 / 3)
    np.testing.assert_allclose(corners[:4, 0], [-0.06, 0.06, 0.06, -0.06])


def test_the_turns_of_a_spiral_are_one_spacing_apart() -> None:
    points = spiral((0.1, 0.1), 0.01)
    radius, angle = np.hypot(*points.T), np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
    assert radius[-1] == pytest.approx(0.05)
    np.testing.assert_allclose(np.interp(angle[-1] - 2 * np.pi, angle, radius), 0.04, atol=2e-5)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert steps[20:].max() < 3e-4


def test_rounded_corners_are_tangent_arcs_of_the_asked_radius() -> None:
    way = rounded(np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 0.1]]), 0.02, 2e-4)
    np.testing.assert_allclose(way[[0, -1]], [[0.0, 0.0], [0.1, 0.1]])
    on_arc = way[(way[:, 0] > 0.0801) & (way[:, 1] < 0.0199)]
    np.testing.assert_allclose(np.linalg.norm(on_arc - [0.08, 0.02], axis=1), 0.02, atol=1e-6)
    turn = np.diff(np.unwrap(np.arctan2(*np.diff(way, axis=0).T[::-1])))
    assert np.abs(turn).max() < 0.06
    assert turn.sum() == pytest.approx(0.5 * np.pi)
    narrow = rounded(np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 0.01], [0.0, 0.01]]), 0.02, 2e-4)  # a U-turn: half circle
    assert narrow[:, 0].max() == pytest.approx(0.1, abs=1e-6)
    back = rounded(np.array([[0.0, 0.0], [0.1, 0.0], [0.0, 0.0]]), 0.02, 1e-3)  # turning back stays as it is
    assert back[:, 0].max() == pytest.approx(0.1)


def test_pace_of_a_straight_line_is_a_trapezoid() -> None:
    points = np.column_stack([np.linspace(0.0, 0.1, 2001), np.zeros((2001, 2))])
    times = pace(points, 0.05, 0.5).times
    assert times[-1] == pytest.approx(0.1 / 0.05 + 0.05 / 0.5, rel=1e-3)  # distance at speed, plus one ramp's time
    speed = np.diff(points[:, 0]) / np.diff(times)
    assert speed[1000] == pytest.approx(0.05)
    assert speed[20] == pytest.approx(math.sqrt(2.0 * 0.5 * 20.5 * 5e-5), rel=1e-3)  # v² = 2 a s


def test_pace_stops_where_the_way_turns_back() -> None:
    x = np.concatenate([np.linspace(0.0, 0.1, 501), np.linspace(0.1, 0.0, 501)[1:]])
    points = np.column_stack([x, np.zeros((1001, 2))])
    times = pace(points, 0.05, 0.5).times
    speed = np.linalg.norm(np.diff(points, axis=0), axis=1) / np.diff(times)
    assert speed[500] < 0.02
    assert speed[250] == pytest.approx(0.05)


@st.composite
def surfaces(draw: st.DrawFn) -> SurfaceGeometry:
    """Any plane, or a cylinder or sphere whose solid is convex or hollow, anywhere, turned in any way."""
    place = np.array(draw(st.tuples(*[st.floats(-1.0, 1.0)] * 3)))
    turned = exp3(draw(st.tuples(*[st.floats(-1.8, 1.8)] * 3)))
    kind, radius, hollow = draw(st.integers(0, 2)), draw(st.floats(0.15, 0.5)), draw(st.booleans())
    if kind == 0:
        return PlaneSurface(place, turned)
    return (CylinderSurface if kind == 1 else SphereSurface)(place, turned, radius, hollow)


@settings(max_examples=15, deadline=None)
@given(
    surfaces(),
    st.sampled_from(sorted(PATTERNS)),
    st.floats(0.03, 0.12),
    st.floats(0.02, 0.15),
    st.floats(-0.3, 0.3),
)
def test_any_pattern_on_any_surface(
    surface: SurfaceGeometry, pattern: str, size: float, speed: float, tilt: float
) -> None:
    """On the surface, at its speed within 2 % away from starts, stops and bends, continuous in pose and normal."""
    motion = PathMotion(speed=speed, acceleration=0.5, tilt=tilt, lift=0.015)
    try:
        path = laid(surface, PATTERNS[pattern]((size, 0.7 * size), 0.25 * size, 1.0), motion)
    except ConfigError as error:
        assume("is normal to the surface" not in str(error))  # X across the surface is refused as the first axis
        raise
    h = 2e-3
    rng = np.random.default_rng(0)
    for end, into in ((0.0, 1.0), (path.duration, -1.0)):  # from rest to rest, in no hurry
        assert np.linalg.norm(path.position.at(end).rate) < 1e-9
        assert np.linalg.norm(path.rotation.at(end).velocity) < 1e-9
        assert np.linalg.norm(path.position.at(end + 5e-3 * into).rate) < 5e-3 * 0.5 * 1.3
    for time in rng.uniform(0.0, path.duration - h, 100):
        now, after = path.position.at(time), path.position.at(time + h)
        here, there = surface.near(now.value), surface.near(after.value)
        assert here.distance == pytest.approx(0.015, abs=3e-5)
        assert np.linalg.norm(there.point - here.point) / h < 1.02 * speed
        change = np.linalg.norm(after.rate - now.rate)
        assert change < h * 0.5 * 2.5 * (
            1.0 + 0.015 / 0.15
        )  # m/s²: the path's limit, √2 of it in bends, the lift's share
        R, turned = path.rotation.at(time).rotation, path.rotation.at(time + h).rotation
        turn = np.linalg.norm(log3(turned @ R.T))
        assert turn < 3.0 * h * (speed / 0.15 + 2.0 * abs(tilt) * speed / 0.01 + 0.05)
        assert float(-R[:, 2] @ here.normal) > math.cos(abs(tilt) + 5e-3)
        np.testing.assert_allclose(path.task.at(time).rotation[:, 2], here.normal, atol=2e-3)
    if pattern == "line" and path.length > 1.5 * speed**2 / 0.5:
        fastest = np.linalg.norm(path.position.at(0.5 * path.duration).rate)
        assert fastest > 0.98 * speed * (1.0 - 0.015 / 0.15)


def test_the_tool_leans_in_the_direction_of_travel() -> None:
    plane = PlaneSurface(np.zeros(3), np.eye(3))
    path = laid(plane, line((0.1, 0.0)), PathMotion(tilt=math.radians(10.0)))
    z = path.rotation.at(0.5 * path.duration).rotation[:, 2]
    np.testing.assert_allclose(z, [-math.sin(math.radians(10.0)), 0.0, -math.cos(math.radians(10.0))], atol=1e-3)
    left = laid(plane, line((0.1, 0.0)), PathMotion(lean=math.radians(10.0))).rotation.at(1.0).rotation[:, 2]
    assert left[1] == pytest.approx(-math.sin(math.radians(10.0)), abs=1e-3)  # handle to +y, the left of +x


def test_a_square_may_only_be_drawn_whole() -> None:
    with pytest.raises(ConfigError, match=r"whole number of turns, got 1.5"):
        square((0.1, 0.1), 1.5)
    with pytest.raises(ConfigError, match=r"size of a pattern must be above zero, got \[0.1, -1.0\]"):
        raster((0.1, -1.0), 0.01)
    with pytest.raises(ConfigError, match="all its points are the same"):
        laid(SURFACES[0], np.zeros((4, 2)))


def test_a_csv_path_is_read_in_any_order_with_units(tmp_path: Path) -> None:
    file = tmp_path / "path.csv"
    file.write_text("note,y [mm],x_mm,time,force\na,0,0,0,5\nb,10,100,2,20\n\nc,20,200,4,25\n")
    found = read_path(file)
    np.testing.assert_allclose(found.points, [[0.0, 0.0, 0.0], [0.1, 0.01, 0.0], [0.2, 0.02, 0.0]])
    assert found.flat
    assert found.lines == (2, 3, 5)
    np.testing.assert_allclose(found.force, [5.0, 20.0, 25.0])
    plain = tmp_path / "plain.csv"
    plain.write_text("﻿x,y,z\n0,0,1\n50,0,1\n")
    np.testing.assert_allclose(read_path(plain, "mm").points[1], [0.05, 0.0, 1e-3])


def test_apt_gives_points_and_feed_rates(tmp_path: Path) -> None:
    file = tmp_path / "part.apt"
    file.write_text(
        "PARTNO X\nUNITS/MM\nFEDRAT/1200.0,MMPM\nGOTO/0,0,5\nGOTO / 10,0,5,0,0,1 $$ note\nFEDRAT/600\nGOTO/10,10,5\n"
    )
    found = read_path(file)
    np.testing.assert_allclose(found.points, [[0, 0, 5e-3], [0.01, 0, 5e-3], [0.01, 0.01, 5e-3]])
    np.testing.assert_allclose(found.speed, [0.02, 0.02, 0.01])


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.csv", "", "is empty; its first line names the columns"),
        ("a.csv", "x,z\n0,0\n", r"line 1: no column y"),
        ("a.csv", "x,y\n0,0\n1,one\n", r"line 3: column 'y' must be a finite number, got 'one'"),
        ("a.csv", "x,y\n0,0\n1\n", r"line 3: column 'y' must be a finite number, got ''"),
        ("a.csv", "x,y,time\n0,0,1\n1,1,1\n", r"line 3: time must increase"),
        ("a.csv", "x,y,x\n0,0,1\n", r"column 'x' stands there twice"),
        ("a.csv", "x [furlong],y\n0,0\n", r"unknown unit 'furlong'"),
        ("a.csv", "x,y\n0,0\n", "at least two points, got 1"),
        ("a.apt", "GOTO/1,2\n", r"line 1: GOTO/x,y,z"),
        ("a.apt", "FEDRAT/fast\n", r"line 1: FEDRAT needs a number"),
        ("a.txt", "x,y\n", r"a path file is a .csv, or APT"),
    ],
)
def test_a_bad_path_file_is_one_sentence(tmp_path: Path, name: str, text: str, message: str) -> None:
    file = tmp_path / name
    file.write_text(text)
    with pytest.raises(PliantError, match=message):
        read_path(file)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="No such file"):
        read_path(tmp_path / "none.csv")
    (tmp_path / "latin.csv").write_bytes(b"x,y\n0,0\n\xe9,1\n")
    with pytest.raises(ConfigError, match="is not UTF-8 text"):
        read_path(tmp_path / "latin.csv")
    (tmp_path / "endless.csv").write_text('x,y\n0,0\n"' + "1" * 200_000)
    with pytest.raises(ConfigError, match="is not CSV"):
        read_path(tmp_path / "endless.csv")
    with pytest.raises(OutputError, match="not a regular file"):
        read_path(tmp_path)


def test_a_path_through_points_keeps_speed_and_force_of_its_file() -> None:
    ball = SphereSurface(np.array([0.5, 0.0, 0.0]), np.eye(3), 0.2)
    angle = np.linspace(-0.3, 0.3, 61)
    points = np.column_stack([0.5 + 0.201 * np.sin(angle), np.zeros(61), 0.201 * np.cos(angle)])
    path = through(ball, points, np.full(61, 0.03), np.linspace(5.0, 25.0, 61), PathMotion(), X)
    assert path.length == pytest.approx(0.2 * 0.6, rel=1e-3)
    assert np.linalg.norm(path.position.at(0.5 * path.duration).rate) == pytest.approx(0.03, rel=0.02)
    assert path.force is not None
    assert path.force.at(0.5 * path.duration).value[0] == pytest.approx(15.0, abs=0.2)


@pytest.mark.parametrize("pattern", [circle, lemniscate])
def test_curves_are_sampled_as_densely_as_it_takes(pattern) -> None:
    """No step is longer than STEP by more than the curve is uneven, and there are not twice as many as needed."""
    points = pattern((0.4, 0.2), 1.5)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert 0.5 * STEP < steps.mean() < STEP
    assert steps.max() < 1.5 * STEP
