"""The parts of a task on a surface: force profiles, wrenches along a normal, landing, excerpts, a tool that spins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pliant.errors import ConfigError
from pliant.references.landing import SETTLE, Height
from pliant.references.postures.inverse_kinematics import Target
from pliant.references.toolpaths.patterns import PATTERNS, line
from pliant.references.toolpaths.pressing import Pressing, PressingForce
from pliant.references.toolpaths.toolpath import PathMotion, Toolpath, on_chart
from pliant.references.trajectories.excerpt import Excerpt, TurningExcerpt
from pliant.references.trajectories.waypoints import Waypoints
from pliant.spatial import exp3
from pliant.surfaces import PlaneSurface, SphereSurface
from tests.references.ball_arm import PROFILE, ROBOT, X


def laid_circle() -> Toolpath:
    ball = SphereSurface(np.zeros(3), np.eye(3), 0.2)
    return on_chart(ball, ball.top(), X, PATTERNS["circle"]((0.1, 0.1), 0.0, 1.0), PathMotion(speed=0.05), X)


def test_force_profiles() -> None:
    with pytest.raises(ConfigError, match=r"knots of a force profile must increase, got \[0.0, 0.0\]"):
        PressingForce((0.0, 0.0), (1.0, 2.0))
    with pytest.raises(ConfigError, match=r"pushes: not negative"):
        PressingForce((0.0,), (-1.0,))
    plane = PlaneSurface(np.zeros(3), exp3([0.3, 0.0, 0.0]))
    path = on_chart(plane, plane.origin, X, line((0.1, 0.0)), PathMotion(speed=0.05), X)
    by_share, by_time = PROFILE.along(path), replace(PROFILE, unit="s").along(path)
    middle = 0.5 * path.duration
    assert by_share.at(middle).value[0] == pytest.approx(25.0)
    assert by_time.at(0.05).value[0] == pytest.approx(15.0)
    assert by_share.at(0.0).value[0] == pytest.approx(5.0)
    wrench = Pressing(by_share, path.task).at(middle)
    np.testing.assert_allclose(wrench.value, [*(25.0 * plane.rotation[:, 2]), 0.0, 0.0, 0.0], atol=1e-9)


def test_the_rates_of_a_wrench_along_a_turning_normal_are_its_derivatives() -> None:
    path = laid_circle()
    pressing = Pressing(PressingForce((0.0, 1.0), (5.0, 25.0)).along(path), path.task)
    h, t = 1e-4, 0.4 * path.duration + 3e-3
    before, now, after = (pressing.at(t + dt) for dt in (-h, 0.0, h))
    np.testing.assert_allclose(now.rate, (after.value - before.value) / (2 * h), atol=1e-3)
    np.testing.assert_allclose(now.acceleration, (after.rate - before.rate) / (2 * h), atol=0.2)
    assert np.linalg.norm(now.rate) > 1.0  # else the test would prove nothing


def test_a_landing_starts_and_ends_as_it_should() -> None:
    height = Height(start=1.0, found=0.002, gap=-0.003, rate=-0.05)
    assert height.at(1.0) == pytest.approx((0.002 - 0.003, -0.05, 0.0))
    assert height.at(1.0 + SETTLE) == pytest.approx((0.002, 0.0, 0.0), abs=1e-12)
    h = 1e-6
    for time in (1.02, 1.05, 1.09):
        before, now, after = (height.at(time + dt) for dt in (-h, 0.0, h))
        assert now[1] == pytest.approx((after[0] - before[0]) / (2 * h), rel=1e-5)
        assert now[2] == pytest.approx((after[1] - before[1]) / (2 * h), rel=1e-5)
    assert min(height.at(1.0 + x)[0] for x in np.linspace(0.0, SETTLE, 50)) > -0.0025  # m: it goes little deeper


def test_an_excerpt_holds_before_and_after() -> None:
    whole = Waypoints([0.0, 1.0], [[0.0], [1.0]], "ramp")
    part = Excerpt(whole, 0.25, 0.5)
    assert [part.at(t).value[0] for t in (-1.0, 0.0, 0.1, 0.25, 9.0)] == pytest.approx([0.25, 0.25, 0.35, 0.5, 0.5])
    assert part.at(0.1).rate[0] == 1.0
    assert part.at(0.3).rate[0] == 0.0
    path = laid_circle()
    turned = TurningExcerpt(path.task, 0.5, 1.0)
    for time, whole_time in ((-1.0, 0.5), (0.2, 0.7), (3.0, 1.0)):
        np.testing.assert_allclose(turned.at(time).rotation, path.task.at(whole_time).rotation)
    assert np.linalg.norm(turned.at(0.2).velocity) > 0.1
    assert not turned.at(3.0).velocity.any()


@pytest.mark.parametrize("method", ["mink", "aico"])
def test_a_tool_that_may_spin_goes_to_the_nearest_turn(method: str) -> None:
    from pliant.references.postures.inverse_kinematics import joint_box
    from pliant.references.postures.posture import METHODS

    solver = METHODS[method](ROBOT, "tool")
    position, R = ROBOT.placement(ROBOT.home, "tool")
    wanted = Target(position + np.array([0.01, 0.02, -0.01]), exp3([0.05, 0.0, 0.0]) @ R @ exp3([0.0, 0.0, 2.0]), True)
    q = solver.solve(ROBOT.home, ROBOT.home, joint_box(ROBOT), wanted)
    distance, angle = solver.shortfall(q, wanted)
    assert distance < 1e-5
    assert angle < 1e-4
    assert np.abs(q - ROBOT.home).max() < 0.2  # the fixed turn of 2 rad would take the wrist that far
    assert solver.shortfall(q, wanted._replace(spins=False))[1] > 1.5
