"""The simulated plant: contact in physical units, joint effects, pushes, sensors, timing, and what it refuses."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import ConfigError, RobotError, ShapeError
from pliant.robot import Robot, Tool
from pliant.signals import Command
from pliant.simulation import (
    Ball,
    Box,
    ForceSensor,
    JointEffects,
    MujocoPlant,
    Plane,
    Push,
    Scene,
    Surface,
    World,
    floor,
    table,
)

G = 9.81  # m/s²


def torque(values: object, n: int) -> Command:
    array = np.broadcast_to(np.asarray(values, dtype=np.float64), (n,)).copy()
    return Command(0.0, array, np.zeros(n))


def jacobian(robot: Robot, q: np.ndarray, frame: str) -> np.ndarray:
    return pin.computeFrameJacobian(
        robot.model, robot.model.createData(), q, robot.frame_id(frame), pin.LOCAL_WORLD_ALIGNED
    )


def press(plant: MujocoPlant, force: float, seconds: float = 0.8) -> tuple[World, np.ndarray]:
    """Presses the foot down with a constant force, held sideways by a damped spring."""
    measurement, world = plant.init()
    for _ in range(round(seconds / plant.period)):
        J = jacobian(plant.robot, measurement.q, "foot")[:3]
        x, v = plant.truth(world).positions["foot"], J @ measurement.v
        pull = np.array([500 * (0.1 - x[0]) - 20 * v[0], -500 * x[1] - 20 * v[1], -force])
        measurement, world = plant.step(torque(J.T @ pull, 3), world)
    return world, plant.truth(world).wrenches["foot"]


def leg_plant(robot: Robot, scene: Scene, step: float = 1e-4, **options: object) -> MujocoPlant:
    effects = JointEffects(damping=2.0, compensation="gravity")
    return MujocoPlant(robot, scene, physics_step=step, joints=effects, start=[0.0, 0.75, -1.5], **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("stiffness", [1e3, 1e4, 1e5])
def test_contact_stiffness_is_in_newton_per_metre(leg3: Robot, stiffness: float) -> None:
    scene = Scene((floor(0.0, Surface(stiffness, 4 * np.sqrt(stiffness), friction=0.0)),))
    plant = leg_plant(leg3, scene)
    world, wrench = press(plant, 20.0, 3.5)
    penetration = 0.02 - plant.truth(world).positions["foot"][2]
    assert wrench[2] == pytest.approx(20.0, rel=1e-4)
    assert stiffness * penetration == pytest.approx(wrench[2], rel=1e-5)


def test_contact_damping_is_in_newton_second_per_metre(leg3: Robot) -> None:
    """At first touch, at 0.2 m/s and no depth, the force is B v."""
    damping, speed, step = 50.0, 0.2, 1e-5
    plane = floor(0.0, Surface(1e3, damping, friction=0.0))
    plant = leg_plant(leg3, Scene((plane,)), step)
    _, world = plant.init()
    depth = plant.truth(world).positions["foot"][2] - 0.02
    raised = Plane("floor", (0.0, 0.0, depth + 1e-7), (0.0, 0.0, 1.0), plane.surface)
    plant = MujocoPlant(leg3, Scene((raised,)), period=step, physics_step=step, start=[0.0, 0.75, -1.5])
    _, world = plant.init()
    J = jacobian(leg3, plant.start, "foot")[:3]
    world.data.qvel[:] = np.linalg.solve(J, [0.0, 0.0, -speed])
    mujoco.mj_step1(plant.model, world.data)
    _, world = plant.step(torque(0.0, 3), world)
    assert plant.truth(world).wrenches["foot"][2] == pytest.approx(damping * speed, rel=0.02)


def test_a_ball_sinks_by_its_weight_over_its_stiffness(leg3: Robot) -> None:
    ball = Ball("ball", 0.1, (0.6, 0.3, 0.1), 0.5, Surface(1e3, 1e2))
    plant = leg_plant(leg3, Scene((floor(), ball)))
    _, world = plant.init()
    for _ in range(1500):
        _, world = plant.step(torque(0.0, 3), world)
    assert 0.1 - plant.truth(world).objects["ball"][2] == pytest.approx(0.5 * G / 1e3, rel=1e-3)


def test_friction_holds_below_the_cone_and_slides_above(leg3: Robot) -> None:
    def slip(sideways: float) -> float:
        box = Box("box", (0.2, 0.2, 0.1), (0.6, 0.3, 0.05), mass=2.0, surface=Surface(1e4, 1e2, friction=0.5))
        plant = leg_plant(leg3, Scene((floor(), box)), 2.5e-4)
        _, world = plant.init()
        for _ in range(300):
            world.data.xfrc_applied[plant.model.body("box").id, 0] = sideways
            _, world = plant.step(torque(0.0, 3), world)
        return float(plant.truth(world).objects["box"][0] - 0.6)

    limit = 0.5 * 2.0 * G
    assert slip(0.8 * limit) < 5e-3  # MuJoCo's friction creeps
    assert slip(1.5 * limit) > 0.05


def test_a_tilted_table_pushes_along_its_normal(leg3: Robot) -> None:
    tilt = np.deg2rad(10.0)
    plane = table((0.1, 0.0, 0.0), tilt, Surface(1e4, 200.0, friction=0.0))
    np.testing.assert_allclose(plane.normal, [0.0, -np.sin(tilt), np.cos(tilt)])
    _, wrench = press(leg_plant(leg3, Scene((plane,))), 20.0)
    np.testing.assert_allclose(wrench[:3] / np.linalg.norm(wrench[:3]), plane.normal, atol=1e-3)


@pytest.mark.parametrize("compensation", ["gravity", "gravity+coriolis"])
def test_a_compensated_arm_stays_where_it_is(lwr4: Robot, compensation: str) -> None:
    def drift(effects: JointEffects) -> float:
        plant = MujocoPlant(lwr4, joints=effects)
        _, world = plant.init()
        for _ in range(200):
            _, world = plant.step(torque(0.0, 7), world)
        return float(np.abs(plant.truth(world).q - plant.start).max())

    assert drift(JointEffects(compensation=compensation)) < 1e-9  # type: ignore[arg-type]
    assert drift(JointEffects()) > 0.05


def test_joint_friction_holds_and_damping_slows(lwr4: Robot) -> None:
    def speed(effects: JointEffects, push: float) -> float:
        plant = MujocoPlant(lwr4, joints=effects)
        _, world = plant.init()
        for _ in range(100):
            _, world = plant.step(torque([push, 0, 0, 0, 0, 0, 0], 7), world)
        return abs(float(plant.truth(world).v[0]))

    held = JointEffects(friction=10.0, compensation="gravity")
    assert speed(held, 8.0) < 2e-3
    assert speed(held, 14.0) > 20 * speed(held, 8.0)
    free = JointEffects(compensation="gravity")
    assert speed(JointEffects(damping=5.0, compensation="gravity"), 8.0) < 0.9 * speed(free, 8.0)


def test_a_push_changes_the_momentum_by_its_impulse(leg3: Robot) -> None:
    q = np.array([0.0, 0.9, -1.9])
    push = Push("foot", (4.0, 0.0, -3.0), start=0.010, duration=0.005)
    effects = JointEffects(compensation="gravity+coriolis")
    plant = MujocoPlant(leg3, start=q, joints=effects, pushes=[push], physics_step=1e-4)
    _, world = plant.init()
    for _ in range(20):
        _, world = plant.step(torque(0.0, 3), world)
    v = plant.truth(world).v
    upper = np.triu(pin.crba(leg3.model, leg3.model.createData(), q))
    momentum = (upper + np.triu(upper, 1).T) @ v
    impulse = jacobian(leg3, q, "foot")[:3].T @ np.array(push.force) * push.duration
    np.testing.assert_allclose(momentum, impulse, rtol=0.03, atol=1e-4)


def test_a_wrist_sensor_feels_the_tools_weight_in_its_own_axes(iiwa14: Robot) -> None:
    robot = iiwa14.with_tool(Tool(mass=0.4))
    sensor = ForceSensor("flange", mass=0.4, center=(0.0, 0.0, 0.1))
    plant = MujocoPlant(robot, joints=JointEffects(compensation="gravity+coriolis"), sensors=[sensor])
    measurement, _ = plant.init()
    _, R = robot.placement(plant.start, "flange")
    weight = R.T @ [0.0, 0.0, -0.4 * G]
    np.testing.assert_allclose(measurement.wrenches["flange"][:3], weight, atol=1e-6)
    np.testing.assert_allclose(measurement.wrenches["flange"][3:], np.cross([0, 0, 0.1], weight), atol=1e-6)


def test_a_sensor_feels_what_touches_beyond_it_and_nothing_else(leg3: Robot) -> None:
    """A sensor at the knee's far side feels the foot's contact with its lever arm; one at the hip's body frame too."""
    sensors = [ForceSensor("foot"), ForceSensor("shank"), ForceSensor("thigh")]
    scene = Scene((floor(0.0, Surface(1e4, 4e2, friction=0.0)),))
    plant = leg_plant(leg3, scene, sensors=sensors)
    world, wrench = press(plant, 20.0)
    readings, truth = plant._measure(world).wrenches, plant.truth(world)
    for frame in ("foot", "shank", "thigh"):
        R = truth.rotations[frame]
        np.testing.assert_allclose(R @ readings[frame][:3], wrench[:3], atol=1e-9)
        lever = truth.positions["foot"] - truth.positions[frame]
        np.testing.assert_allclose(R @ readings[frame][3:], wrench[3:] + np.cross(lever, wrench[:3]), atol=1e-9)
    above = leg3.with_frame("above", "thigh").with_contact("above", 0.01)
    assert above.carries("thigh", "above")
    assert not above.carries("shank", "above")


def test_half_the_physics_step_changes_little(leg3: Robot) -> None:
    scene = Scene((floor(0.0, Surface(1e4, 1e2, 0.3)),))
    coarse = press(leg_plant(leg3, scene, 5e-4), 30.0, 0.08)[0].data.qpos.copy()
    fine = press(leg_plant(leg3, scene, 2.5e-4), 30.0, 0.08)[0].data.qpos.copy()
    np.testing.assert_allclose(coarse, fine, atol=1e-3)


def test_torques_are_limited_and_the_measurement_says_what_was_sent(lwr4: Robot) -> None:
    plant = MujocoPlant(lwr4)
    _, world = plant.init()
    measurement, _ = plant.step(torque(1e6, 7), world)
    np.testing.assert_allclose(measurement.torque_sent, lwr4.torque_limit)


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"period": 1e-3, "physics_step": 3e-4}, ConfigError, "whole multiple"),
        ({"physics_step": 0.0}, ConfigError, "above zero"),
        ({"start": [0.0, 0.0]}, ShapeError, "start must have 7 entries"),
        ({"sensors": [ForceSensor("nose")]}, RobotError, "no frame 'nose'"),
        ({"pushes": [Push("nose", (0, 0, 1), 0, 1)]}, RobotError, "no frame 'nose'"),
    ],
)
def test_what_a_plant_refuses(lwr4: Robot, options: dict[str, object], error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        MujocoPlant(lwr4, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "make",
    [
        lambda: Surface(stiffness=0.0),
        lambda: Surface(damping=-1.0),
        lambda: Surface(friction=float("nan")),
        lambda: Scene((floor(), floor())),
        lambda: Scene(contact="glue"),  # type: ignore[arg-type]
        lambda: JointEffects(friction=-1.0),
        lambda: JointEffects(compensation="all"),  # type: ignore[arg-type]
    ],
)
def test_impossible_scenes_are_refused(make: object) -> None:
    with pytest.raises(ConfigError):
        make()  # type: ignore[operator]


def test_a_contact_too_stiff_for_the_step_names_the_numbers(leg3: Robot) -> None:
    with pytest.raises(ConfigError, match=r"must stay below 4.*shorten the step"):
        MujocoPlant(leg3, Scene((floor(0.0, Surface(1e6, 1e4)),)))
