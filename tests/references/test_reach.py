"""The reach check against known answers: torques, bounds that are broken, what would help, true surfaces."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest

from pliant.errors import ConfigError
from pliant.references.postures.posture import PostureOptions, UnreachableError
from pliant.references.reach import ReachBounds, check_reach
from pliant.references.toolpaths.patterns import line
from pliant.references.trajectories.spline import Spline
from pliant.studies.task.reach_figure import reach_figure
from pliant.surfaces import PlaneSurface, SphereSurface
from tests.references.ball_arm import RADIUS, ROBOT
from tests.references.reach_courses import course_on, on_plane, quick, torque_share

PLAIN = PostureOptions(restarts=0)


def test_the_torque_is_that_of_weight_force_and_the_worst_sideways_push() -> None:
    course = on_plane(0.55)
    check = quick(course)
    assert check.posture is not None
    load = next(margin for margin in check.surfaces[0].margins if margin.name == "torque")
    whole = Spline(check.posture.times, check.posture.postures)
    for sample in range(5, len(course.times) - 5, 7):
        q = whole.at(float(course.times[sample])).value
        share = torque_share(q, course.normals[sample], course.force[sample])
        assert share <= load.values[sample] * (1.0 + 1e-9)
        assert share == pytest.approx(load.values[sample], rel=0.02)  # sixteen directions miss the worst one by 2 %


def test_each_bound_is_found_broken_and_said() -> None:
    course = on_plane(0.55)
    left = {margin.name: margin for margin in quick(course).surfaces[0].margins}
    fields = {"joint margin": "joint_margin", "freedom": "freedom", "torque": "load", "joint speed": "speed"}
    for name, field in fields.items():
        margin = left[name]
        worst = float(margin.values[margin.worst])
        tighter, looser = (1.01, 0.99) if margin.least else (0.99, 1.01)
        check = quick(course, bounds=ReachBounds(**{field: tighter * worst}))
        assert not check.reachable
        assert name in check.surfaces[0].failure
        assert [row[1] for row in check.rows() if row[5] == "✗"] == [name]
        assert quick(course, bounds=ReachBounds(**{field: looser * worst})).reachable
    with pytest.raises(ConfigError, match="load of a reach check must not be negative"):
        ReachBounds(load=-1.0)


def test_out_of_reach_is_said_with_the_point_and_what_would_help() -> None:
    course = on_plane(0.95)
    check = check_reach(ROBOT, "tool", course, posture=PLAIN, nominal=ROBOT.home)
    assert not check.reachable
    assert "cannot reach" in check.surfaces[0].failure
    assert check.help.startswith("move surface and path by")
    assert "towards the base" in check.help
    size = float(check.help.split("by ")[1].split(" cm")[0]) / 100.0
    assert quick(course.moved(np.array([-size, 0.0, 0.0]))).reachable


def test_too_much_force_and_too_much_speed_have_their_own_remedies() -> None:
    heavy = check_reach(ROBOT, "tool", on_plane(0.55, force=700.0), posture=PLAIN, nominal=ROBOT.home)
    assert "torque of joint" in heavy.surfaces[0].failure
    assert heavy.help.startswith("press with")
    lighter = float(heavy.help.split("at most ")[1].split(" N")[0])
    assert quick(on_plane(0.55, force=lighter)).reachable
    assert not quick(on_plane(0.55, force=1.1 * lighter)).reachable
    huge = check_reach(ROBOT, "tool", on_plane(0.55, force=1e6), posture=PLAIN, nominal=ROBOT.home)
    assert huge.help.split("at most ")[1] == heavy.help.split("at most ")[1]
    fast = check_reach(ROBOT, "tool", on_plane(0.55), bounds=ReachBounds(speed=0.02), posture=PLAIN)
    assert "joint speed of joint" in fast.surfaces[0].failure
    assert "times slower" in fast.help


def test_the_course_on_a_true_surface_lies_on_it() -> None:
    place = np.array([0.55, 0.0, 0.15])
    believed = PlaneSurface(place, np.eye(3))
    course = course_on(believed, place, line((0.1, 0.0)))
    true = believed.moved(shift=[0.0, 0.0, 0.004], turn=[0.0, math.radians(4.0), 0.0], pivot=place)
    moved = course.on(true, RADIUS)
    for point in moved.places[moved.on_path]:
        assert true.near(point).distance == pytest.approx(RADIUS, abs=1e-9)
    np.testing.assert_allclose(moved.places[:, :2], course.places[:, :2])  # along the believed normal
    with pytest.raises(ConfigError, match="leaves the surface near"):
        course.on(SphereSurface(place - [0.0, 0.0, 0.03], np.eye(3), 0.03), RADIUS)


def test_a_true_surface_on_which_it_fails_makes_the_task_unreachable() -> None:
    place = np.array([0.55, 0.0, 0.15])
    believed = PlaneSurface(place, np.eye(3))
    course = course_on(believed, place, line((0.1, 0.0)))
    near, gone = believed.moved(shift=[0.0, 0.0, 0.004]), SphereSurface(place - [0.0, 0.0, 0.03], np.eye(3), 0.03)
    true = [partial(course.on, surface, RADIUS) for surface in (near, gone)]
    good = check_reach(ROBOT, "tool", course, true[:1], posture=PLAIN)
    assert good.reachable
    assert [found.label for found in good.surfaces] == ["believed", "drawn 1"]
    bad = check_reach(ROBOT, "tool", course, true, posture=PLAIN)
    assert not bad.reachable
    assert "leaves the surface" in bad.surfaces[2].failure
    assert len(reach_figure(good, "task").axes) == 4
    assert len(reach_figure(bad).axes) == 4


def test_unreachable_errors_say_when() -> None:
    assert UnreachableError("x", 2.0).time == 2.0


def test_a_course_goes_forward_in_time_from_the_approach_to_the_way_up() -> None:
    course = on_plane(0.55)
    assert np.all(np.diff(course.times) > 0.0)
    path = course.times[course.on_path]
    assert path[0] == pytest.approx(0.3)  # s: 30 mm at 0.1 m/s
    assert course.times[-1] == pytest.approx(path[-1] + 0.3)


def test_the_joint_margin_is_to_the_nearer_limit() -> None:
    check = quick(on_plane(0.55))
    assert check.posture is not None
    (margin,) = (margin for margin in check.surfaces[0].margins if margin.name == "joint margin")
    whole = Spline(check.posture.times, check.posture.postures)
    found = [whole.at(float(time)).value for time in on_plane(0.55).times]
    left = [min(np.min(q - ROBOT.position_lower), np.min(ROBOT.position_upper - q)) for q in found]
    np.testing.assert_allclose(margin.values, left, atol=1e-9)
    nearer = [np.min(ROBOT.position_upper - q) < np.min(q - ROBOT.position_lower) for q in found]
    assert any(nearer)  # so that the upper limits are looked at
