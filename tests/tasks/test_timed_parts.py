"""What a timed list is made of: start, weights, preset, tool, imperfections, pushes, checks, and the stop by speed."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.pushes import pushes_of
from pliant.mpc.config import MpcConfig
from pliant.robot import Robot
from pliant.simulation import Imperfections, MujocoPlant
from pliant.studies.task.build_list import listed
from pliant.studies.task.check import checked_list
from pliant.studies.task.start import start_of
from pliant.studies.task.study import study_of
from pliant.studies.task.world import imperfections_of
from pliant.tasks.parts import Pose, ToolConfig
from tests.tasks.timed_lists import FILE


def test_a_start_is_a_pose_that_the_moved_frame_takes() -> None:
    robot = listed(study_of(FILE).case(FILE)).robot
    pose = Pose(xyz=(0.6, 0.1, 0.2), rpy=(180.0, 0.0, 180.0))
    q = start_of(robot, "tool", pose)
    place, rotation = robot.placement(q, "tool")
    np.testing.assert_allclose(place, pose.xyz, atol=1e-3)
    np.testing.assert_allclose(rotation, pose.rotation, atol=1e-2)
    np.testing.assert_array_equal(start_of(robot, "tool", None), robot.home)
    np.testing.assert_allclose(start_of(robot, "tool", tuple(np.degrees(q))), q)
    with pytest.raises(ConfigError, match=r"cannot start with frame 'tool' at \[3.0, 0.0, 0.2\] m.*it misses by \d+"):
        start_of(robot, "tool", Pose(xyz=(3.0, 0.0, 0.2)))


def test_a_phase_has_the_weights_of_the_one_that_it_is_like() -> None:
    study = study_of(FILE)
    weights = listed(study.case("stop")).parameters
    assert isinstance(weights, MpcConfig)
    assert weights.phases["stop"] == weights.phases["circle"]
    alone = listed(merged(study.case("stop"), {"phase": {"stop": {"like": None}}})).parameters
    assert isinstance(alone, MpcConfig)
    assert alone.phases["stop"] != alone.phases["circle"]


def test_a_preset_is_what_control_changes() -> None:
    case = study_of(FILE).case(FILE)
    weights = {name: listed(merged(case, {"preset": name})).parameters for name in ("tuned", "perfect", "paper", None)}
    assert weights[None] == weights["tuned"]  # readings are late
    prompt = merged(case, {"preset": None, "timing": {"sensing_delay": 0.0}})
    assert listed(prompt).parameters == weights["perfect"]
    assert len({one.model_dump_json() for one in weights.values()}) == 3


def test_a_shaft_carries_a_ball() -> None:
    plain, thick = ToolConfig(radius=0.015).tool(), ToolConfig(radius=0.015, shaft=0.02).tool()
    assert (plain.reach, thick.reach) == (0.015, 0.015)
    assert thick.inertia.inertia[2, 2] == pytest.approx(0.5 * thick.mass * 0.02**2)
    assert plain.inertia.inertia[2, 2] == pytest.approx(0.5 * plain.mass * 0.015**2)
    robot = Robot.load("iiwa14", tool=thick).touching_with(thick)
    assert robot.contact_radius["tool"] == 0.015
    with pytest.raises(ValueError, match=r"tool\.shaft carries a ball.*got 'cylinder'"):
        ToolConfig(shape="cylinder", shaft=0.02)


def test_imperfections_change_a_named_set() -> None:
    case = study_of(FILE).case(FILE)
    changed = merged(case, {"truth": {"imperfections": {"ripple": {"amplitude": 5.0}}}})
    p3 = Imperfections.p3(computation_delay=0.0)
    assert imperfections_of(case) == p3
    assert imperfections_of(changed) == merged(p3, {"ripple": {"amplitude": 5.0}})
    with pytest.raises(ConfigError, match=r"imperfections\.base: valid: 'none', 'p3'.*got 'p4'"):
        imperfections_of(merged(case, {"truth": {"imperfections": {"base": "p4"}}}))


def test_level_pushes_are_horizontal_in_any_direction() -> None:
    case = study_of(FILE).case("fast-pushed")
    pushes = [push for seed in range(5) for push in pushes_of(case.disturbance, seed, 10.0)]
    forces = np.array([push.force for push in pushes])
    assert [push.start for push in pushes[:2]] == [4.0, pytest.approx(5.3)]
    np.testing.assert_allclose(np.linalg.norm(forces, axis=1), 20.0)
    np.testing.assert_array_equal(forces[:, 2], 0.0)
    assert (forces[:, :2].min(axis=0) < -10.0).all()
    assert (forces[:, :2].max(axis=0) > 10.0).all()
    slanted = merged(case, {"disturbance": [{"push": 20.0, "start": 4.0}]})
    assert pushes_of(slanted.disturbance, slanted.seed, 10.0)[0].force[2] != 0.0


def test_a_timed_list_is_checked_along_its_whole_way() -> None:
    case = study_of(FILE).case(FILE)
    assert checked_list(case, 0).reachable
    far = merged(case, {"phase": {"circle": {"motion": {"size": (0.6, 0.0)}}}})
    assert not checked_list(far, 0).reachable


def test_a_timed_run_stops_at_twice_the_speed_limits() -> None:
    study = study_of(FILE)
    plant = study.build(merged(study.case("ideal"), {})).plant
    assert isinstance(plant, MujocoPlant)
    assert plant.speed_stop == 2.0
