"""Paths of the stack study on robots of other sizes: as printed for its own arm, scaled and placed for others."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pliant.configuration import merged, parse_assignments
from pliant.errors import PliantError
from pliant.references.postures.posture import UnreachableError
from pliant.robot import Robot
from pliant.robots.description import set_limits
from pliant.studies.polishing import STUDY as POLISHING
from pliant.studies.stack import STUDY as STACK
from pliant.studies.stack.build import build
from pliant.studies.stack.config import StackPath as ToolPath
from pliant.studies.stack.placement import motion, placed
from pliant.studies.task.listed import robot_of_list

FRAMES = ("flange", "elbow")
SHORT = 0.4  # s


def held_in_front(robot: Robot) -> Robot:
    held = replace(robot, model=robot.model.copy())
    for joint in (0, 2):
        set_limits(held.model, joint, -0.2, 0.2)
    return held


def test_the_papers_arm_gets_the_printed_numbers(lwr4: Robot) -> None:
    place, _ = placed(lwr4, ToolPath(kind="hold"), FRAMES, SHORT)
    assert place.scale == 1.0
    assert place.told == ""
    assert place.centre.tolist() == [0.0, -0.6, 0.5]
    figure = motion(ToolPath(ramp=0.0), "flange", place)
    assert figure.position.at(0.0).value.tolist() == [0.0, -0.6, 0.5]
    np.testing.assert_allclose(figure.position.at(1.0).value, [0.0, -0.6, 0.7], atol=1e-12)


def test_a_longer_arm_gets_a_larger_path_from_its_own_shoulder(iiwa14: Robot) -> None:
    place, source = placed(iiwa14, ToolPath(), FRAMES, SHORT)
    assert 1.1 < place.scale < 1.2
    shoulder = np.array([0.0, -0.01, 0.36])
    np.testing.assert_allclose(place.centre - shoulder, place.scale * np.array([0.0, -0.6, 0.19]), atol=1e-6)
    assert "scaled by 1.133" in place.told
    assert iiwa14.placement(source.start, "flange")[0] == pytest.approx(place.centre, abs=1e-3)


def test_an_arm_that_cannot_reach_in_front_gets_the_path_at_its_home(iiwa14: Robot) -> None:
    """An arm whose first and third joint turn by ±0.2 rad only: the paper's path lies at its side."""
    turned = held_in_front(iiwa14)
    place, source = placed(turned, ToolPath(period=8.0), FRAMES, SHORT)
    np.testing.assert_allclose(place.centre, turned.placement(turned.home, "flange")[0], atol=1e-9)
    np.testing.assert_allclose(source.start, turned.home, atol=0.05)
    np.testing.assert_allclose(place.axes.T @ place.axes, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(place.axes[:, 1], -place.rotation[:, 2], atol=1e-12)
    assert np.linalg.det(place.axes) == pytest.approx(1.0)
    assert "home" in place.told


def test_an_arm_of_the_papers_size_that_cannot_reach_is_refused(lwr4: Robot) -> None:
    """The study's own numbers never come from a smaller path."""
    with pytest.raises(UnreachableError, match="cannot reach"):
        placed(held_in_front(lwr4), ToolPath(), FRAMES, SHORT)


@pytest.mark.parametrize(("robot", "says"), [("leg3", "cannot follow|no frame"), (None, "forks at its base")])
def test_what_is_no_arm_is_refused_in_a_sentence(robot: str | None, says: str, tmp_path: Path) -> None:
    if robot is None:
        path = tmp_path / "fork.xml"
        branch = '<body name="{0}"><joint name="{0}" axis="0 1 0"/><geom size="0.1"/></body>'
        bodies = branch.format("a") + branch.format("b")
        path.write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
        loaded = Robot.load(path)
    else:
        loaded = Robot.load(robot)
    with pytest.raises(PliantError, match=says) as caught:
        placed(loaded, ToolPath(), FRAMES, SHORT)
    assert "\n" not in str(caught.value)


def test_the_wall_stands_across_the_placed_path() -> None:
    config = STACK.case("figure8-wall").model_copy(update={"robot": "iiwa14", "duration": SHORT})
    experiment = build(config)
    assert any("scaled by" in note for note in experiment.robot.notes)
    (wall,) = experiment.plant.scene.things  # type: ignore[attr-defined]
    np.testing.assert_allclose(wall.normal, [-1.0, 0.0, 0.0])
    assert wall.point[0] == pytest.approx(1.133158 * 0.07 + 0.01, abs=1e-6)


def test_locked_joints_are_replaced_as_a_whole_or_emptied() -> None:
    config = POLISHING.case("ideal")
    assert config.locked is None
    assert merged(config, parse_assignments(["locked={}"])).locked == {}
    assert merged(config, parse_assignments(["locked={A5=0.1}"])).locked == {"A5": 0.1}
    assert merged(config, parse_assignments(["locked=none"])).locked is None
    nested = merged(
        STACK.case("figure8-wall"), parse_assignments(["wall.x=0.05", "control.tasks.ee.translation.range=0.05"])
    )
    assert nested.wall is not None
    assert nested.wall.stiffness == 1e4  # the rest of a table stays
    with pytest.raises(PliantError, match=r"no joint 'A7' to lock.*locked=\{\} locks none"):
        robot_of_list(merged(config, {"robot": "panda", "locked": {"A7": 0.0}}).as_task())


@pytest.mark.parametrize(("robot", "joints"), [("iiwa14", 6), ("iiwa7", 7), ("panda", 7), ("lwr4", 7), ("ur5e", 6)])
def test_only_the_robot_of_the_paper_has_a_joint_locked(robot: str, joints: int) -> None:
    config = merged(POLISHING.case("ideal"), {"robot": robot})
    assert robot_of_list(config.as_task()).n == joints
    assert robot_of_list(merged(config, {"locked": {}}).as_task()).n >= joints
