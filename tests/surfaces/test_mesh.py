"""Surfaces of triangles: against a ball of closed form, smooth between the facets, and what cannot be one."""

from __future__ import annotations

import os
import pickle
from pathlib import Path

import numpy as np
import pytest
import trimesh

from benchmarks.examples_on_robots import loaded
from pliant.errors import ConfigError
from pliant.spatial import exp3
from pliant.surfaces import MeshSurface, SphereSurface
from pliant.tasks.files import CATALOGUE
from tests.surfaces.meshes import BALL, box, cap, written

R, ORIGIN = exp3([0.2, -0.3, 0.5]), np.array([0.5, -0.1, 0.2])
SAGITTA = 12e-6  # m, of the triangles of the cap: their longest edge squared over 8 radii
PRESSED, STIFFNESS = 1.25e-3, 2e4  # m and N/m: 25 N
TOOL = 0.015  # m


@pytest.fixture(scope="module")
def shell(tmp_path_factory: pytest.TempPathFactory) -> MeshSurface:
    file = written(cap(), tmp_path_factory.mktemp("mesh") / "cap.ply")
    return MeshSurface.read(file, ORIGIN, R, outside=[0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def ball() -> SphereSurface:
    return SphereSurface(ORIGIN, R, BALL)


def along_an_arc(over: float) -> np.ndarray:
    """(k, 3) m: centres of a tool that runs over the ball at a height in m, 0.1 mm apart."""
    angle = np.arange(-0.3, 0.3, 1e-4 / (BALL + over))
    local = np.stack([np.sin(angle) * np.cos(0.3), np.sin(angle) * np.sin(0.3), np.cos(angle)], axis=1)
    return ORIGIN + (BALL + over) * local @ R.T


def test_a_mesh_goes_to_another_process(shell: MeshSurface) -> None:
    """The page gets it from the loop; what is compiled is built again there, and answers the same to the last bit."""
    there = pickle.loads(pickle.dumps(shell))
    point = ORIGIN + R @ np.array([0.01, 0.02, BALL + 0.004])
    assert there.described == shell.described
    for here, sent in zip(shell.near(point), there.near(point), strict=True):
        np.testing.assert_array_equal(here, sent)
    far = point + R @ np.array([0.0, 0.0, 1.0])  # the triangles answer, not the samples
    assert there.near(far).distance == shell.near(far).distance
    with pytest.raises(TypeError, match="cannot pickle"):  # what would be sent otherwise
        pickle.dumps(shell.distance.samples)


def test_facets_do_not_shake_the_force(shell: MeshSurface, ball: SphereSurface) -> None:
    """Distance, and so force, within 1 % of a ball's where facets lie 12 µm off it; the normal turns evenly."""
    centres = along_an_arc(TOOL - PRESSED)
    found, wanted = [shell.near(one) for one in centres], [ball.near(one) for one in centres]
    depth = np.array([TOOL - one.distance for one in found])
    np.testing.assert_allclose(STIFFNESS * depth, STIFFNESS * PRESSED, rtol=0.01)
    normals = np.array([one.normal for one in found])
    assert np.degrees(np.linalg.norm(np.diff(normals, axis=0), axis=1)).max() < 0.5
    off = np.linalg.norm(normals - np.array([one.normal for one in wanted]), axis=1)
    assert np.degrees(off).max() < 1.5


def test_coarse_facets_are_felt(tmp_path: Path) -> None:
    """The baseline of the one above: facets four times as long lie sixteen times as far off."""
    coarse = MeshSurface.read(written(cap(0.012), tmp_path / "cap.ply"), ORIGIN, R, outside=[0.0, 0.0, 1.0])
    depth = np.array([TOOL - coarse.near(one).distance for one in along_an_arc(TOOL - PRESSED)[::20]])
    assert np.abs(depth / PRESSED - 1.0).max() > 0.03


def test_the_normal_is_the_gradient_and_the_place_lies_on_the_surface(shell: MeshSurface) -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        point = shell.top() + rng.normal(0.0, 0.008, 3)
        found = shell.near(point)
        slope = [(shell.near(point + h).distance - shell.near(point - h).distance) / 2e-6 for h in 1e-6 * np.eye(3)]
        assert abs(np.linalg.norm(slope) - 1.0) < 0.05
        assert abs(shell.near(found.point).distance) < 1e-7
        np.testing.assert_allclose(point - found.point, found.distance * found.normal, atol=2e-4)


def test_far_away_the_triangles_say_the_distance(shell: MeshSurface, ball: SphereSurface) -> None:
    far = ORIGIN + R @ np.array([0.05, 0.02, 0.9])
    assert shell.near(far).distance == pytest.approx(ball.near(far).distance, abs=2.0 * SAGITTA)
    np.testing.assert_allclose(shell.near(far).normal, ball.near(far).normal, atol=0.02)


def test_a_chart_runs_along_geodesics(shell: MeshSurface, ball: SphereSurface) -> None:
    start = ball.near(shell.near(shell.top()).point).point
    uv = np.random.default_rng(1).uniform(-0.05, 0.05, (20, 2))
    along = ball.tangent(start, [0.3, 1.0, 0.1])
    places, normals = shell.chart(start, along, uv)
    wanted, upright = ball.chart(start, along, uv)
    np.testing.assert_allclose(places, wanted, atol=1e-4)
    np.testing.assert_allclose(normals, upright, atol=0.03)


def test_curvature_of_a_ball_and_of_a_hollow(shell: MeshSurface) -> None:
    assert shell.curvatures(shell.top()) == pytest.approx((1.0 / BALL, 1.0 / BALL), rel=0.1)
    part = MeshSurface.read(CATALOGUE / "parts" / "wave.ply")
    hollow = max(part.curvatures([-0.06, 0.0, -0.008]), key=abs)
    assert hollow == pytest.approx(-0.008 * (2.0 * np.pi / 0.24) ** 2, rel=0.1)  # sine of 8 mm and 0.24 m


def test_the_part_of_the_catalogue_is_that_of_the_example() -> None:
    module = loaded("07_concave_part")
    kept = trimesh.load(CATALOGUE / "parts" / "wave.ply", force="mesh")
    made = module.part()
    assert len(kept.faces) == len(made.faces)
    np.testing.assert_allclose(kept.bounds, made.bounds, atol=1e-6)
    assert kept.volume == pytest.approx(made.volume, rel=1e-5)
    surface = MeshSurface.read(CATALOGUE / "parts" / "wave.ply")
    rng = np.random.default_rng(2)
    for x, y in rng.uniform([-0.1, -0.07], [0.1, 0.07], (50, 2)):
        assert abs(surface.near([x, y, module.height(x, y)]).distance) < 3e-5  # its docstring's 0.03 mm


def test_top_is_met_from_above_however_the_part_is_turned() -> None:
    part = MeshSurface.read(CATALOGUE / "parts" / "wave.ply", ORIGIN, exp3([0.0, 0.4, 0.0]))
    top = part.top()
    assert abs(part.near(top).distance) < 1e-6
    assert part.near(top + np.array([0.0, 0.0, 0.03])).distance > 0.02
    assert part.near(top - np.array([0.0, 0.0, 0.03])).distance < 0.0


def refused(mesh: trimesh.Trimesh, file: Path, **how: object) -> str:
    with pytest.raises(ConfigError) as said:
        MeshSurface.read(written(mesh, file), **how)  # pyright: ignore[reportArgumentType]
    text = str(said.value)
    assert file.name in text or "grid" in text
    assert "\n" not in text
    return text


def test_what_cannot_be_touched_is_refused_in_a_sentence(tmp_path: Path) -> None:
    assert "not closed" in refused(cap(0.03), tmp_path / "shell.stl")
    assert "lies along" in refused(cap(0.03), tmp_path / "shell.stl", outside=[0.0, 0.0, 0.0])
    inwards = box()
    inwards.invert()
    assert "face inwards" in refused(inwards, tmp_path / "inwards.ply")
    assert "surface.scale = 0.001" in refused(box().apply_scale(1e3), tmp_path / "millimetres.stl")
    assert "only 0.2 mm long" in refused(box(), tmp_path / "small.obj", scale=1e-3)
    assert "scale" in refused(box(), tmp_path / "box.stl", scale=-1.0)
    assert "more than 8000000 (64 MB)" in refused(box(), tmp_path / "box.stl", grid=5e-4)
    one_wrong = box()
    one_wrong.faces[0] = one_wrong.faces[0][::-1]
    assert "inconsistent orientation" in refused(one_wrong, tmp_path / "mixed.ply")
    many = trimesh.Trimesh(np.random.default_rng(0).random((300_000, 3)), np.arange(603_000).reshape(-1, 3) % 300_000)
    assert "simplify" in refused(many, tmp_path / "many.ply")


@pytest.mark.parametrize("ending", [".stl", ".ply", ".obj", ".step"])
@pytest.mark.parametrize("content", [b"", b"\x00\xff" * 200, b"solid nothing\nendsolid nothing\n"])
def test_files_that_hold_no_mesh_are_refused(tmp_path: Path, ending: str, content: bytes) -> None:
    file = tmp_path / f"odd{ending}"
    file.write_bytes(content)
    with pytest.raises(ConfigError, match=r"odd\."):
        MeshSurface.read(file)


def test_a_file_that_there_is_not(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="no mesh file"):
        MeshSurface.read(tmp_path / "gone.stl")


def test_a_shell_that_looks_the_other_way_is_turned_round_and_its_rim_is_outside(tmp_path: Path) -> None:
    other = cap(6e-3)
    other.invert()
    surface = MeshSurface.read(written(other, tmp_path / "cap.ply"), outside=[0.0, 0.0, 2.0])
    assert surface.near([0.0, 0.0, BALL + 0.01]).distance == pytest.approx(0.01, abs=1e-4)
    assert surface.near([0.0, 0.0, BALL - 0.01]).distance == pytest.approx(-0.01, abs=1e-4)
    assert surface.near([0.14, 0.0, 0.1]).distance > 0.0  # beyond the rim there is no material


def test_a_file_that_was_changed_is_read_again(tmp_path: Path) -> None:
    file = written(box(), tmp_path / "box.stl")
    assert MeshSurface.read(file).near([0.0, 0.0, 0.1]).distance == pytest.approx(0.07, abs=1e-3)
    written(box().apply_scale(1.5), file)
    os.utime(file, ns=(1, 1))
    assert MeshSurface.read(file).near([0.0, 0.0, 0.1]).distance == pytest.approx(0.055, abs=1e-3)
