"""A simulated robot starts from rest in equilibrium: its first reading is not that of a falling arm."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pinocchio as pin
import pytest

from pliant.robot import Robot
from pliant.signals import Command
from pliant.simulation import (
    ForceSensor,
    Imperfections,
    ImperfectPlant,
    JointEffects,
    MujocoPlant,
    Scene,
    Surface,
    floor,
)

G = 9.81  # m/s²


def gravity_torque(robot: Robot, q: np.ndarray) -> np.ndarray:
    return np.array(pin.computeGeneralizedGravity(robot.model, robot.model.createData(), q))


def test_the_first_reading_of_a_wrist_sensor_is_the_weight_at_rest(iiwa14: Robot) -> None:
    plant = MujocoPlant(iiwa14, sensors=[ForceSensor("flange", 0.8, (0.0, 0.0, 0.1))])
    measurement, _ = plant.init()
    R = iiwa14.placement(plant.start, "flange")[1]
    np.testing.assert_allclose(R @ measurement.wrenches["flange"][:3], [0.0, 0.0, -0.8 * G], atol=1e-6)


def test_the_torque_before_the_first_command_is_the_one_that_holds_the_arm(iiwa14: Robot) -> None:
    plant = MujocoPlant(iiwa14)
    measurement, world = plant.init()
    np.testing.assert_allclose(measurement.torque, gravity_torque(iiwa14, plant.start), atol=1e-7)
    np.testing.assert_array_equal(measurement.torque_sent, measurement.torque)
    for _ in range(100):
        held, world = plant.step(Command(0.0, measurement.torque, np.zeros(7)), world)
    assert np.abs(held.q - plant.start).max() < 1e-6


@pytest.mark.parametrize("compensation", ["gravity", "gravity+coriolis"])
def test_a_robot_that_compensates_itself_needs_no_torque(
    iiwa14: Robot, compensation: Literal["gravity", "gravity+coriolis"]
) -> None:
    measurement, _ = MujocoPlant(iiwa14, joints=JointEffects(compensation=compensation)).init()
    np.testing.assert_array_equal(measurement.torque, np.zeros(7))


@pytest.mark.parametrize(("law", "step"), [("mujoco", 1e-4), ("explicit", 2e-5)])
def test_a_robot_that_starts_pressed_stays_pressed(
    leg3: Robot, law: Literal["mujoco", "explicit"], step: float
) -> None:
    height = float(leg3.placement(leg3.home, "foot")[0][2]) - 0.02 + 2e-3  # 2 mm deep
    scene = Scene((floor(height, Surface(1e4, 1e2, friction=0.0)),), contact=law)
    plant = MujocoPlant(leg3, scene, physics_step=step)
    measurement, world = plant.init()
    assert plant.truth(world).wrenches["foot"][2] == pytest.approx(20.0, rel=1e-3)
    for _ in range(20):
        _, world = plant.step(Command(0.0, measurement.torque, np.zeros(3)), world)
    assert plant.truth(world).wrenches["foot"][2] == pytest.approx(20.0, rel=0.01)


def test_an_imperfect_arm_holds_itself_until_the_first_command(iiwa14: Robot) -> None:
    late = Imperfections(computation_delay=5e-3)
    plant = ImperfectPlant(MujocoPlant(iiwa14), late)
    measurement, world = plant.init()
    np.testing.assert_allclose(measurement.torque, gravity_torque(iiwa14, iiwa14.home), atol=1e-7)
    for _ in range(5):
        measurement, world = plant.step(Command(0.0, np.zeros(7), np.zeros(7)), world)
    assert np.abs(measurement.v).max() < 1e-6


def test_another_plant_goes_on_with_the_torque_of_the_one_before(iiwa14: Robot) -> None:
    plant = MujocoPlant(iiwa14, sensors=[ForceSensor("flange", 0.8)])
    _, world = plant.init()
    torque = gravity_torque(iiwa14, plant.start) + 1.0
    measurement, world = plant.step(Command(0.0, torque, np.zeros(7)), world)
    resumed, _ = MujocoPlant(iiwa14, sensors=plant.sensors).resume(world)
    np.testing.assert_array_equal(resumed.torque_sent, torque)
    np.testing.assert_allclose(resumed.wrenches["flange"], measurement.wrenches["flange"], atol=0.05)
