"""Momentum observer: first-order response to a constant disturbance, friction, payload, contact; with baselines."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from pliant import loop
from pliant.controllers.operational_space import OperationalSpace
from pliant.estimation import DirectEstimator, MomentumObserver, WrenchEstimator
from pliant.interfaces import ReferenceSource
from pliant.robot import Robot, Tool
from pliant.signals import Estimate, Reference, TaskReference
from pliant.simulation import ForceSensor, Imperfections, ImperfectPlant, MujocoPlant, Scene, Surface, table
from pliant.simulation.imperfections.actuation import ActuationConfig

GAIN = 30.0  # rad/s


class Sway(ReferenceSource[None]):
    """Holds the start, moved by an offset in m plus a swing of an amplitude in m at 1 Hz; turns nothing."""

    def __init__(self, robot: Robot, frame: str, amplitude=(0.0, 0.0, 0.0), offset=(0.0, 0.0, 0.0)) -> None:
        position, self.rotation = robot.placement(robot.home, frame)
        self.frame, self.amplitude = frame, np.array(amplitude)
        self.position, self.posture = position + np.array(offset), robot.home

    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, state: None) -> tuple[Reference, None]:
        w = 2.0 * np.pi
        swing = self.amplitude * (1.0 - np.cos(w * estimate.time))
        velocity = np.concatenate([self.amplitude * w * np.sin(w * estimate.time), np.zeros(3)])
        task = TaskReference(self.frame, self.position + swing, self.rotation, velocity)
        return Reference(estimate.time, (task,), self.posture), None


def run(plant, estimator, source, robot, frame, duration):
    ticks = []
    controller = OperationalSpace(robot, frame)
    outcome = loop.run(plant, estimator, source, controller, range(round(duration / plant.period)), [ticks.append])
    assert outcome.failure is None
    return ticks


def disturbances(ticks) -> np.ndarray:
    return np.array([tick.estimate.disturbance for tick in ticks])


@pytest.mark.parametrize("gain", [10.0, 30.0, 100.0])
def test_constant_disturbance_is_found_as_a_first_order_response(lwr4: Robot, gain: float) -> None:
    bias = 2.0  # N·m, on every joint
    robot = lwr4
    drives = Imperfections(actuation=ActuationConfig(bias=(bias, bias)))
    plant = ImperfectPlant(MujocoPlant(robot), drives)
    source = Sway(robot, "flange", amplitude=(0.05, 0.05, 0.0))
    ticks = run(plant, MomentumObserver(DirectEstimator(), robot, gain=gain), source, robot, "flange", 0.4)
    time = np.array([tick.estimate.time for tick in ticks])
    expected = bias * (1.0 - np.exp(-gain * time))
    np.testing.assert_allclose(disturbances(ticks), expected[:, None] * np.ones(robot.n), atol=0.02 * bias)
    slower = bias * (1.0 - np.exp(-0.8 * gain * time))  # baseline: the tolerance tells a gain from 0.8 of it
    assert np.max(np.abs(disturbances(ticks) - slower[:, None])) > 0.04 * bias


def test_friction_of_the_drives_is_found_where_the_torque_is_the_one_sent(lwr4: Robot) -> None:
    drives = Imperfections(actuation=ActuationConfig(dry_friction=1.0, viscous_friction=0.5))
    source = Sway(lwr4, "flange", amplitude=(0.05, 0.05, 0.03))
    found = {}
    for torque in ("sent", "measured"):
        observer = MomentumObserver(DirectEstimator(), lwr4, torque=torque, gain=100.0)
        ticks = run(ImperfectPlant(MujocoPlant(lwr4), drives), observer, source, lwr4, "flange", 1.0)
        found[torque] = disturbances(ticks)
    v = np.array([tick.truth.v for tick in ticks])
    friction = -(np.tanh(v / 0.1) + 0.5 * v)
    delayed = np.zeros_like(friction)  # a perfect observer of that gain; drives hold friction for a period
    for k in range(1, len(v)):
        delayed[k] = delayed[k - 1] + (1.0 - np.exp(-0.1)) * (friction[k - 1] - delayed[k - 1])
    assert np.max(np.abs(friction)) > 0.5
    assert np.max(np.abs(found["sent"] - delayed)) < 0.03
    # Baseline: the torque sensors sit behind the drives' friction, so they show nothing of it.
    assert np.max(np.abs(found["measured"])) < 0.03


def test_a_payload_that_the_model_lacks_is_its_weight(lwr4: Robot) -> None:
    heavier = lwr4.with_tool(Tool(mass=2.0, length=0.1))
    observer = MomentumObserver(DirectEstimator(), lwr4)
    ticks = run(MujocoPlant(heavier), observer, Sway(lwr4, "flange"), lwr4, "flange", 1.5)
    q = ticks[-1].truth.q
    gravity = [pin.computeGeneralizedGravity(r.model, r.model.createData(), q) for r in (lwr4, heavier)]
    assert np.max(np.abs(gravity[1] - gravity[0])) > 5.0
    # the arm still sags towards its rest: what is left is the inertia of the payload
    np.testing.assert_allclose(ticks[-1].estimate.disturbance, gravity[0] - gravity[1], atol=0.05)


def pressing(contact: str, friction: float = 0.3):
    """Disturbances while a tool slides to and fro and presses on a table; and Jᵀ of wrench, of force along z."""
    robot = Robot.load("iiwa14", tool=Tool()).with_contact("tool", 0.015)
    height = robot.placement(robot.home, "tool")[0][2] - 0.015
    plant = MujocoPlant(
        robot,
        Scene((table((0.6, 0.0, height), surface=Surface(1e4, 5e2, friction)),)),
        sensors=[ForceSensor("tool")],
    )
    source = Sway(robot, "tool", amplitude=(0.0, 0.03, 0.0), offset=(0.0, 0.0, -0.02))
    observer = MomentumObserver(WrenchEstimator(robot), robot, contact=contact)
    ticks = run(plant, observer, source, robot, "tool", 1.0)
    data, axes = robot.model.createData(), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    whole, normal = [], []
    for tick in ticks:
        J = pin.computeFrameJacobian(robot.model, data, tick.truth.q, robot.frame_id("tool"), axes)
        wrench = tick.truth.wrenches["tool"]
        whole.append(J.T @ wrench)
        normal.append(J[2] * wrench[2])
    return disturbances(ticks)[300:], np.array(whole)[300:], np.array(normal)[300:]


def test_a_contact_is_a_disturbance_unless_its_force_is_taken_into_account() -> None:
    explained, whole, _ = pressing("all")
    assert np.max(np.abs(whole)) > 5.0
    assert np.max(np.abs(explained)) < 0.05
    ignored, whole, _ = pressing("none")  # baseline
    lag = 1.0 / GAIN  # s; the contact torque changes slowly against it
    rate = np.max(np.abs(np.gradient(whole, 1e-3, axis=0)[50:]))
    assert np.max(np.abs(ignored - whole)[50:]) < rate * lag + 0.05
    assert np.max(np.abs(ignored)) > 5.0


def test_with_the_normal_force_alone_table_friction_is_the_disturbance() -> None:
    found, whole, normal = pressing("normal")
    tangential = whole - normal
    assert np.max(np.abs(tangential)) > 1.0
    error = found - tangential
    assert np.sqrt(np.mean(error**2)) < 0.25 * np.sqrt(np.mean(tangential**2))


def test_late_readings_are_matched_with_the_torque_that_caused_them(lwr4: Robot) -> None:
    """A torque that changes within each period looks like a disturbance to readings that are three periods late."""
    late = Imperfections.model_validate({"sensing": {"delay": 3e-3}})
    peaks = {}
    for periods in (0, 3):
        observer = MomentumObserver(DirectEstimator(), lwr4, late_readings=periods)
        source = Sway(lwr4, "flange", amplitude=(0.1, 0.1, 0.0))
        held = pin.computeGeneralizedGravity(lwr4.model, lwr4.model.createData(), lwr4.home)
        plant = ImperfectPlant(MujocoPlant(lwr4), late, holding_torque=held)
        peaks[periods] = np.max(np.abs(disturbances(run(plant, observer, source, lwr4, "flange", 0.5))))
    assert peaks[3] < 0.1 * peaks[0]
