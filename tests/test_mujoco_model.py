"""pinocchio and MuJoCo hold the same robot: mass matrix, bias and frame Jacobians to 1e-9."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from pliant.mujoco_model import spec_from_robot
from pliant.robot import Robot, Tool
from pliant.robots import CATALOGUE, is_available, locate
from tests.test_robot import TWO_LINK_MJCF

TOLERANCE = 1e-9


def disagreement(robot: Robot, model: mujoco.MjModel, rng: np.random.Generator, samples: int = 10) -> float:
    """Largest difference of M(q), bias and the last frame's Jacobian over random states."""
    data, mj = robot.model.createData(), mujoco.MjData(model)
    frame = robot.frame_names[-1]
    has_site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, frame) >= 0
    worst = 0.0
    for _ in range(samples):
        q, v = rng.uniform(-1.5, 1.5, robot.n), rng.uniform(-2.0, 2.0, robot.n)
        mj.qpos[:], mj.qvel[:] = q, v
        mujoco.mj_forward(model, mj)
        M = np.zeros((robot.n, robot.n))
        mujoco.mj_fullM(model, mj, M)
        upper = np.triu(pin.crba(robot.model, data, q))
        worst = max(worst, np.abs(M - (upper + np.triu(upper, 1).T)).max())
        worst = max(worst, np.abs(mj.qfrc_bias - pin.nonLinearEffects(robot.model, data, q, v)).max())
        if has_site:
            J = pin.computeFrameJacobian(robot.model, data, q, robot.frame_id(frame), pin.LOCAL_WORLD_ALIGNED)
            linear, angular = np.zeros((3, robot.n)), np.zeros((3, robot.n))
            mujoco.mj_jacSite(model, mj, linear, angular, model.site(frame).id)
            worst = max(worst, np.abs(np.vstack([linear, angular]) - J.reshape(6, -1)).max())
    return worst


def one_leg_of_anymal() -> Robot:
    whole = Robot.load("anymal")
    return whole.with_locked({name: 0.1 for name in whole.joint_names if not name.startswith("LF_")})


@pytest.mark.parametrize("name", sorted(CATALOGUE))
def test_catalogue_robots_agree(name: str) -> None:
    if not is_available(CATALOGUE[name]):
        pytest.skip("example-robot-data is not installed")
    robot = Robot.load(name)
    model = spec_from_robot(robot).compile()
    assert disagreement(robot, model, np.random.default_rng(1)) < TOLERANCE
    assert tuple(model.joint(i).name for i in range(model.njnt)) == robot.joint_names


def test_locked_joints_tools_and_legs_agree() -> None:
    rng = np.random.default_rng(2)
    robots = [Robot.load("iiwa14", locked={"A7": 0.3}, tool=Tool())]
    if is_available(CATALOGUE["anymal"]):
        robots.append(one_leg_of_anymal())
    for robot in robots:
        assert disagreement(robot, spec_from_robot(robot).compile(), rng) < TOLERANCE


@pytest.mark.parametrize("seed", range(5))
def test_rods_and_point_masses_agree(leg3: Robot, seed: int) -> None:
    """Bodies whose smaller principal moments add up to the third but for rounding, turned at random."""
    rng = np.random.default_rng(seed)
    model = leg3.model.copy()
    for index in range(1, model.njoints):
        moments = np.diag([0.0, *[rng.uniform(0.01, 0.1)] * 2]) if index % 2 else np.diag([0.01, 0.02, 0.03])
        R = np.array(pin.exp3(rng.uniform(-2.0, 2.0, 3)))
        model.inertias[index] = pin.Inertia(1.0, rng.uniform(-0.1, 0.1, 3), R @ moments @ R.T)
    robot = replace(leg3, model=model)
    assert disagreement(robot, spec_from_robot(robot).compile(), rng) < TOLERANCE


def test_a_wrong_inertia_would_be_noticed(lwr4: Robot) -> None:
    """Baseline: the comparison sees one gram on one link."""
    spec = spec_from_robot(lwr4)
    spec.body("A4").mass += 1e-3
    assert disagreement(lwr4, spec.compile(), np.random.default_rng(3)) > 1e-5


@pytest.mark.parametrize("name", ["lwr4", "iiwa14", "leg3"])
def test_mujoco_reads_the_same_urdf_the_same_way(name: str) -> None:
    """MuJoCo's own URDF reader, which shares nothing with pinocchio's, on the file that both read."""
    robot = Robot.load(name)
    spec = mujoco.MjSpec.from_file(str(locate(name)))
    spec.compiler.fusestatic = False
    for joint in spec.joints:
        joint.armature = robot.armature[robot.joint_index(joint.name)]
    assert disagreement(robot, spec.compile(), np.random.default_rng(4)) < 1e-7  # its inertia eigenvalues stop early


def test_an_mjcf_agrees_with_mujoco_itself(tmp_path: Path) -> None:
    path = tmp_path / "two.xml"
    path.write_text(TWO_LINK_MJCF)
    robot = Robot.load(path)
    rng = np.random.default_rng(5)
    assert disagreement(robot, mujoco.MjModel.from_xml_path(str(path)), rng) < TOLERANCE
    assert disagreement(robot, spec_from_robot(robot).compile(), rng) < TOLERANCE


def test_a_robot_without_shapes_is_drawn_as_sticks(lwr4: Robot) -> None:
    bare = Robot(lwr4.name, lwr4.model, None, lwr4.home)
    assert spec_from_robot(bare).compile().ngeom >= 5
