"""Example 03 runs on any arm of the catalogue, and refuses a robot without the frames in one sentence."""

from __future__ import annotations

import re

import pytest

from benchmarks.examples_on_robots import loaded
from pliant.errors import RobotError

main = loaded("03_stack_on_your_urdf").main


@pytest.mark.parametrize("robot", ["panda", "ur5e"])
def test_the_tool_follows_its_circle(robot: str, capsys: pytest.CaptureFixture[str]) -> None:
    main(robot)
    found = re.search(rf"{robot}: tool RMSE x, y, z = \[(.*)\] mm", capsys.readouterr().out)
    assert found
    assert all(float(text) < 6.0 for text in found[1].split(","))  # of a circle of 30 mm


def test_a_robot_without_the_frames_is_refused() -> None:
    with pytest.raises(RobotError, match="robot 'leg3' has no frame 'flange'; valid: "):
        main("leg3")
