"""Robot files, one trait each: MJCF against MuJoCo's own compile, URDF against what it says, or one sentence."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import RobotError
from pliant.mujoco_model import spec_from_robot
from pliant.robot import Robot

INERTIAL = '<inertial pos="0.01 0.02 0.1" mass="{m}" diaginertia="0.02 0.03 0.01"/>'
ARM = """<body name="upper" pos="0 0 0.3" {b1}>{i1}<joint name="one" axis="0 1 0" range="-2 2" {j1}/>
<body name="lower" pos="0.05 0 0.3" {b2}>{i2}<joint name="two" axis="0 0 1" range="-1.5 2.5" {j2}/>
<site name="tip" pos="0 0 0.2"/></body></body>"""
HEAD = '<mujoco model="arm"><compiler angle="radian" {compiler}/>{before}<worldbody>{world}</worldbody>{after}</mujoco>'


def arm(b1: str = "", b2: str = "", j1: str = "", j2: str = "") -> str:
    return ARM.format(b1=b1, b2=b2, j1=j1, j2=j2, i1=INERTIAL.format(m=2.0), i2=INERTIAL.format(m=1.0))


def mjcf(world: str, before: str = "", after: str = "", compiler: str = "") -> str:
    return HEAD.format(world=world, before=before, after=after, compiler=compiler)


LINK = '<body name="b"><joint name="h" axis="1 0 0" range="-1 1"/>' + INERTIAL.format(m=1.0) + "</body>"
MJCF = {
    "plain": mjcf(arm()),
    "ceiling": mjcf(f'<body name="mount" pos="0 0 2" euler="3.14159265 0 0">{arm()}</body>'),
    "offset base": mjcf(f'<body name="mount" pos="0.4 -0.2 0.7" euler="0.2 0.3 -0.4">{arm()}</body>'),
    "moon": mjcf(arm(), before='<option gravity="0.3 0 -1.62"/>'),
    "joint off its body": mjcf(arm(j1='pos="0.02 0.03 -0.05"')),
    "joint off its body by default": mjcf(arm(), before='<default><joint pos="0.02 0 0.04"/></default>'),
    "armature by class": mjcf(
        arm(j2='class="c"'), before='<default><default class="c"><joint armature="0.07"/></default></default>'
    ),
    "two arms": mjcf(arm() + LINK),
    "table first": mjcf('<geom type="box" size="1 1 0.1" pos="0 0 -0.1"/>' + arm()),
    "frame": mjcf(f'<frame pos="0.1 0 0.2" euler="0 0.5 0">{arm()}</frame>'),
    "two joints on a body": mjcf(
        '<body name="b"><joint name="x" axis="1 0 0" range="-1 1"/><joint name="y" axis="0 1 0" range="-1 1"'
        f' pos="0 0 0.1"/>{INERTIAL.format(m=1.5)}</body>'
    ),
    "slide": mjcf(
        '<body name="b"><joint name="s" type="slide" axis="0 0.6 0.8" range="0 1"/>' + arm() + "</body>"
    ).replace('range="0 1"/>', 'range="0 1"/>' + INERTIAL.format(m=3.0)),
    "masses from shapes": mjcf(
        '<body name="b" pos="0 0 0.1"><joint name="h" axis="0 1 0" range="-1 1"/><geom type="capsule"'
        ' fromto="0 0 0 0.1 0 0.4" size="0.04" density="700"/></body>'
    ),
    "turned inertia": mjcf(
        '<body name="b"><joint name="h" axis="0 1 0" range="-1 1"/><inertial pos="0 0.1 0" mass="1"'
        ' quat="0.9 0.1 0.3 0.2" diaginertia="0.02 0.03 0.04"/></body>'
    ),
    "unnamed": mjcf(arm().replace('name="one" ', "").replace('name="lower" ', "")),
}


def load(tmp_path: Path, text: str, ending: str = "xml") -> Robot:
    path = tmp_path / f"robot.{ending}"
    path.write_text(text)
    return Robot.load(path)


def mass_and_bias(robot: Robot, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    data = robot.model.createData()
    upper = np.triu(pin.crba(robot.model, data, q))
    return upper + np.triu(upper, 1).T, np.array(pin.nonLinearEffects(robot.model, data, q, v))


def mujoco_mass_and_bias(model: mujoco.MjModel, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = q, v
    mujoco.mj_forward(model, data)
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    return M, data.qfrc_bias.copy()


@pytest.mark.parametrize("name", MJCF)
def test_an_mjcf_is_the_robot_that_mujoco_reads(name: str, tmp_path: Path) -> None:
    robot = load(tmp_path, MJCF[name])
    truth = mujoco.MjModel.from_xml_string(MJCF[name])
    assert robot.n == truth.nv
    plant = spec_from_robot(robot).compile()
    rng = np.random.default_rng(0)
    for _ in range(5):
        q, v = rng.uniform(-0.7, 0.7, robot.n), rng.normal(size=robot.n)
        M, bias = mujoco_mass_and_bias(truth, q, v)
        for found in (mass_and_bias(robot, q, v), mujoco_mass_and_bias(plant, q, v)):
            np.testing.assert_allclose(found[0], M, atol=1e-9)
            np.testing.assert_allclose(found[1], bias, atol=1e-9)
        data = mujoco.MjData(truth)
        data.qpos[:] = q
        mujoco.mj_kinematics(truth, data)
        for site in range(truth.nsite):
            np.testing.assert_allclose(robot.placement(q, truth.site(site).name)[0], data.site_xpos[site], atol=1e-9)
    np.testing.assert_allclose(robot.armature, truth.dof_armature, atol=1e-12)
    limited = truth.jnt_limited.astype(bool)
    np.testing.assert_allclose(robot.position_upper[limited], truth.jnt_range[limited, 1], atol=1e-12)


def test_keyframes_give_homes_and_actuators_give_limits(tmp_path: Path) -> None:
    after = '<actuator><motor joint="one" ctrlrange="-1 1" gear="40" forcerange="-40 40"/></actuator>'
    after += '<keyframe><key name="home" qpos="0.5 -0.7"/></keyframe>'
    robot = load(tmp_path, mjcf(arm(), after=after))
    np.testing.assert_allclose(robot.home, [0.5, -0.7])
    assert "keyframe" in robot.home_from
    assert robot.torque_limit[0] <= 40.0 * 40.0
    assert np.isfinite(robot.torque_limit[0])
    assert np.isinf(robot.torque_limit[1])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (mjcf(arm().replace('name="one" axis="0 1 0" range="-2 2"', 'name="one" type="ball"')), "'one'"),
        (mjcf(arm(), after='<equality><joint joint1="one" joint2="two"/></equality>'), "two"),
        (mjcf(f'<body name="free"><freejoint name="f"/>{INERTIAL.format(m=1.0)}</body>'), "'f'"),
        ("<mujoco><worldbody/></mujoco>", "joint"),
        ("<mujoco><worldbody><body></worldbody></mujoco>", "robot.xml"),
    ],
)
def test_what_an_mjcf_cannot_be_is_one_sentence(text: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(RobotError, match=says) as caught:
        load(tmp_path, text)
    assert "\n" not in str(caught.value)


def urdf(
    joint: str = '<limit lower="-1" upper="1" effort="10" velocity="2"/>',
    kind: str = "revolute",
    axis: str = "0 1 0",
    mass: str = "1.0",
    inertia: str = 'ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"',
    name: str = "j",
    more: str = "",
) -> str:
    body = f'<inertial><origin xyz="0 0 0.1"/><mass value="{mass}"/><inertia {inertia}/></inertial>'
    return (
        f'<robot name="r"><link name="base"/><link name="arm">{body}</link>'
        f'<joint name="{name}" type="{kind}"><parent link="base"/><child link="arm"/><axis xyz="{axis}"/>'
        f"{joint}</joint>"
        f"{more}</robot>"
    )


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (urdf(axis="0 0 0"), "axis"),
        (urdf(mass="-1"), "mass"),
        (urdf(inertia='ixx="-0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"'), "inertia"),
        (urdf(joint='<limit lower="1" upper="-1" effort="10" velocity="2"/>'), "lower|swap"),
        (urdf(joint='<limit lower="-170" upper="170" effort="10" velocity="2"/>'), "degrees"),
        (urdf(joint='<limit lower="-1" upper="1" velocity="2"/>'), "effort"),
        (urdf(mass="1,5"), "1,5"),
        (urdf(more='<link name="arm"/>'), "arm"),
        (urdf(kind="floating"), "floating"),
        ("", "empty"),
        ("<html></html>", "web page"),
        (urdf(mass="${m}"), "xacro"),
    ],
)
def test_what_a_urdf_cannot_be_is_one_sentence(text: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(RobotError, match=says) as caught:
        load(tmp_path, text, "urdf")
    assert "\n" not in str(caught.value)
    assert "robot.urdf" in str(caught.value)


def test_a_link_and_a_joint_of_one_name_are_told_apart(tmp_path: Path) -> None:
    robot = load(tmp_path, urdf(name="arm"), "urdf")
    assert robot.n == 1
    assert any("arm" in note for note in robot.notes)


def test_the_plant_refuses_what_has_no_mass_by_name(tmp_path: Path) -> None:
    text = urdf().replace(urdf()[urdf().index("<inertial>") : urdf().index("</link><joint")], "")
    robot = load(tmp_path, text, "urdf")
    assert np.isfinite(robot.placement(np.array([0.3]), "arm")[0]).all()
    with pytest.raises(RobotError, match=r"no link of .* has a mass"):
        robot.require_masses()


@pytest.mark.parametrize("name", ["lwr4", "iiwa7", "iiwa14", "panda", "ur5e", "leg3"])
def test_every_own_robot_has_a_home_within_its_limits_and_a_flange(name: str) -> None:
    robot = Robot.load(name)
    assert ((robot.home >= robot.position_lower) & (robot.home <= robot.position_upper)).all()
    assert np.isfinite(robot.torque_limit).all()
    assert not robot.faults
    assert "flange" in robot.frame_names or name == "leg3"
