"""Delay prediction: what it says about 5 ms ahead against what the simulator does, in free space and in contact."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from pliant import loop
from pliant.controllers.operational_space import OperationalSpace
from pliant.estimation import MomentumObserver, WrenchEstimator
from pliant.interfaces import ReferenceSource
from pliant.mpc import ClassicalMpc, Contact, ForceFeedbackMpc, MpcConfig, TorqueFeedbackMpc
from pliant.mpc.chain import chain_from_robot
from pliant.mpc.make_problem import problem_from_robot
from pliant.robot import Robot, Tool
from pliant.signals import Estimate, Reference, TaskReference, Tick
from pliant.simulation import ForceSensor, JointEffects, MujocoPlant, Scene, Surface, table
from tests.twins.mpc_step.prediction import DelayPrediction

PERIOD, DELAY = 1e-3, 5  # s, periods
ROBOT = Robot.load("iiwa14", locked={"A7": 0.0}, tool=Tool()).with_contact("tool", 0.015)


class Pump(ReferenceSource[None]):
    """Moves the tool up and down about `lower` below its height at home."""

    def __init__(self, lower: float) -> None:
        self.position, self.rotation = ROBOT.placement(ROBOT.home, "tool")
        self.lower = lower

    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, state: None) -> tuple[Reference, None]:
        depth = self.lower + 0.01 * np.sin(25.0 * estimate.time)
        task = TaskReference("tool", self.position - [0.0, 0.0, depth], self.rotation)
        return Reference(estimate.time, (task,), ROBOT.home), None


def recorded(lower: float, damping: float = 0.0) -> list[Tick]:
    height = ROBOT.placement(ROBOT.home, "tool")[0][2] - 0.015
    scene = Scene((table((0.6, 0.0, height), surface=Surface(1e4, 300.0, 0.0)),))
    plant = MujocoPlant(ROBOT, scene, sensors=[ForceSensor("tool")], joints=JointEffects(damping=damping))
    estimator = MomentumObserver(WrenchEstimator(ROBOT), ROBOT, gain=60.0)
    ticks: list[Tick] = []
    loop.run(plant, estimator, Pump(lower), OperationalSpace(ROBOT, "tool"), range(500), [ticks.append])
    return ticks


def state_of(estimate: Estimate) -> np.ndarray:
    return np.concatenate([estimate.q, estimate.v, [estimate.wrenches["tool"][2]]])


def prediction_of(config: MpcConfig) -> DelayPrediction:
    return DelayPrediction(problem_from_robot(ROBOT, config), chain_from_robot(ROBOT, "tool"), PERIOD)


def errors(ticks: list[Tick], stiffness: float, touching: bool | None = None) -> np.ndarray:
    """Rms error of v (rad/s) and of the normal force (N) 5 ms ahead: predicted, and with the present taken for it."""
    contact = Contact(stiffness=(stiffness,), damping=(300.0,), integrator="exponential")
    prediction, rows = prediction_of(ForceFeedbackMpc(contact=contact)), []
    for k in range(250, 490, 3):
        now, then = ticks[k].estimate, state_of(ticks[k + DELAY].estimate)
        torques = [tick.command.torque + now.disturbance for tick in ticks[k : k + DELAY]]
        holds = now.contacts["tool"] if touching is None else touching
        guess, stale = prediction.ahead(state_of(now), torques, torques[0], holds), state_of(now)
        v = [np.linalg.norm((x - then)[6:12]) for x in (guess, stale)]
        rows.append([*v, (guess - then)[12], (stale - then)[12]])
    return np.sqrt(np.mean(np.square(rows), axis=0))


def test_free_space_is_predicted() -> None:
    v, v_stale, *_ = errors(recorded(-0.05), 1e4)
    assert v < 0.03 * v_stale  # baseline: no prediction
    v_damped, v_stale, *_ = errors(recorded(-0.05, damping=0.5), 1e4)
    assert v < v_damped < 0.35 * v_stale  # the observed disturbance lags


def test_contact_is_predicted_with_its_stiffness() -> None:
    ticks = recorded(0.02)
    v, v_stale, force, force_stale = errors(ticks, 1e4)
    assert force < 0.15 * force_stale
    assert v < 0.1 * v_stale
    assert errors(ticks, 3e3)[2] > 3.0 * force  # baseline: another stiffness
    assert errors(ticks, 1e4, touching=False)[2] > 3.0 * force  # baseline: no contact in the model


def test_a_contact_does_not_pull() -> None:
    """Rolled upwards and out of contact, the predicted force ends at zero."""
    prediction = prediction_of(ForceFeedbackMpc())
    x = np.concatenate([ROBOT.home, np.zeros(6), [2.0]])
    axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    data, frame = ROBOT.model.createData(), ROBOT.frame_id("tool")
    up = 60.0 * pin.computeFrameJacobian(ROBOT.model, data, ROBOT.home, frame, axes)[2]
    weight = np.array(pin.computeGeneralizedGravity(ROBOT.model, ROBOT.model.createData(), ROBOT.home))
    assert prediction.ahead(x, [weight + up] * 20, weight, True)[12] == 0.0
    assert prediction.ahead(x, [weight - up] * 20, weight, True)[12] > 2.0  # baseline: pressed


def test_nothing_under_way_changes_nothing() -> None:
    x = np.concatenate([ROBOT.home, np.zeros(7)])
    assert prediction_of(ForceFeedbackMpc()).ahead(x, [], np.zeros(6), False) is x


def test_joint_torque_follows_what_is_sent() -> None:
    """Torque feedback: measured torque at the end is the last torque sent, with the difference that was measured."""
    prediction = prediction_of(TorqueFeedbackMpc())
    acted, sent = np.arange(6.0), np.arange(6.0) + 10.0
    x = np.concatenate([ROBOT.home, np.zeros(6), acted + 0.5])
    np.testing.assert_allclose(prediction.ahead(x, [sent, sent + 1.0], acted, False)[12:], sent + 1.0 + 0.5)


@pytest.mark.parametrize("config", [ClassicalMpc(), TorqueFeedbackMpc()], ids=lambda c: c.kind)
def test_a_rigid_contact_holds_the_tool(config: MpcConfig) -> None:
    prediction = prediction_of(config)
    extra = 6 if config.kind == "torque_feedback" else 0
    x = np.concatenate([ROBOT.home, np.zeros(6 + extra)])
    torques = [np.array([0.0, 30.0, 0.0, -20.0, 0.0, 5.0])] * 5
    heights = [
        ROBOT.placement(prediction.ahead(x, torques, torques[0], touching)[:6], "tool")[0][2]
        for touching in (True, False)
    ]
    start = ROBOT.placement(ROBOT.home, "tool")[0][2]
    assert abs(heights[0] - start) < 1e-5 < abs(heights[1] - start)
