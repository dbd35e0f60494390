"""Postures along a path: the tool stays on it, the arm stays on one branch, and a frame out of reach is named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import ConfigError, RobotError
from pliant.references.postures.inverse_kinematics import JointBox, PoseSolver, Target, joint_box
from pliant.references.postures.posture import (
    METHODS,
    PostureOptions,
    PosturePath,
    UnreachableError,
    solve_posture,
)
from pliant.references.postures.posture_source import PostureSource, posture_source
from pliant.references.source import FrameMotion
from pliant.references.trajectories.shapes import lemniscate, sine_line
from pliant.references.trajectories.trajectory import Hold
from pliant.robot import Robot
from pliant.signals import Estimate
from pliant.spatial import Array, frame_with_z_along, log3

ALONG_Y = frame_with_z_along((0.0, -1.0, 0.0))


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("lwr4")


@pytest.fixture(scope="module", params=["mink", "aico"])
def source(robot: Robot, request: pytest.FixtureRequest) -> PostureSource:
    motion = FrameMotion("flange", lemniscate(), ALONG_Y).eased(2.0)
    return posture_source(robot, motion, ("elbow",), 7.0, posture=PostureOptions(method=request.param))


def test_tool_is_on_the_path_between_the_samples_too(robot: Robot, source: PostureSource) -> None:
    for t in np.linspace(0.0, 7.0, 333):
        reference = source.at(t, t)
        task = source.motion.at(t)
        assert reference.posture is not None
        position, rotation = robot.placement(reference.posture, "flange")
        assert np.linalg.norm(position - task.position) < 5e-6
        assert np.linalg.norm(log3(ALONG_Y @ rotation.T)) < 5e-6
        np.testing.assert_allclose(reference.tasks[0].position, task.position, atol=1e-8)
        np.testing.assert_allclose(reference.tasks[0].velocity, task.velocity, atol=1e-5)
        assert reference.tasks[0].rotation is not None


def test_elbow_belongs_to_the_posture_and_its_velocity_to_its_position(robot: Robot, source: PostureSource) -> None:
    h = 1e-4
    for t in np.linspace(0.1, 6.9, 57):
        reference = source.at(t, t)
        assert reference.posture is not None
        elbow = reference.tasks[1]
        np.testing.assert_allclose(elbow.position, robot.placement(reference.posture, "elbow")[0], atol=1e-6)
        numeric = (source.at(0, t + h).tasks[1].position - source.at(0, t - h).tasks[1].position) / (2 * h)
        np.testing.assert_allclose(elbow.velocity[:3], numeric, atol=1e-5)
        assert elbow.rotation is None
        assert not elbow.velocity[3:].any()


def test_path_stays_on_one_branch(robot: Robot, source: PostureSource) -> None:
    speeds = np.abs(np.diff(source.path.postures, axis=0)) / np.diff(source.path.times)[:, None]
    assert np.all(speeds <= robot.velocity_limit + 1e-9)
    assert np.all(source.path.postures >= robot.position_lower)
    assert np.all(source.path.postures <= robot.position_upper)


def test_independent_samples_would_jump(robot: Robot) -> None:
    """Baseline: solved one by one from random starts, the same poses give other branches."""
    solver, random = METHODS["mink"](robot, "flange"), np.random.default_rng(1)
    box, target = joint_box(robot), Target(np.array([0.0, -0.6, 0.5]), ALONG_Y)
    starts = random.uniform(box.lower, box.upper, (20, robot.n))
    solutions = [solver.solve(q, q, box, target) for q in starts]
    reached = [q for q in solutions if solver.shortfall(q, target)[0] < 1e-3]
    assert max(np.max(np.abs(q - reached[0])) for q in reached) > 1.0


def test_both_methods_find_the_same_optimum(robot: Robot) -> None:
    motion = FrameMotion("flange", lemniscate(), ALONG_Y).eased(1.0)
    nominal = solve_posture(robot, motion, 0.1).postures[0]
    paths = [solve_posture(robot, motion, 2.0, nominal, PostureOptions(method=m)).postures for m in METHODS]
    np.testing.assert_allclose(paths[0], paths[1], atol=1e-5)


def test_redundancy_drifts_to_the_nominal_posture(robot: Robot) -> None:
    hold = FrameMotion("flange", Hold((0.0, -0.6, 0.5)), ALONG_Y)
    start = solve_posture(robot, hold, 0.1).postures[0]
    J = METHODS["mink"](robot, "flange").jacobian(start)
    self_motion = np.linalg.svd(J)[2][-1]
    nominal = start + 0.3 * self_motion
    path = solve_posture(robot, hold, 6.0, nominal)
    distance = np.abs((path.postures - nominal) @ self_motion)
    assert distance[-1] < 0.2 * max(distance[0], 0.1)


def _solves(monkeypatch: pytest.MonkeyPatch, robot: Robot, motion: FrameMotion) -> tuple[int, PosturePath]:
    """How many poses are solved along 80 s in samples of 0.2 s, and the path."""
    count, make = 0, METHODS["mink"]

    def counting(robot: Robot, frame: str) -> PoseSolver:
        solver = make(robot, frame)
        solve = solver.solve

        def counted(guess: Array, prior: Array, box: JointBox, target: Target) -> Array:
            nonlocal count
            count += 1
            return solve(guess, prior, box, target)

        monkeypatch.setattr(solver, "solve", counted)
        return solver

    monkeypatch.setitem(METHODS, "mink", counting)
    path = solve_posture(robot, motion, 80.0, robot.home, PostureOptions(period=0.2))
    monkeypatch.setitem(METHODS, "mink", make)
    return count, path


def test_a_pose_that_is_held_is_solved_until_the_posture_rests(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    """Control: a motion that goes on is solved at every sample, and so is a hold where nothing counts as rest."""
    held = FrameMotion("flange", Hold((0.0, -0.6, 0.5)), ALONG_Y)
    moving = FrameMotion("flange", sine_line(0.1, 0.01), ALONG_Y)
    (few, short), (many, _) = (_solves(monkeypatch, robot, motion) for motion in (held, moving))
    monkeypatch.setattr("pliant.references.postures.posture._AT_REST", -1.0)
    every, whole = _solves(monkeypatch, robot, held)
    samples = len(short.times) - 1
    assert few < 0.75 * samples
    assert min(many, every) >= samples
    np.testing.assert_allclose(short.postures, whole.postures, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_out_of_reach_is_named(robot: Robot, method: str) -> None:
    far = FrameMotion("flange", Hold((0.0, -2.0, 0.5)), ALONG_Y)
    with pytest.raises(
        UnreachableError, match=r"'flange' .* cannot reach \(0\.000, -2\.000, 0\.500\) m at t = 0\.000 s.* mm"
    ):
        solve_posture(robot, far, 1.0, options_=PostureOptions(method=method))
    away = FrameMotion("flange", sine_line(0.9, 0.5), ALONG_Y).eased(1.0)
    with pytest.raises(UnreachableError, match=r"at t = [1-9]"):
        solve_posture(robot, away, 6.0, options_=PostureOptions(method=method))


def test_too_fast_is_told_from_too_far(robot: Robot) -> None:
    fast = FrameMotion("flange", sine_line(0.3, 9.0), ALONG_Y)
    with pytest.raises(UnreachableError, match="speed limit"):
        solve_posture(robot, fast, 1.0)


def test_infinite_tolerance_goes_as_near_as_it_can(robot: Robot) -> None:
    away = FrameMotion("flange", sine_line(0.8, 0.5), ALONG_Y).eased(1.0)
    path = solve_posture(robot, away, 6.0, options_=PostureOptions(tolerance=np.inf))
    assert np.isfinite(path.postures).all()
    assert path.worst_distance > 0.01


def test_position_only_motion(robot: Robot) -> None:
    path = solve_posture(robot, FrameMotion("flange", lemniscate()).eased(1.0), 2.0)
    assert path.worst_distance < 1e-5
    assert path.worst_angle == 0.0


def test_source_runs_from_the_moment_it_starts_and_holds_at_the_end(robot: Robot, source: PostureSource) -> None:
    zero = np.zeros(robot.n)
    state = source.init(Estimate(3.0, zero, zero, zero, zero))
    reference, _ = source.step(Estimate(3.0, zero, zero, zero, zero), state)
    np.testing.assert_allclose(reference.posture, source.start)
    assert reference.time == 3.0
    late, _ = source.step(Estimate(300.0, zero, zero, zero, zero), state)
    assert not late.tasks[0].velocity.any()


def test_bad_input_is_named(robot: Robot) -> None:
    motion = FrameMotion("flange", lemniscate(), ALONG_Y)
    with pytest.raises(ConfigError, match="did you mean 'mink'"):
        solve_posture(robot, motion, 1.0, options_=PostureOptions(method="mnk"))
    with pytest.raises(RobotError, match="no frame 'flang'"):
        solve_posture(robot, FrameMotion("flang", lemniscate()), 1.0)
    with pytest.raises(ConfigError, match="duration"):
        solve_posture(robot, motion, 0.0)


@pytest.mark.parametrize("method", METHODS)
def test_jacobian_used_is_the_derivative_of_the_pose(robot: Robot, method: str) -> None:
    solver = METHODS[method](robot, "flange")
    q, h = np.array(robot.home), 1e-6
    J = solver.jacobian(q)
    for j in range(robot.n):
        dq = np.zeros(robot.n)
        dq[j] = h
        up, down = (robot.placement(pin.integrate(robot.model, q, s * dq), "flange") for s in (1, -1))
        numeric = np.concatenate([up[0] - down[0], log3(up[1] @ down[1].T)]) / (2 * h)
        np.testing.assert_allclose(J[:, j], numeric, atol=1e-8)


def test_a_motion_that_repeats_itself_is_solved_until_its_postures_do(robot: Robot) -> None:
    motion, period, options = FrameMotion("flange", lemniscate(1.0), ALONG_Y).eased(0.5), 1.0, PostureOptions()
    fast = replace(options, nominal_rate=8.0, speed_fraction=3.0)  # the drift ends within seconds
    whole = posture_source(robot, motion, ("elbow",), 16.0, posture=fast)
    short = posture_source(robot, motion, ("elbow",), 16.0, posture=replace(fast, repeats=period))
    assert short.path.repeats == period
    assert len(short.path.times) < 0.7 * len(whole.path.times)
    for time in np.arange(0.0, 15.5, 0.137):
        one, other = whole.at(time, time), short.at(time, time)
        assert one.posture is not None
        np.testing.assert_allclose(other.posture, one.posture, atol=1e-9)
        for task, same in zip(one.tasks, other.tasks, strict=True):
            np.testing.assert_allclose(same.position, task.position, atol=1e-9)
            np.testing.assert_allclose(same.velocity, task.velocity, atol=1e-7)
    wrong = posture_source(robot, motion, ("elbow",), 16.0, posture=replace(fast, repeats=0.9))
    assert (wrong.path.repeats, len(wrong.path.times)) == (0.0, len(whole.path.times))
