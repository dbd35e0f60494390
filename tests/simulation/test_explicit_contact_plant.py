"""Explicit contacts in the plant: true wrenches, no hopping, any floor, links, weak actuators, refusals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import ConfigError
from pliant.interfaces import Plant
from pliant.robot import Robot
from pliant.signals import Command
from pliant.simulation import (
    Box,
    Imperfections,
    ImperfectPlant,
    JointEffects,
    LinkCapsule,
    MujocoPlant,
    Plane,
    Scene,
    Surface,
    floor,
)
from pliant.spatial import rpy
from tests.simulation.bench import FINE, RIGID, G

# ---------------------------------------------------------------------- in the plant


def leg_on_floor(
    leg3: Robot, surface: Surface, dt: float = FINE, joints: JointEffects | None = None
) -> tuple[MujocoPlant, np.ndarray]:
    x, _ = leg3.placement(leg3.home, "foot")
    scene = Scene((floor(x[2] - 0.02, surface),), contact="explicit")
    return MujocoPlant(leg3, scene, physics_step=dt, joints=joints), x


@dataclass
class Log:
    """What happened, one row per ms."""

    wrench: np.ndarray
    """(k, 6) at the foot"""
    residual: np.ndarray
    """(k, 3) τ + Jᵀ W − g, N·m: what is left to accelerate the joints"""


def press_and_slide(plant: Plant[Any], robot: Robot, x: np.ndarray, seconds: float, speed: float) -> Log:
    """Presses 40 N while a damped spring pulls the foot along x."""
    data, fid = robot.model.createData(), robot.frame_id("foot")
    measurement, world = plant.init()
    wrenches, residuals = [], []
    for k in range(round(seconds / plant.period)):
        J = pin.computeFrameJacobian(robot.model, data, measurement.q, fid, pin.LOCAL_WORLD_ALIGNED)
        gravity = pin.computeGeneralizedGravity(robot.model, data, measurement.q)
        pin.framesForwardKinematics(robot.model, data, measurement.q)
        target = x + np.array([speed * k * plant.period, 0.0, 0.0])
        pull = 3000.0 * (target - data.oMf[fid].translation) - 40.0 * (J[:3] @ measurement.v)
        pull[2] = -40.0
        torque = gravity + J[:3].T @ pull
        measurement, world = plant.step(Command(measurement.time, torque, np.zeros(3)), world)
        truth = plant.truth(world)
        assert truth is not None
        wrenches.append(truth.wrenches["foot"])
        residuals.append(torque + J.T @ wrenches[-1] - gravity)
    return Log(np.array(wrenches), np.array(residuals))


def test_the_foot_wrench_is_the_force_that_balances_the_robot(leg3: Robot) -> None:
    plant, x = leg_on_floor(leg3, RIGID)
    log = press_and_slide(plant, leg3, x, 0.6, 0.0)
    wrench = log.wrench[-1]
    assert np.abs(log.residual[-1]).max() < 1e-6
    assert wrench[2] == pytest.approx(40.0, abs=0.1)
    # The force acts at the sole, a radius (less the penetration) below the frame's origin.
    assert np.allclose(wrench[3:], np.cross([0.0, 0.0, -0.02], wrench[:3]), atol=2e-3)


def test_what_lies_on_the_floor_carries_what_presses_on_it(leg3: Robot) -> None:
    foot, _ = leg3.placement(leg3.home, "foot")
    top = float(foot[2]) - 0.02
    box = Box("box", (0.2, 0.2, 0.06), (float(foot[0]), 0.0, top - 0.03), 2.0, surface=RIGID)
    scene = Scene((box, floor(top - 0.06, RIGID)), contact="explicit")
    plant = MujocoPlant(leg3, scene, joints=JointEffects(damping=5.0, compensation="gravity"))
    J = pin.computeFrameJacobian(
        leg3.model, leg3.model.createData(), leg3.home, leg3.frame_id("foot"), pin.LOCAL_WORLD_ALIGNED
    )
    _, world = plant.init()
    for _ in range(400):
        _, world = plant.step(Command(0.0, J[:3].T @ np.array([0.0, 0.0, -20.0]), np.zeros(3)), world)
    contacts, state = plant.explicit, world.contacts
    assert contacts is not None
    assert state is not None
    assert np.allclose(contacts.force_on(state, "box"), [0.0, 0.0, 2.0 * G], atol=0.01)
    pressed = plant.truth(world).wrenches["foot"][:3]
    assert pressed[2] > 10.0
    assert np.allclose(contacts.force_on(state, "floor"), -pressed - [0.0, 0.0, 2.0 * G], atol=0.01)


def test_a_stiff_floor_holds_a_light_foot_without_hopping_while_it_slides(leg3: Robot) -> None:
    plant, x = leg_on_floor(leg3, RIGID)
    log = press_and_slide(plant, leg3, x, 0.8, 0.05).wrench[300:]
    assert log[:, 2].min() > 5.0  # no break
    assert log[:, 2].max() < 80.0  # no hammering
    friction = -log[:, 0] / log[:, 2]
    assert friction[-200:].mean() == pytest.approx(0.3, abs=0.03)


def creep_under_load(leg3: Robot, law: str) -> float:
    """Speed in m/s of a foot that presses 40 N and is pushed sideways with 5 N."""
    x, _ = leg3.placement(leg3.home, "foot")
    plant = MujocoPlant(leg3, Scene((floor(x[2] - 0.02, RIGID),), contact=law), physics_step=FINE)  # type: ignore[arg-type]
    data, fid = leg3.model.createData(), leg3.frame_id("foot")
    measurement, world = plant.init()
    path = []
    for k in range(500):
        J = pin.computeFrameJacobian(leg3.model, data, measurement.q, fid, pin.LOCAL_WORLD_ALIGNED)[:3]
        gravity = pin.computeGeneralizedGravity(leg3.model, data, measurement.q)
        push = np.array([5.0 * min(1.0, k / 100), 0.0, -40.0])
        measurement, world = plant.step(Command(measurement.time, gravity + J.T @ push, np.zeros(3)), world)
        path.append(plant.truth(world).positions["foot"][0])
    return abs(path[-1] - path[299]) / 0.2


def test_a_loaded_foot_stands_still_where_mujocos_own_friction_creeps(leg3: Robot) -> None:
    assert creep_under_load(leg3, "explicit") < 1e-6
    assert creep_under_load(leg3, "mujoco") > 5e-3


def test_halving_the_step_moves_the_forces_by_less_than_two_per_cent(leg3: Robot) -> None:
    peaks, means = [], []
    for dt in (FINE, 0.5 * FINE):
        plant, x = leg_on_floor(leg3, RIGID, dt)
        log = press_and_slide(plant, leg3, x, 0.5, 0.05).wrench
        peaks.append(log[:, 2].max())
        means.append(log[200:, 0].mean())
    assert peaks[0] == pytest.approx(peaks[1], rel=0.02)
    assert means[0] == pytest.approx(means[1], rel=0.02)


def test_the_shank_touches_a_box_and_the_foot_feels_nothing(leg3: Robot) -> None:
    knee, _ = leg3.placement(leg3.home, "shank")
    foot, _ = leg3.placement(leg3.home, "foot")
    middle = 0.5 * (knee + foot)
    shank = LinkCapsule("shank", "foot", 0.02, end_margin=0.04)
    # A fixed box in front of the leg, 5 mm away from the middle of the shank.
    across = np.array([-(foot - knee)[2], 0.0, (foot - knee)[0]])
    side = -across / np.linalg.norm(across)
    angle = float(np.arctan2(side[2], -side[0]))
    box = Box("box", (0.1, 0.1, 0.05), tuple(middle + side * (0.02 + 0.05 + 0.005)), 0.0, (0.0, angle, 0.0), RIGID)
    effects = JointEffects(damping=1.0, compensation="gravity")
    plant = MujocoPlant(leg3, Scene((box,), contact="explicit"), links=[shank], joints=effects)
    _, world = plant.init()
    sign = 1.0 if side[0] < 0 else -1.0
    felt = False
    for _ in range(300):
        _, world = plant.step(Command(0.0, np.array([0.0, 0.0, 3.0 * sign]), np.zeros(3)), world)
        truth = plant.truth(world)
        felt = felt or bool(truth.wrenches["shank"].any())
        assert not truth.wrenches["foot"].any()
    assert felt
    assert "shank" in world.touching


@settings(max_examples=12)
@given(
    stiffness=st.floats(2.5, 6.0).map(lambda power: 10.0**power),
    friction=st.floats(0.0, 1.0),
    roll=st.floats(-20.0, 20.0),
    pitch=st.floats(-20.0, 20.0),
    speed=st.floats(-0.2, 0.2),
)
def test_any_floor_can_be_pressed_and_stroked(
    leg3: Robot, stiffness: float, friction: float, roll: float, pitch: float, speed: float
) -> None:
    """Forces stay those of a contact: they push, within the cone, and no more than an impact allows."""
    x, _ = leg3.placement(leg3.home, "foot")
    normal = rpy(np.deg2rad(roll), np.deg2rad(pitch), 0.0)[:, 2]
    surface = Surface(stiffness, 1e-2 * stiffness, friction, 0.6 * friction)
    plane = Plane("floor", tuple(x - 0.025 * normal), tuple(normal), surface)
    plant = MujocoPlant(leg3, Scene((plane,), contact="explicit"))
    forces = press_and_slide(plant, leg3, x, 0.3, speed).wrench[:, :3]
    pressing = forces @ normal
    sideways = np.linalg.norm(forces - np.outer(pressing, normal), axis=1)
    assert pressing.min() >= 0.0
    assert np.all(sideways <= friction * pressing + 1e-9)
    assert pressing.max() < 300.0


def test_the_same_run_gives_the_same_forces_bit_for_bit(leg3: Robot) -> None:
    first, second = (
        press_and_slide(leg_on_floor(leg3, RIGID)[0], leg3, np.array([0.034, 0.0, 0.06]), 0.1, 0.05) for _ in "ab"
    )
    assert np.array_equal(first.wrench, second.wrench)


def test_weak_and_slow_actuators_on_damped_joints_hold_a_force_on_a_stiff_floor(leg3: Robot) -> None:
    inner, x = leg_on_floor(leg3, RIGID, joints=JointEffects(damping=11.46))
    held = pin.computeGeneralizedGravity(leg3.model, leg3.model.createData(), leg3.home)
    plant = ImperfectPlant(inner, Imperfections.p0_experiment4(), holding_torque=held)
    log = press_and_slide(plant, leg3, x, 1.0, 0.0)
    assert log.wrench[-1, 2] == pytest.approx(40.0, abs=0.5)
    assert np.ptp(log.wrench[-100:, 2]) < 0.05


# ---------------------------------------------------------------------- failing


def test_a_step_too_long_for_the_foot_names_the_longest_one(leg3: Robot) -> None:
    with pytest.raises(
        ConfigError, match=r"too long for K = 1e\+06 N/m and D = 10000 N s/m.* it must be below"
    ) as error:
        leg_on_floor(leg3, RIGID, 5e-4)
    longest = float(str(error.value).split("below ")[1].split(" s")[0])
    assert 1e-5 < longest < 1e-4
    period = 4.0 * longest  # just below works, just above does not
    x, _ = leg3.placement(leg3.home, "foot")
    scene = Scene((floor(x[2] - 0.02, RIGID),), contact="explicit")
    MujocoPlant(leg3, scene, period=0.99 * period, physics_step=0.99 * longest)
    with pytest.raises(ConfigError, match="too long"):
        MujocoPlant(leg3, scene, period=1.02 * period, physics_step=1.02 * longest)


def test_a_link_capsule_needs_two_frames_that_move_together(leg3: Robot) -> None:
    with pytest.raises(ConfigError, match="must move together"):
        MujocoPlant(leg3, links=[LinkCapsule("thigh", "foot", 0.02)])
    with pytest.raises(ConfigError, match=r"end_margin must be below its length of 0\.275 m"):
        MujocoPlant(leg3, links=[LinkCapsule("shank", "foot", 0.02, end_margin=0.5)])
    with pytest.raises(ConfigError, match="radius > 0"):
        LinkCapsule("shank", "foot", 0.0)
