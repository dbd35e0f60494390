"""The serial chain that the compiled kernel makes of a robot: its inertia, frames, and which robots it refuses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from pliant import _mpc
from pliant.errors import RobotError
from pliant.mpc.chain import chain_from_robot
from pliant.mpc.controller import MpcController
from pliant.mpc.defaults import ForceFeedbackMpc
from pliant.robot import Robot
from pliant.robots import CATALOGUE, is_available

from .problems import polishing_arm


def _rod(tmp_path: Path, joints: int) -> Robot:
    """A serial chain of short links."""
    inertial = (
        '<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    links = "".join(f'<link name="l{i}">{inertial if i else ""}</link>' for i in range(joints + 1))
    limit = '<limit lower="-2" upper="2" effort="50" velocity="2"/>'
    for i in range(joints):
        axis = ("0 0 1", "0 1 0")[i % 2]
        ends = f'<parent link="l{i}"/><child link="l{i + 1}"/><origin xyz="0 0 0.1"/><axis xyz="{axis}"/>{limit}'
        links += f'<joint name="j{i}" type="revolute">{ends}</joint>'
    path = tmp_path / "rod.urdf"
    path.write_text(f'<robot name="rod">{links}</robot>')
    return Robot.load(path)


def test_the_kernel_takes_as_many_joints_as_it_says_and_no_more(tmp_path: Path) -> None:
    most = _mpc.MAX_JOINTS
    assert chain_from_robot(_rod(tmp_path, most), f"l{most}") is not None
    with pytest.raises(RobotError, match=f"takes 1 to {most} joints, robot 'rod' has {most + 1}"):
        chain_from_robot(_rod(tmp_path, most + 1), f"l{most + 1}")


@pytest.mark.parametrize("name", ["iiwa14", "lwr4", "leg3", "ur5"])
def test_chain_has_the_robots_inertia_and_frames(name: str) -> None:
    if not is_available(CATALOGUE[name]):
        pytest.skip(f"the files of {name} are not installed")
    robot = Robot.load(name)
    frame = next(frame.name for frame in reversed(robot.model.frames) if frame.parentJoint == robot.n)
    chain = chain_from_robot(robot, frame)
    q = np.array(pin.integrate(robot.model, robot.home, np.linspace(-0.4, 0.5, robot.n)))
    upper = np.triu(pin.crba(robot.model, robot.model.createData(), q))
    np.testing.assert_allclose(chain.mass_matrix(q), upper + np.triu(upper, 1).T, atol=1e-12)
    for placed, expected in zip(chain.tool_placement(q), reversed(robot.placement(q, frame)), strict=True):
        np.testing.assert_allclose(placed, expected, atol=1e-12)


def test_a_branched_robot_is_sent_to_the_bridge(tmp_path: Any) -> None:
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    links = "".join(
        f'<link name="{n}"><inertial><mass value="1"/>{inertia}</inertial></link>'
        for n in ("base", "arm", "left", "right")
    )
    joints = "".join(
        f'<joint name="j_{child}" type="revolute"><parent link="{parent}"/><child link="{child}"/><axis xyz="0 1 0"/>'
        '<limit lower="-1" upper="1" effort="10" velocity="1"/></joint>'
        for parent, child in (("base", "arm"), ("arm", "left"), ("arm", "right"))
    )
    file = tmp_path / "fork.urdf"
    file.write_text(f'<robot name="fork">{links}{joints}</robot>')
    with pytest.raises(RobotError, match=r"branches.*'j_right' follows 'j_arm'.*crocoddyl bridge"):
        chain_from_robot(Robot.load(file), "right")


def test_too_many_joints_and_wrong_frames_are_named(iiwa14: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(RobotError, match=r"no frame 'tol'.*did you mean 'tool'"):
        MpcController(polishing_arm(), ForceFeedbackMpc(frame="tol"))
    elbow = next(frame.name for frame in iiwa14.model.frames if frame.parentJoint == 3)
    with pytest.raises(RobotError, match="on the last link"):
        chain_from_robot(iiwa14, elbow)
    monkeypatch.setattr(_mpc, "MAX_JOINTS", 6)
    with pytest.raises(RobotError, match=r"takes 1 to 6 joints, robot 'iiwa14' has 7.*bridge"):
        chain_from_robot(iiwa14, "flange")
