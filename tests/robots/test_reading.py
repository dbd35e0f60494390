"""What two readers could understand differently, and what only looks like a robot: said, or one sentence."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import RobotError
from pliant.mujoco_model import spec_from_robot
from pliant.robot import Robot
from pliant.robots import locate
from pliant.robots.chain import arm_of
from pliant.robots.home import _inner_range, bent_home
from tests.test_robot_files import MJCF, arm, load, mass_and_bias, mjcf, mujoco_mass_and_bias, urdf

FINGERS = "".join(
    f'<body name="{name}" pos="0 {side} 0.1"><joint name="{name}" type="slide" axis="0 {side * 50} 0" range="0 0.04"/>'
    '<inertial pos="0 0 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/></body>'
    for name, side in (("left", 0.02), ("right", -0.02))
)
HAND = mjcf(arm().replace('<site name="tip"', FINGERS + '<site name="tip"'), after="<equality>{}</equality>")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('<option><flag gravity="disable"/></option>', ""),
        ("", '<actuator><motor joint="one" gear="50" armature="1e-4"/></actuator>'),
    ],
)
def test_gravity_switched_off_and_the_inertia_of_motors_count(before: str, after: str, tmp_path: Path) -> None:
    text = mjcf(arm(), before=before, after=after)
    robot, truth = load(tmp_path, text), mujoco.MjModel.from_xml_string(text)
    assert np.isinf(robot.velocity_limit).all()  # an MJCF has none
    plain = mujoco.MjModel.from_xml_string(MJCF["plain"])
    rng = np.random.default_rng(0)
    q, v = rng.uniform(-0.7, 0.7, 2), rng.normal(size=2)
    wanted = mujoco_mass_and_bias(truth, q, v)
    for found in (mass_and_bias(robot, q, v), mujoco_mass_and_bias(spec_from_robot(robot).compile(), q, v)):
        for ours, theirs in zip(found, wanted, strict=True):
            np.testing.assert_allclose(ours, theirs, atol=1e-9)
    without = mujoco_mass_and_bias(plain, q, v)
    assert max(np.abs(a - b).max() for a, b in zip(wanted, without, strict=True)) > 0.1


@pytest.mark.parametrize(
    ("coupling", "locked"),
    [
        ('<joint joint1="right" joint2="left" polycoef="0.01 1 0 0 0"/>', {"right": 0.01}),
        ('<weld body1="left" body2="right"/>', {"left": 0.01, "right": 0.01}),
        ('<connect body1="left" body2="right" anchor="0 0 0"/>', {"left": 0.01, "right": 0.01}),
    ],
)
def test_a_coupled_finger_is_refused_with_the_lock_that_helps(
    coupling: str, locked: Mapping[str, float], tmp_path: Path
) -> None:
    path = tmp_path / "hand.xml"
    path.write_text(HAND.format(coupling))
    with pytest.raises(RobotError, match="lock") as caught:
        Robot.load(path)
    assert all(name in str(caught.value) for name in locked)
    assert Robot.load(path, locked=locked).n == 4 - len(locked)
    with pytest.raises(RobotError, match=r"left|right"):
        Robot.load(path, locked={"two": 0.0})  # another joint's lock does not help


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (mjcf(arm().replace("0 0 0.3", "0 nan 0.3")), "finite"),
        (mjcf(arm(), after='<keyframe><key qpos="nan 0"/></keyframe>'), "keyframe"),
        (mjcf('<geom type="mesh" mesh="m"/>', before='<asset><mesh name="m" file="no.stl"/></asset>'), "put the file"),
    ],
)
def test_numbers_that_are_none_and_files_that_are_missing(text: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(RobotError, match=says) as caught:
        load(tmp_path, text)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "ending", "says"),
    [
        (mjcf(arm(), compiler='autolimits="true"').replace('angle="radian"', ""), "xml", "narrower than ±4°"),
        (mjcf(arm().replace('range="-2 2"', 'range="-170 170"')), "xml", "more than four turns"),
        (mjcf(arm().replace('pos="0.05 0 0.3"', 'pos="50 0 300"')), "xml", "metres"),
        (urdf(more="").replace("<axis", '<origin rpy="90 0 0"/><axis'), "urdf", "radians"),
        (urdf().replace("<inertial>", '<visual><geometry><cylinder length="1"/></geometry></visual><inertial>'), "urdf",
         "radius 'missing'"),
        (urdf().replace("<inertial>", '<visual><geometry><box size="0 1 1"/></geometry></visual><inertial>'), "urdf",
         "link 'arm': a box with size '0 1 1'"),
    ],
)  # fmt: skip
def test_units_and_shapes_that_look_wrong_are_said(text: str, ending: str, says: str, tmp_path: Path) -> None:
    assert any(says in note for note in load(tmp_path, text, ending).notes)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (urdf(joint='<limit lower="0.5" upper="0.5" effort="1" velocity="1"/>'), "cannot move"),
        (urdf().replace('<axis xyz="0 1 0"/>', "<axis/>"), "without xyz"),
        (urdf().replace(' type="revolute"', ""), "has no type"),
    ],
)
def test_joints_that_cannot_be_meant_are_refused(text: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(RobotError, match=says):
        load(tmp_path, text, "urdf")


def test_a_default_namespace_and_endless_limits_are_read(tmp_path: Path) -> None:
    endless = urdf(joint='<limit lower="-1e30" upper="1e30" effort="10" velocity="2"/>')
    robot = load(tmp_path, endless.replace('name="r"', 'name="r" xmlns="http://www.ros.org"', 1), "urdf")
    assert robot.position_upper.tolist() == [np.inf]


@pytest.mark.parametrize("beyond", [1e-15, 1e-12, 1e-9, 5e-7])
def test_moments_that_rounding_made_impossible_still_compile(beyond: float, tmp_path: Path) -> None:
    largest = 0.02 * (1.0 + beyond)
    text = urdf(inertia=f'ixx="0.01" iyy="0.01" izz="{largest!r}" ixy="0" ixz="0" iyz="0"')
    robot = load(tmp_path, text, "urdf")
    assert not robot.faults
    q, v = np.array([0.3]), np.array([0.5])
    plant = mujoco_mass_and_bias(spec_from_robot(robot).compile(), q, v)
    np.testing.assert_allclose(plant[0], mass_and_bias(robot, q, v)[0], atol=0.02 * beyond + 1e-9)


def test_home_of_the_panda_is_its_ready_pose() -> None:
    """As its maker's software calls it: elbow bent, flange 0.59 m up, 0.31 m in front, pointing down."""
    robot = Robot.load("panda")
    np.testing.assert_allclose(np.degrees(robot.home), [0, -45, 0, -135, 0, 90, 45], atol=1e-9)
    position, rotation = robot.placement(robot.home, "flange")
    np.testing.assert_allclose(position, [0.307, 0.0, 0.590], atol=2e-3)
    np.testing.assert_allclose(rotation[:, 2], [0.0, 0.0, -1.0], atol=1e-9)


@pytest.mark.parametrize("name", ["panda", "ur5e", "lwr4", "iiwa14"])
def test_a_home_that_is_searched_for_is_in_front_and_points_down(name: str) -> None:
    model = Robot.load(name).model
    arm_ = arm_of(model)
    assert arm_ is not None
    q, down = bent_home(model, arm_)
    assert down
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    shoulder, pose = np.array(data.oMi[arm_.joints[1]].translation), data.oMf[arm_.flange]
    np.testing.assert_allclose(pose.translation, shoulder + arm_.reach * np.array([0.5, 0.0, 0.05]), atol=0.01)
    assert pose.rotation[2, 2] < -0.99


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (mjcf(arm(), after='<actuator><motor joint="one" forcelimited="true" forcerange="0 5"/></actuator>'),
         "one cannot push both ways (0 to 5)"),
        (mjcf(arm(), after='<actuator><motor joint="one" gear="0" ctrlrange="-1 1"/></actuator>'), "cannot push both"),
        (mjcf(arm(), after='<actuator><motor site="tip" gear="0 0 1 0 0 0"/></actuator>'), "1 actuators of the file"),
        (mjcf(arm(), before='<option density="1000"/>'), "medium"),
    ],
)  # fmt: skip
def test_what_of_an_mjcf_plays_no_part_is_said(text: str, says: str, tmp_path: Path) -> None:
    robot = load(tmp_path, text)
    assert any(says in note for note in robot.notes)
    assert not any(says in note for note in load(tmp_path, MJCF["plain"]).notes)
    assert np.isinf(robot.torque_limit).all()


def test_an_arm_that_cannot_point_down_is_said_to(tmp_path: Path) -> None:
    """A panda whose wrist hardly bends, so that its flange looks up; and the panda."""
    text = locate("panda").read_text()
    for low, high, down in ((2.9, 3.0, False), (-0.0175, 3.7525, True)):
        path = tmp_path / "arm.urdf"
        path.write_text(
            text.replace('lower="-0.0175" upper="3.7525"', f'lower="{low}" upper="{high}"').replace(
                'lower="-1.7628" upper="1.7628"',
                'lower="-0.1" upper="0.1"' if not down else 'lower="-1.7628" upper="1.7628"',
            )
        )
        robot = Robot.load(path)
        assert any("no pose with the flange down" in note for note in robot.notes) is not down
        assert ("flange down" in robot.home_from) is down


def test_a_searched_home_lies_in_the_inner_part_of_a_range_that_is_not_about_zero() -> None:
    model = Robot.load("lwr4").model.copy()
    lower, upper = np.array(model.lowerPositionLimit), np.array(model.upperPositionLimit)
    lower[3], upper[3] = -2.0, -0.2
    model.lowerPositionLimit, model.upperPositionLimit = lower, upper
    arm_ = arm_of(model)
    assert arm_ is not None
    low, high = _inner_range(model, arm_)
    assert 0.5 * (low[3] + high[3]) == pytest.approx(-1.1)
    assert 0.0 < high[3] - low[3] < 1.8


def test_missing_meshes_are_counted(tmp_path: Path) -> None:
    def visual(name: str) -> str:
        return f'<visual><geometry><mesh filename="{name}"/></geometry></visual>'

    text = urdf().replace("<inertial>", visual("a.stl") + visual("b.stl") + visual("c.stl") + "<inertial>", 1)
    notes = " ".join(load(tmp_path, text, "urdf").notes)
    assert "missing meshes are not drawn: a.stl and 2 more" in notes
