"""Lists of phases press along their own force: a tilted plane is as good as a level one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from pliant.references.force_axes import task_axes
from pliant.references.placed_phases import PlacedPhase
from pliant.spatial import exp3
from pliant.studies.task.build_list import listed
from pliant.studies.task.study import study_of
from pliant.surfaces import FacetSurface, PlaneSurface
from tests.tasks.tilted import run_tilted

_WORSE = 1.3  # of the error on a level plane
_EVEN = 0.03  # N, 0.2 % of the force: two errors that differ by less are one


@pytest.mark.study
@pytest.mark.parametrize(
    ("controller", "late"),
    [("offset-free-mpc", True), ("force-feedback-mpc", False), ("haptic", True), ("operational-space", True)],
)
def test_a_tilted_plane_is_as_good_as_a_level_one(controller: str, late: bool) -> None:
    level, tilted = (run_tilted(tilt, controller, late=late) for tilt in (0.0, 45.0))
    assert tilted <= max(_WORSE * level, level + _EVEN), (controller, level, tilted)


@pytest.mark.study
def test_who_presses_along_the_worlds_z_axis_does_not_hold_the_force(monkeypatch: pytest.MonkeyPatch) -> None:
    level = run_tilted(0.0, "offset-free-mpc", late=True)

    def as_they_are(all_placed: Sequence[PlacedPhase]) -> tuple[PlacedPhase, ...]:
        return tuple(all_placed)

    def nothing(*_: Any) -> None:
        return None

    monkeypatch.setattr("pliant.studies.task.listed.with_axes", as_they_are)
    monkeypatch.setattr("pliant.studies.task.build_list.pressed_planes", nothing)
    upright = run_tilted(45.0, "offset-free-mpc", late=True)
    assert upright > 5.0 * level


def test_the_axes_of_a_force_are_those_of_its_frame_where_it_lies_along_one() -> None:
    frame = exp3(np.array([0.3, -0.5, 0.9]))
    for axis in range(3):
        for sign in (1.0, -1.0):
            axes = task_axes(frame, sign * 7.0 * frame[:, axis])
            assert axes is not None
            np.testing.assert_allclose(axes[:, 2], sign * frame[:, axis], atol=1e-12)
            np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
            assert np.linalg.det(axes) > 0.0
            assert np.abs(frame.T @ axes).round(9).max(axis=0).tolist() == [1.0, 1.0, 1.0]
    oblique = task_axes(frame, np.array([1.0, 2.0, 3.0, 0.0, 0.0, 0.0]))
    assert oblique is not None
    np.testing.assert_allclose(oblique[:, 2], np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0), atol=1e-12)
    assert task_axes(frame, np.zeros(6)) is None


def test_phases_that_press_to_different_sides_believe_a_plane_for_each() -> None:
    made = listed(study_of("box-tip").case("box-tip"))
    assert isinstance(made.believed.surface, PlaneSurface)  # the two that push, push the same way
    np.testing.assert_allclose(made.believed.surface.rotation[:, 2], [-1.0, 0.0, 0.0], atol=1e-12)
    floor = PlaneSurface.facing([0.0, 0.0, 1.0])
    wall = PlaneSurface.facing([-1.0, 0.0, 0.0], [0.5, 0.0, 0.0])
    both = FacetSurface.of([floor, wall])
    np.testing.assert_allclose(both.normal([0.2, 0.0, 0.01]), [0.0, 0.0, 1.0])
    np.testing.assert_allclose(both.normal([0.49, 0.0, 0.3]), [-1.0, 0.0, 0.0], atol=1e-12)
    assert both.near([0.49, 0.0, 0.3]).distance == pytest.approx(0.01)
    assert FacetSurface.of([floor]) is floor
