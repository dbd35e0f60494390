"""Joint stops: stiffness in N·m/rad, at most 1° beyond the limit under the whole torque, no energy out of a stop."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from benchmarks.joint_stops import excess
from pliant.errors import ConfigError
from pliant.robot import Robot
from pliant.robots import CATALOGUE, is_available
from pliant.signals import Command
from pliant.simulation import JointEffects, JointStops, MujocoPlant

ROBOTS = [name for name, entry in CATALOGUE.items() if is_available(entry)]


@pytest.mark.parametrize("name", ROBOTS)
def test_no_joint_of_the_catalogue_stands_a_degree_beyond_its_limit(name: str) -> None:
    robot = replace(Robot.load(name), visual=None)
    plant = MujocoPlant(robot, joints=JointEffects(compensation="gravity"))
    for joint in range(robot.n):
        lower, upper = float(robot.position_lower[joint]), float(robot.position_upper[joint])
        if not (np.isfinite(upper - lower) and 0.0 < upper - lower < 1e3):
            continue
        limit = float(robot.torque_limit[joint])
        limit = limit if np.isfinite(limit) else 100.0  # N·m, where the file gives none
        for side, at in ((-1, lower), (1, upper))[: 2 if robot.n < 10 else 1]:
            beyond = excess(plant, joint, side * limit, 0.1, at)[-20:]
            assert 0.0 < beyond.max() < np.deg2rad(1.0), (name, robot.joint_names[joint], side)


def test_the_default_stops_of_the_engine_do_not_hold() -> None:
    """Baseline: MuJoCo's own limits let a wrist without motors turn tens of degrees beyond its stop."""
    iiwa14 = Robot.load("iiwa14", rotor_inertia=0.0)
    plant = MujocoPlant(iiwa14, joints=JointEffects(compensation="gravity"))
    plant.model.jnt_solref[:] = [0.02, 1.0]
    plant.model.jnt_solimp[:] = [0.9, 0.95, 1e-3, 0.5, 2.0]
    assert excess(plant, 6, 40.0, 0.3, float(iiwa14.position_upper[6]))[-1] > np.deg2rad(20.0)


@pytest.mark.parametrize("joint", [0, 6])
def test_stiffness_is_in_newton_metres_per_radian(iiwa14: Robot, joint: int) -> None:
    stops = JointStops(give=np.deg2rad(0.8))
    q = np.array(iiwa14.home)
    q[joint] = iiwa14.position_upper[joint]
    effects = JointEffects(damping=2.0, compensation="gravity")
    plant = MujocoPlant(iiwa14, start=q, joints=effects, stops=stops)
    torque = 0.5 * float(iiwa14.torque_limit[joint])
    beyond = excess(plant, joint, torque, 0.6)[-1]
    assert beyond == pytest.approx(np.deg2rad(0.8) * 0.5, rel=1e-3)


def bounce(robot: Robot, joint: int, speed: float, step: float = 5e-4) -> tuple[float, float]:
    """Speed after a joint ran into its stop, rad/s, and how deep it went, rad."""
    q = np.array(robot.home)
    q[joint] = robot.position_upper[joint] - 0.01
    effects = JointEffects(compensation="gravity+coriolis")
    plant = MujocoPlant(robot, start=q, joints=effects, physics_step=step)
    _, world = plant.init()
    world.data.qvel[joint] = speed
    mujoco.mj_step1(plant.model, world.data)
    deepest, zero = 0.0, np.zeros(robot.n)
    for _ in range(80):
        _, world = plant.step(Command(0.0, zero, zero), world)
        truth = plant.truth(world)
        assert truth.limit_excess is not None
        deepest = max(deepest, float(truth.limit_excess[joint]))
        if deepest > 0.0 and truth.limit_excess[joint] == 0.0:
            return abs(float(truth.v[joint])), deepest
    return 0.0, deepest


@pytest.mark.parametrize("joint", [0, 3, 6])
@pytest.mark.parametrize("share", [0.5, 1.0])
def test_a_stop_gives_no_energy(iiwa14: Robot, joint: int, share: float) -> None:
    speed = share * float(iiwa14.velocity_limit[joint])
    after, deepest = bounce(iiwa14, joint, speed)
    assert deepest > 0.0
    assert after < speed


def test_half_the_step_changes_the_depth_little(iiwa14: Robot) -> None:
    assert bounce(iiwa14, 0, 1.0)[1] == pytest.approx(bounce(iiwa14, 0, 1.0, 2.5e-4)[1], rel=0.06)


def test_excess_is_zero_within_the_limits(iiwa14: Robot) -> None:
    plant = MujocoPlant(iiwa14)
    _, world = plant.init()
    np.testing.assert_array_equal(plant.truth(world).limit_excess, np.zeros(7))


def test_impossible_stops_are_refused() -> None:
    for options in ({"give": 0.0}, {"give_linear": -1.0}, {"damping_ratio": 1.5}):
        with pytest.raises(ConfigError, match="joint stops need"):
            JointStops(**options)
