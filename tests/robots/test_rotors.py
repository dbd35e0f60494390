"""The motors' inertia: where it comes from, that both models have it, and what is said where it is missing."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.registry import get_study
from pliant.mujoco_model import spec_from_robot
from pliant.robot import Robot
from pliant.robots.known_rotors import IDENTIFIED_FR3, PER_ROOT_TORQUE, RULE
from tests.test_robot_files import arm, load, mjcf, urdf

LIGHT = 'ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"'


def test_the_rule_gives_the_drives_from_which_it_was_made() -> None:
    for torque, identified in zip((87.0, 12.0), (IDENTIFIED_FR3[0], IDENTIFIED_FR3[-1]), strict=True):
        assert PER_ROOT_TORQUE * np.sqrt(torque) == pytest.approx(identified, rel=0.02)
    assert f"{PER_ROOT_TORQUE:g}" in RULE
    assert PER_ROOT_TORQUE * 12.0 / np.sqrt(12.0) != pytest.approx(IDENTIFIED_FR3[0], rel=0.5)


@pytest.mark.parametrize("name", ["iiwa7", "iiwa14", "panda", "ur5e", "lwr4"])
def test_arms_of_the_catalogue_have_rotors_in_both_models(name: str) -> None:
    robot = Robot.load(name)
    assert (robot.armature > 0.04).all()
    np.testing.assert_allclose(spec_from_robot(robot).compile().dof_armature, robot.armature, rtol=1e-12)
    assert robot.rotors_from.startswith("catalogue: ")
    assert not any("little inertia" in note for note in robot.notes)
    without = Robot.load(name, rotor_inertia=0.0)
    assert not without.armature.any()
    assert without.rotors_from == "argument"


def test_joints_that_are_locked_take_their_rotors_along() -> None:
    whole = Robot.load("iiwa14", rotor_inertia=(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0))
    assert Robot.load("iiwa14", rotor_inertia=(1, 2, 3, 4, 5, 6, 7), locked={"A3": 0.0}).armature.tolist() == [
        value for value in whole.armature if value != 3.0
    ]


def test_a_joint_that_slides_has_no_assumed_rotor(tmp_path: Path) -> None:
    for axis in ("0 1 0", "0 0.6 0.8"):
        path = tmp_path / "rail.urdf"
        path.write_text(urdf(kind="prismatic", axis=axis))
        assert Robot.load(path, rotor_inertia="assumed").armature.tolist() == [0.0]
        path.write_text(urdf(axis=axis))
        assert Robot.load(path, rotor_inertia="assumed").armature[0] == pytest.approx(PER_ROOT_TORQUE * np.sqrt(10.0))


@pytest.mark.parametrize(
    ("given", "says"), [(-0.1, "negative"), ((0.1, 0.2), "one number or 1"), ("guessed", "assumed"), (np.nan, "kg m²")]
)
def test_rotors_that_cannot_be_are_refused(given: object, says: str, tmp_path: Path) -> None:
    path = tmp_path / "one.urdf"
    path.write_text(urdf())
    with pytest.raises(ConfigError, match=says):
        Robot.load(path, rotor_inertia=given)  # type: ignore[arg-type]


def test_a_rule_of_torque_limits_needs_them(tmp_path: Path) -> None:
    path = tmp_path / "free.xml"
    path.write_text(mjcf(arm()))
    with pytest.raises(ConfigError, match="joint 'one' has none"):
        Robot.load(path, rotor_inertia="assumed")


def test_a_wrist_without_rotors_is_said_with_the_stiffness_that_it_bears(tmp_path: Path) -> None:
    light = load(tmp_path, urdf(inertia=LIGHT, axis="0 0 1"), "urdf")
    (note,) = [note for note in light.notes if "little inertia" in note]
    bound = float(re.findall(r"at most ([\d.e-]+) N·m/rad", note)[0])
    assert grows(1e-4, 1.15 * bound, 7e-3)
    assert not grows(1e-4, 0.85 * bound, 7e-3)
    path = tmp_path / "robot.urdf"
    assert not any("little inertia" in note for note in Robot.load(path, rotor_inertia=0.05).notes)
    assert not any("little inertia" in note for note in load(tmp_path, urdf(), "urdf").notes)


def grows(inertia: float, stiffness: float, late: float) -> bool:
    """Whether a critically damped spring that acts `late` shakes an inertia more and more."""
    step, damping = 2e-5, 2.0 * np.sqrt(stiffness * inertia)
    queue, q, v, path = [0.0] * round(late / step), 1.0, 0.0, list[float]()
    for tick in range(round(200 * late / step)):
        torque = queue[tick % len(queue)]
        queue[tick % len(queue)] = -stiffness * q - damping * v
        v += step * torque / inertia
        q += step * v
        path.append(abs(q))
    half = len(path) // 2
    return max(path[half:]) > max(path[:half])


def test_the_polishing_study_has_the_arm_of_its_paper_and_others_have_their_rotors() -> None:
    study = get_study("polishing")
    case = study.case("ideal")
    assert not study.build(case).robot.armature.any()
    assert study.build(merged(case, {"rotor_inertia": 0.1})).robot.armature.tolist() == [0.1] * 6
    placed = {"robot": "panda", "table": {"x": 0.5}}
    assert (study.build(merged(case, placed)).robot.armature > 0.0).all()
