"""Pictures of a scene: few segments for a path, white where nothing is."""

import math

import mujoco
import numpy as np
import pytest

from pliant.simulation.snapshot import Camera, Path3, Snapshot, render, thinned_path


def _off(points: np.ndarray, corners: np.ndarray) -> float:
    """m: the largest distance of a point from the path of the corners."""
    a, b = corners[:-1], corners[1:]
    chord = b - a
    share = np.clip(np.einsum("pij,ij->pi", points[:, None] - a, chord) / np.sum(chord**2, axis=1), 0.0, 1.0)
    return float(np.linalg.norm(points[:, None] - a - share[..., None] * chord, axis=2).min(axis=1).max())


def test_straight_parts_of_a_path_are_one_segment() -> None:
    along = np.linspace(0.0, 1.0, 50)[:, None]
    corner = np.vstack([along * [1.0, 0.0, 0.0], [1.0, 0.0, 0.0] + along[1:] * [0.0, 0.0, 2.0]])
    assert thinned_path(corner, 1e-6).tolist() == [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 2.0]]


def test_a_curve_keeps_to_the_tolerance_and_needs_the_points_it_keeps() -> None:
    angle = np.linspace(0.0, 2.0 * math.pi, 401)
    circle = 0.1 * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)  # m; it ends where it begins
    tolerance = 0.25e-3
    kept = thinned_path(circle, tolerance)
    assert _off(circle, kept) <= tolerance
    least = math.pi / math.acos(1.0 - tolerance / 0.1)  # an arc of angle t is off its chord by 0.1 m (1 - cos(t / 2))
    assert least < len(kept) < 2.0 * least
    assert _off(circle, kept[::2]) > tolerance  # the control


def test_points_that_are_no_numbers_and_short_paths_stay() -> None:
    path = np.array([[0.0, 0.0, 0.0], [math.nan, 0.0, 0.0], [1.0, 0.0, 0.0]])
    assert len(thinned_path(path, 1.0)) == 3
    assert [len(thinned_path(path[:count], 1.0)) for count in (0, 1, 2)] == [0, 1, 2]


def test_a_picture_is_white_where_nothing_is() -> None:
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><geom type='sphere' size='0.1' rgba='0 0.4 0 1'/></worldbody></mujoco>"
    )
    line = Path3(np.array([[0.0, -0.4, 0.2], [0.0, 0.4, 0.2]]), (0.8, 0.0, 0.0, 1.0), 0.03)
    camera = Camera(look_at=(0.0, 0.0, 0.0), distance=1.0, azimuth=180.0, elevation=0.0)
    pictures = render(model, [Snapshot(np.zeros(0)), Snapshot(np.zeros(0), (line,))], camera, width=120, height=100)
    if pictures is None:
        pytest.skip("this machine renders neither with EGL nor with OSMesa")
    bare, lined = (picture.astype(int) for picture in pictures)
    assert (bare[0, 0] == 255).all()
    red, green, blue = bare[50, 60]
    assert green > 40
    assert max(red, blue) < green
    above = lined[:50, 60]  # z points upwards, and so does the picture
    assert (above[:, 0] > above[:, 1] + 40).any()
    assert not (lined[50:, 60, 0] > lined[50:, 60, 1] + 40).any()
