"""The reach check: what it says is possible is, by an independent run; what it says is missing is, by known answers."""

from __future__ import annotations

import math
from functools import partial
from unittest.mock import patch

import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import ConfigError
from pliant.references.postures.posture import PostureOptions, UnreachableError
from pliant.references.reach import Course, ReachBounds, ReachCheck, check_reach, course_of
from pliant.references.toolpaths.patterns import circle, line
from pliant.references.toolpaths.pressing import PressingForce
from pliant.references.toolpaths.toolpath import PathMotion, on_chart
from pliant.references.trajectories.spline import Spline
from pliant.robot import Robot, Tool
from pliant.spatial import exp3, log3, rpy
from pliant.studies.task.reach_figure import reach_figure
from pliant.surfaces import CylinderSurface, PlaneSurface, SphereSurface, SurfaceGeometry

RADIUS = 0.015
ROBOT = Robot.load("iiwa14").with_tool(Tool(mass=0.3, length=0.15, radius=RADIUS, frame="tool"))
X = np.array([1.0, 0.0, 0.0])
PLAIN = PostureOptions(restarts=0)


def course_on(
    surface: SurfaceGeometry, near: object, uv: np.ndarray, speed: float = 0.1, force: float = 25.0
) -> Course:
    path = on_chart(surface, np.asarray(near, dtype=np.float64), X, uv, PathMotion(speed, lift=RADIUS), X)
    return course_of(path, PressingForce.constant(force), stand_off=0.03, approach_speed=0.1, leave=0.3)


def on_plane(x: float, z: float = 0.15, speed: float = 0.1, force: float = 25.0) -> Course:
    place = np.array([x, 0.0, z])
    return course_on(PlaneSurface(place, np.eye(3)), place, line((0.1, 0.0)), speed, force)


# ---------------------------------------------------------------------- an independent run


def driven(course: Course, check: ReachCheck, spins: bool) -> str:
    """Drives the joints along the course by differential kinematics, with stops at the limits of position and speed.

    Says what went wrong, if anything did. Shares no code with the check but the posture that it proposes.
    """
    assert check.posture is not None
    model, data, frame = ROBOT.model, ROBOT.model.createData(), ROBOT.frame_id("tool")
    wanted, motion = Spline(check.posture.times, check.posture.postures), course.motion("tool")
    axes, dt, q = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED, 0.01, check.posture.postures[0].copy()
    for tick in range(round(float(course.times[-1]) / dt)):
        task = motion.at(tick * dt)
        assert task.rotation is not None
        pin.framesForwardKinematics(model, data, q)
        x, R = np.array(data.oMf[frame].translation), np.array(data.oMf[frame].rotation)
        tilt = np.cross(R[:, 2], task.rotation[:, 2]) if spins else log3(task.rotation @ R.T)
        miss = float(np.linalg.norm(task.position - x))
        if miss > 3e-3 or np.linalg.norm(tilt) > 0.02:
            return f"{1e3 * miss:.1f} mm and {np.linalg.norm(tilt):.3f} rad off at {tick * dt:.2f} s"
        J = pin.computeFrameJacobian(model, data, q, frame, axes)
        turning = (np.eye(3) - np.outer(R[:, 2], R[:, 2])) @ J[3:] if spins else J[3:]
        A = np.vstack([J[:3], turning])
        rate = np.concatenate([task.velocity[:3] + 20.0 * (task.position - x), 20.0 * tilt])
        spin = task.velocity[3:]
        rate[3:] += spin - R[:, 2] * (R[:, 2] @ spin) if spins else spin
        inverse = np.linalg.pinv(A, rcond=1e-6)
        v = inverse @ rate + (np.eye(ROBOT.n) - inverse @ A) @ (20.0 * (wanted.at(tick * dt).value - q))
        v = np.clip(v, -ROBOT.velocity_limit, ROBOT.velocity_limit)
        q = np.clip(q + dt * v, ROBOT.position_lower, ROBOT.position_upper)
        if tick % 10 == 0:
            sample = int(np.argmin(np.abs(course.times - tick * dt)))
            overloaded = torque_share(q, course.normals[sample], course.force[sample])
            if overloaded > 1.02:  # 2 %: the instant of a sample and that of the run differ
                return f"a joint at {overloaded:.2f} of its torque limit"
    return ""


def torque_share(q: np.ndarray, n: np.ndarray, force: float) -> float:
    """Largest share of a torque limit under weight, force and 20 N in sixteen directions across the normal."""
    data = ROBOT.model.createData()
    zero = np.zeros(ROBOT.n)
    J = pin.computeFrameJacobian(ROBOT.model, data, q, ROBOT.frame_id("tool"), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    weight = pin.rnea(ROBOT.model, data, q, zero, zero)
    first = np.cross(n, X if abs(n[0]) < 0.9 else [0.0, 1.0, 0.0])
    first /= np.linalg.norm(first)
    worst = 0.0
    for angle in np.linspace(0.0, 2.0 * math.pi, 16, endpoint=False):
        push = force * n + 20.0 * (math.cos(angle) * first + math.sin(angle) * np.cross(n, first))
        worst = max(worst, float(np.max(np.abs(weight - J[:3].T @ push) / ROBOT.torque_limit)))
    return worst


def drawn(seed: int) -> tuple[Course, bool]:
    """A task somewhere from the middle of the workspace to beyond its border."""
    rng = np.random.default_rng(seed)
    place = np.array([rng.uniform(0.45, 0.75), rng.uniform(-0.2, 0.2), rng.uniform(0.0, 0.35)])
    lean = rpy(*rng.uniform(-0.4, 0.4, 2), 0.0)
    kind, radius = seed % 3, rng.uniform(0.1, 0.3)
    surface: SurfaceGeometry = PlaneSurface(place, lean)
    if kind == 1:
        surface = CylinderSurface(place - radius * lean[:, 2], lean @ exp3([0.5 * math.pi, 0.0, 0.0]), radius)
    if kind == 2:
        surface = SphereSurface(place - radius * lean[:, 2], lean, radius)
    uv = circle((0.08, 0.06), 1.0) if seed % 2 else line((0.1, 0.05))
    return course_on(surface, place, uv, rng.uniform(0.1, 0.3), rng.uniform(5.0, 60.0)), bool(rng.integers(2))


def test_what_is_said_to_be_reachable_is() -> None:
    """20 drawn tasks, both answers among them."""
    answers: list[bool] = []
    for seed in range(20):
        course, spins = drawn(seed)
        check = quick(course, spins)
        answers.append(check.reachable)
        if check.reachable:
            assert driven(course, check, spins) == "", f"seed {seed}"
    assert 5 <= sum(answers) <= 15


def quick(course: Course, spins: bool = False, bounds: ReachBounds | None = None) -> ReachCheck:
    """From the home posture alone, and without a search for what would help, which takes long."""
    with patch("pliant.references.reach.check.remedy", return_value=""):
        options = PostureOptions(restarts=0, spins=spins)
        return check_reach(ROBOT, "tool", course, bounds=bounds, posture=options, nominal=ROBOT.home)


def test_the_run_notices_what_the_check_would_have_to_say() -> None:
    """The run is no rubber stamp: with an overload, with slow joints it fails."""
    course = on_plane(0.55)
    good = quick(course)
    assert good.reachable
    assert driven(course, good, False) == ""
    heavy = on_plane(0.55, force=800.0)
    assert not quick(heavy).reachable
    assert "torque limit" in driven(heavy, good, False)
    elsewhere = on_plane(0.65)
    assert "off at" in driven(elsewhere, good, False)


# ---------------------------------------------------------------------- known answers


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
