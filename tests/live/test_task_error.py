"""What counts as an error of place beside a force, and what of the force: known answers."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.axis_modes import AxisModes, Mode
from pliant.live.page.error_trail import coloured, nice_top, scale_of
from pliant.live.page.task_error import TaskError, motion_axes, position_error, position_errors
from pliant.signals import TaskReference
from pliant.spatial import rpy

APART = np.array([1.0, -2.0, 5.0])  # mm
NONE = np.zeros(3)


def asked(force: tuple[float, float, float], modes: AxisModes | None = None) -> TaskReference:
    return TaskReference("tool", NONE, wrench=np.array([*force, 0.0, 0.0, 0.0]), modes=modes)


def test_no_position_error_along_the_axis_that_a_force_rules() -> None:
    """Pressed upwards, z has none; without a force (the control) it has all of it."""
    pressed = position_error(APART, motion_axes(asked((0.0, 0.0, 25.0))))
    np.testing.assert_array_equal(pressed, [1.0, -2.0, np.nan])
    np.testing.assert_array_equal(position_error(APART, motion_axes(asked((0.0, 0.0, 0.0)))), APART)


def test_on_a_leaning_surface_what_lies_along_its_normal_does_not_count() -> None:
    """An error of 5 mm straight along a normal that leans by 45° is none of x nor z."""
    n = rpy(0.0, np.pi / 4, 0.0)[:, 2]
    task = asked(tuple(20.0 * n))
    np.testing.assert_allclose(position_error(5.0 * n, motion_axes(task)), NONE, atol=1e-12)
    tangent = rpy(0.0, np.pi / 4, 0.0)[:, 0]
    np.testing.assert_allclose(position_error(5.0 * tangent, motion_axes(task)), 5.0 * tangent, atol=1e-12)


@pytest.mark.parametrize(("mode", "shown"), [("motion", True), ("force", False), ("free", False)])
def test_axis_modes_say_which_axes_are_asked_for_a_place(mode: Mode, shown: bool) -> None:
    modes = AxisModes(("motion", mode, "motion", "free", "free", "free"))
    error = position_error(APART, motion_axes(asked((0.0, 0.0, 0.0), modes)))
    assert np.isfinite(error).tolist() == [True, shown, True]


def test_many_errors_of_a_log_are_those_of_its_instants() -> None:
    forces = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 9.0], [3.0, 0.0, 4.0]])
    many = position_errors(np.tile(APART, (3, 1)), forces)
    for row, force in zip(many, forces, strict=True):
        np.testing.assert_allclose(row, position_error(APART, motion_axes(asked(tuple(force)))), atol=1e-12)


def test_force_and_path_error_where_a_frame_presses() -> None:
    """25 N are asked for and 26 N act, with 7 N of friction across; the frame is 3 and 4 mm beside its target, and
    9 mm behind it, which the force makes so."""
    task = asked((0.0, 0.0, 25.0))
    found = TaskError.of(task, np.array([3e-3, -4e-3, 9e-3]), np.array([7.0, 0.0, 26.0]))
    assert found is not None
    assert found.force == pytest.approx(1.0)
    assert found.path == pytest.approx(5.0)
    assert TaskError.of(task, NONE, NONE) is None
    assert TaskError.of(asked((0.0, 0.0, 0.0)), NONE, np.array([0.0, 0.0, 3.0])) is None


# ---------------------------------------------------------------------- colours on the surface


def test_a_scale_ends_at_a_round_value_that_covers_most() -> None:
    assert nice_top(np.array([0.3, -1.7, 0.9])) == pytest.approx(2.0)
    assert nice_top(np.full(5, 0.24)) == pytest.approx(0.5)
    assert nice_top(np.full(5, 1e-4)) == pytest.approx(0.1)
    assert nice_top(np.array([*np.full(99, 0.9), 80.0])) == pytest.approx(1.0)  # one outlier does not count
    assert nice_top(np.full(3, 6.0)) == pytest.approx(10.0)


def test_colours_of_too_little_right_and_too_much_differ() -> None:
    low, right, high = coloured(np.array([-2.0, 0.0, 2.0]), 2.0, signed=True).astype(int)
    assert low[2] - low[0] > 100  # blue
    assert high[0] - high[2] > 100  # red
    assert abs(right[0] - right[2]) < 20  # grey
    np.testing.assert_array_equal(coloured(np.array([9.0]), 2.0, signed=True)[0], high)
    small, large = coloured(np.array([0.0, 2.0]), 2.0, signed=False).astype(int)
    assert small[1] - small[0] > 100  # green
    np.testing.assert_array_equal(large, high)
    assert "−2" in scale_of(2.0, "N", signed=True)
    assert "−" not in scale_of(2.0, "mm", signed=False)
