"""The planner as a source: starts where the robot is, follows targets that jump, turns with them."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from pliant.errors import ConfigError, SignalError
from pliant.references.planners.attractor_planner import AttractorPlanner
from pliant.references.planners.harmonic_attractor import AttractorSettings
from pliant.references.planners.harmonic_planner import HarmonicPlanner, PlannerLimits
from pliant.references.planners.superposition import MotionLimits
from pliant.references.planners.workspace import Workspace, workspace_of
from pliant.references.schedule import LatestReference, Schedule
from pliant.robot import Robot
from pliant.signals import Estimate, Reference, TaskReference
from pliant.spatial import exp3, log3

H = 1e-3
FAST = PlannerLimits(MotionLimits(2.0, 20.0))


def estimate(robot: Robot, time: float) -> Estimate:
    zero = np.zeros(robot.n)
    return Estimate(time, robot.home, zero, zero, zero)


def goal(*position: float, rotation=None, frame: str = "flange") -> Reference:
    return Reference(0.0, (TaskReference(frame, np.array(position), rotation),))


def play(robot: Robot, source, seconds: float, period: float = H):
    state = source.init(estimate(robot, 0.0))
    rows = []
    for tick in range(round(seconds / period)):
        reference, state = source.step(estimate(robot, tick * period), state)
        rows.append(reference.tasks[0])
    return rows


def test_starts_where_the_robot_is_and_rests_on_the_target(lwr4: Robot) -> None:
    rows = play(lwr4, HarmonicPlanner(LatestReference(goal(0.3, -0.4, 0.5)), lwr4.placement), 7.0)
    start = lwr4.placement(lwr4.home, "flange")[0]
    np.testing.assert_allclose(rows[0].position, start, atol=1e-12)
    assert tuple(rows[-1].position) == (0.3, -0.4, 0.5)
    assert not rows[-1].velocity.any()
    assert rows[-1].rotation is None


def test_twist_and_its_rate_belong_to_the_pose(lwr4: Robot) -> None:
    turned = exp3([0.4, -0.9, 1.1]) @ lwr4.placement(lwr4.home, "flange")[1]
    rows = play(
        lwr4, HarmonicPlanner(LatestReference(goal(0.3, -0.4, 0.5, rotation=turned)), lwr4.placement), 7.0, 2e-3
    )
    for low, mid, high in zip(rows[100:600:31], rows[101:601:31], rows[102:602:31], strict=True):
        linear = (high.position - low.position) / 4e-3
        angular = log3(high.rotation @ low.rotation.T) / 4e-3
        np.testing.assert_allclose(mid.velocity, [*linear, *angular], atol=1e-4)
        np.testing.assert_allclose(mid.acceleration, (high.velocity - low.velocity) / 4e-3, atol=1e-3)
    assert np.linalg.norm(log3(rows[-1].rotation @ turned.T)) < 1e-9


def test_position_and_orientation_arrive_together(lwr4: Robot) -> None:
    position, R = lwr4.placement(lwr4.home, "flange")
    target = goal(*(position + np.array([0.02, 0, 0])), rotation=exp3([1.5, 0, 0]) @ R)
    rows = play(lwr4, HarmonicPlanner(LatestReference(target), lwr4.placement), 4.0)
    moving = [i for i, row in enumerate(rows) if np.linalg.norm(row.velocity[:3]) > 1e-6]
    turning = [i for i, row in enumerate(rows) if np.linalg.norm(row.velocity[3:]) > 1e-6]
    assert abs(moving[-1] - turning[-1]) <= 2


def test_schedule_of_targets_with_turns_beyond_pi(lwr4: Robot) -> None:
    R = lwr4.placement(lwr4.home, "flange")[1]
    turns = [exp3([0, 0, a]) @ R for a in (1.2, 2.6, 4.0)]
    entries = [(0.8 * i, goal(0.3, -0.4, 0.5, rotation=turn)) for i, turn in enumerate(turns)]
    rows = play(lwr4, HarmonicPlanner(Schedule(entries), lwr4.placement), 8.0)
    assert np.linalg.norm(log3(rows[-1].rotation @ turns[-1].T)) < 1e-6
    steps = [np.linalg.norm(log3(b.rotation @ a.rotation.T)) for a, b in itertools.pairwise(rows)]
    assert max(steps) < 1.05 * 1.0 * H  # the angular speed limit


def test_moving_target_keeps_the_limits_and_few_pieces(lwr4: Robot) -> None:
    """A slider that is dragged: a new target at every tick."""
    box = LatestReference(goal(0.3, -0.4, 0.5))
    limits = PlannerLimits(MotionLimits(0.3, 3.0))
    source = HarmonicPlanner(box, lwr4.placement, limits)
    state = source.init(estimate(lwr4, 0.0))
    for tick in range(1500):
        box.put(goal(0.3 + 0.1 * np.sin(0.004 * tick), -0.4, 0.5))
        reference, state = source.step(estimate(lwr4, tick * H), state)
        assert np.linalg.norm(reference.tasks[0].velocity[:3]) <= 0.3 * 1.01
    assert len(state.frames["flange"].linear.pieces) < 100


def test_bad_input_is_named(lwr4: Robot) -> None:
    with pytest.raises(SignalError, match="not finite"):
        play(lwr4, HarmonicPlanner(LatestReference(goal(0.3, np.nan, 0.5)), lwr4.placement), 0.01)
    with pytest.raises(ConfigError, match="speed limit"):
        MotionLimits(0.0, 1.0)
    with pytest.raises(ConfigError, match="increasing times"):
        Schedule([(1.0, goal(0, 0, 0)), (1.0, goal(0, 0, 0))])


def test_attractor_planner_goes_to_a_single_target(lwr4: Robot) -> None:
    start = lwr4.placement(lwr4.home, "flange")[0]
    target = start + np.array([-0.1, 0.05, 0.1])
    rows = play(lwr4, AttractorPlanner(LatestReference(goal(*target)), lwr4.placement), 3.0)
    np.testing.assert_allclose(rows[0].position, start, atol=1e-6)
    np.testing.assert_allclose(rows[-1].position, target, atol=2e-3)
    printed = AttractorPlanner(LatestReference(goal(*target)), lwr4.placement, AttractorSettings(printed=True))
    assert np.linalg.norm(play(lwr4, printed, 3.0)[-1].position - target) > 0.02  # baseline


def test_target_outside_the_workspace_is_brought_back_and_reported(lwr4: Robot) -> None:
    workspace = workspace_of(lwr4, "flange")
    planner = HarmonicPlanner(LatestReference(goal(3.0, 0.0, 0.31)), lwr4.placement, FAST, {"flange": workspace})
    state = planner.init(estimate(lwr4, 0.0))
    for tick in range(8000):
        reference, state = planner.step(estimate(lwr4, tick * H), state)
    reached = reference.tasks[0].position
    assert np.linalg.norm(reached - workspace.centre) == pytest.approx(workspace.radius)
    np.testing.assert_allclose(reference.diagnostics["planner/flange/clamped"], (3.0, 0.0, 0.31) - reached)


def test_workspace_holds_every_reachable_position(lwr4: Robot) -> None:
    workspace = workspace_of(lwr4, "flange")
    random = np.random.default_rng(0)
    angles = random.uniform(lwr4.position_lower, lwr4.position_upper, (300, lwr4.n))
    farthest = max(np.linalg.norm(lwr4.placement(q, "flange")[0] - workspace.centre) for q in angles)
    assert 0.7 * workspace.radius < farthest <= workspace.radius
    stretched = lwr4.placement(np.zeros(lwr4.n), "flange")[0]
    assert np.linalg.norm(stretched - workspace.centre) == pytest.approx(workspace.radius)
    with pytest.raises(ConfigError, match="radius"):
        Workspace(np.zeros(3), 0.0)
