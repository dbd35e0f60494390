"""Loading robots: names, files, locked joints, tools, and what goes wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import ConfigError, MissingExtraError, RobotError, ShapeError, SignalError
from pliant.robot import Robot, Tool
from pliant.robots import CATALOGUE, CatalogueEntry, is_available


def test_own_robots_have_the_published_kinematics(iiwa14: Robot, lwr4: Robot, leg3: Robot) -> None:
    assert (iiwa14.n, lwr4.n, leg3.n) == (7, 7, 3)
    np.testing.assert_allclose(iiwa14.torque_limit, [320, 320, 176, 176, 110, 40, 40])
    np.testing.assert_allclose(lwr4.placement(np.zeros(7), "flange")[0], [0, 0, 0.31 + 0.40 + 0.39 + 0.078], atol=1e-12)
    np.testing.assert_allclose(leg3.placement(np.zeros(3), "foot")[0], [0.05, 0, 0.5 - 0.30 - 0.275], atol=1e-12)
    height = 0.1475 + 0.2125 + 0.228 + 0.192 + 0.2075 + 0.1925 + 0.091 + 0.035
    np.testing.assert_allclose(iiwa14.placement(np.zeros(7), "flange")[0], [0, 0, height], atol=1e-12)


def test_iiwa_carries_its_identified_masses(iiwa14: Robot) -> None:
    masses = [inertia.mass for inertia in list(iiwa14.model.inertias)[1:]]
    np.testing.assert_allclose(masses, [5.289529, 5.688888, 3.461245, 4.122995, 1.563756, 2.457878, 0.265331])


def test_the_elbow_lies_between_upper_and_lower_arm(lwr4: Robot) -> None:
    q = np.array([0.3, 0.7, 0.2, -1.1, 0.5, 0.4, 0.1])
    data = lwr4.model.createData()
    pin.framesForwardKinematics(lwr4.model, data, q)
    at_joint_4 = data.oMi[lwr4.model.getJointId("A4")].translation
    np.testing.assert_allclose(lwr4.placement(q, "elbow")[0], at_joint_4, atol=1e-12)


def test_locking_joints_keeps_the_inertia_behind_them(iiwa14: Robot) -> None:
    angle = 0.4
    locked = iiwa14.with_locked({"A7": angle})
    q = np.array([0.1, 0.5, -0.3, -0.9, 0.2, 0.6])
    whole = np.append(q, angle)
    gravity = pin.computeGeneralizedGravity(iiwa14.model, iiwa14.model.createData(), whole)[:6]
    np.testing.assert_allclose(
        pin.computeGeneralizedGravity(locked.model, locked.model.createData(), q), gravity, atol=1e-10
    )
    np.testing.assert_allclose(locked.placement(q, "flange")[0], iiwa14.placement(whole, "flange")[0], atol=1e-12)


def test_a_tool_adds_its_weight_where_it_is(iiwa14: Robot) -> None:
    tool = Tool(length=0.2, mass=0.4)
    with_tool = iiwa14.with_tool(tool)
    q = np.array(iiwa14.home)
    difference = pin.computeGeneralizedGravity(
        with_tool.model, with_tool.model.createData(), q
    ) - pin.computeGeneralizedGravity(iiwa14.model, iiwa14.model.createData(), q)
    middle = iiwa14.with_frame("middle", "flange", (0.0, 0.0, 0.1))
    J = pin.computeFrameJacobian(
        middle.model, middle.model.createData(), q, middle.frame_id("middle"), pin.LOCAL_WORLD_ALIGNED
    )
    np.testing.assert_allclose(difference, J[:3].T @ [0.0, 0.0, 0.4 * 9.81], atol=1e-9)
    offset = with_tool.placement(q, "tool")[0] - with_tool.placement(q, "flange")[0]
    assert np.linalg.norm(offset) == pytest.approx(0.2)


def test_adding_a_tool_leaves_the_first_robot_alone(iiwa14: Robot) -> None:
    before = iiwa14.model.inertias[7].mass
    iiwa14.with_tool(Tool())
    assert iiwa14.model.inertias[7].mass == before
    assert "tool" not in iiwa14.frame_names


def test_mjcf_is_read(tmp_path: Path) -> None:
    path = tmp_path / "two.xml"
    path.write_text(TWO_LINK_MJCF)
    robot = Robot.load(path)
    assert robot.joint_names == ("shoulder", "elbow")


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("no_such_robot", ["no robot named", "lwr4"]),
        ("lwr5", ["did you mean 'lwr4'"]),
        ("missing.urdf", ["missing.urdf", "does not exist"]),
        (".", ["is a folder"]),
    ],
)
def test_a_robot_that_is_not_there(source: str, words: list[str]) -> None:
    with pytest.raises(RobotError) as caught:
        Robot.load(source)
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize(
    ("content", "word"),
    [
        ("this is not xml", "not XML"),
        ("<scene/>", "root element is <scene>"),
        ('<robot name="x"><link name="a"/></robot>', "no joint that moves"),
        ('<robot name="x"><joint name="j" type="revolute"/></robot>', "has no <link>"),
    ],
)
def test_a_file_that_is_no_robot(tmp_path: Path, content: str, word: str) -> None:
    path = tmp_path / "bad.urdf"
    path.write_text(content)
    with pytest.raises(RobotError, match=word):
        Robot.load(path)


def test_a_continuous_joint_has_no_limits(tmp_path: Path) -> None:
    path = tmp_path / "wheel.urdf"
    path.write_text(CONTINUOUS_URDF)
    robot = Robot.load(path)
    assert robot.model.nq == robot.n  # one angle, not sine and cosine
    assert np.isinf(robot.position_upper).any()


def test_missing_frames_and_joints_list_the_ones_there_are(lwr4: Robot) -> None:
    with pytest.raises(RobotError, match="did you mean 'flange'"):
        lwr4.frame_id("flangee")
    with pytest.raises(RobotError, match="has no joint 'A8'"):
        lwr4.joint_index("A8")
    with pytest.raises(ConfigError, match="no joint 'B1' to lock"):
        lwr4.with_locked({"B1": 0.0})
    with pytest.raises(ConfigError, match="leaves none to move"):
        lwr4.with_locked(dict.fromkeys(lwr4.joint_names, 0.0))
    with pytest.raises(RobotError, match="already has a frame"):
        lwr4.with_frame("flange", "flange")


def test_vectors_are_checked(lwr4: Robot) -> None:
    with pytest.raises(ShapeError, match="q must have 7 entries"):
        lwr4.vector(np.zeros(6), "q")
    with pytest.raises(SignalError, match="finite"):
        lwr4.vector(np.full(7, np.nan), "q")


def test_a_catalogue_robot_whose_data_is_absent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pliant.robots._example_robot_data", lambda: None)
    assert not is_available(CATALOGUE["ur5"])
    with pytest.raises(MissingExtraError, match=r"pip install 'pliant\[robots\]'"):
        Robot.load("ur5")


def test_every_catalogue_entry_says_what_it_is() -> None:
    for name, entry in CATALOGUE.items():
        assert isinstance(entry, CatalogueEntry)
        assert name == entry.name
        assert len(entry.description) > 20


TWO_LINK_MJCF = """
<mujoco model="two">
  <compiler angle="radian"/>
  <worldbody>
    <body name="upper" pos="0 0 1">
      <joint name="shoulder" axis="0 1 0" range="-2 2"/>
      <inertial pos="0 0 -0.2" mass="1.5" diaginertia="0.02 0.02 0.001"/>
      <body name="lower" pos="0 0 -0.4">
        <joint name="elbow" axis="0 1 0" range="-2 2"/>
        <inertial pos="0 0.01 -0.15" mass="0.8" diaginertia="0.01 0.01 0.0005"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""

CONTINUOUS_URDF = """
<robot name="wheel">
  <link name="base"/>
  <link name="rim">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="axle" type="continuous"><parent link="base"/><child link="rim"/><axis xyz="0 0 1"/></joint>
</robot>
"""


def test_joints_can_be_locked_behind_a_tool(iiwa14: Robot) -> None:
    """Every shape, the tool's too, names the frame that carries it; locking looks that frame up."""
    arm = iiwa14.with_tool(Tool())
    assert arm.visual is not None
    for shape in arm.visual.geometryObjects:
        assert shape.parentFrame < arm.model.nframes
    locked = arm.with_locked({"A1": 0.0})
    q = np.linspace(-0.3, 0.4, 6)
    np.testing.assert_allclose(locked.placement(q, "tool")[0], arm.placement([0.0, *q], "tool")[0], atol=1e-12)
