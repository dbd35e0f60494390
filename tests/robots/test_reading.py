"""What two readers could understand differently, and what only looks like a robot: said, or one sentence."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import mujoco
import numpy as np
import pytest

from pliant.errors import RobotError
from pliant.mujoco_model import spec_from_robot
from pliant.robot import Robot
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
