"""The identification run in simulation, on a noisy arm with a biased sensor: the truth lies within three sigma."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pliant.controllers.operational_space import OperationalSpace
from pliant.errors import RobotError, RunFailedError
from pliant.estimation import DirectEstimator
from pliant.interfaces import Plant
from pliant.robot import Robot
from pliant.signals import Command, Measurement, Truth
from pliant.simulation import ForceSensor, Imperfections, ImperfectPlant, MujocoPlant
from pliant.studies.identify_tool import IdentifyToolConfig, identification_tour, report, run_identification

MASS, CENTER = 0.8, np.array([0.015, -0.02, 0.07])
BIAS = np.array([2.0, -1.0, 0.5, 0.03, -0.05, 0.02])
PERIOD = 2e-3
FAST = IdentifyToolConfig(poses=6, move=1.0, settle=0.7, average=0.2)


class Biased(Plant[Any]):
    """A plant whose force/torque sensors have a wrong zero."""

    def __init__(self, inner: Plant[Any], bias: np.ndarray) -> None:
        self.inner, self.bias, self.period = inner, bias, inner.period

    def _read(self, m: Measurement) -> Measurement:
        return replace(m, wrenches={frame: wrench + self.bias for frame, wrench in m.wrenches.items()})

    def init(self) -> tuple[Measurement, Any]:
        measurement, world = self.inner.init()
        return self._read(measurement), world

    def step(self, command: Command, world: Any) -> tuple[Measurement, Any]:
        measurement, world = self.inner.step(command, world)
        return self._read(measurement), world

    def truth(self, world: Any) -> Truth | None:
        return self.inner.truth(world)


def noisy(robot: Robot) -> Plant[Any]:
    sensor = ForceSensor("flange", MASS, tuple(CENTER))
    noise = {"noise_q": 1e-3, "noise_v": 1e-3, "noise_force": 0.5, "noise_moment": 0.02}
    chain = Imperfections.model_validate({"sensing": noise, "torque_loop": {"period": PERIOD}})
    return ImperfectPlant(Biased(MujocoPlant(robot, period=PERIOD, physics_step=1e-3, sensors=[sensor]), BIAS), chain)


def test_truth_lies_within_three_sigma(lwr4: Robot) -> None:
    found = run_identification(lwr4, noisy(lwr4), OperationalSpace(lwr4, "flange", posture_stiffness=200.0), FAST)
    assert abs(found.mass - MASS) < 3.0 * found.mass_std
    assert np.all(np.abs(found.center - CENTER) < 3.0 * found.center_std)
    assert np.all(np.abs(found.bias - BIAS) < 3.0 * found.bias_std)
    # and three sigma say something
    assert found.mass_std < 0.01
    assert np.all(found.center_std < 2e-3)
    text = report(found)
    assert f"{found.mass:.4g}" in text
    assert "centre z" in text


def test_the_arm_has_to_be_still(lwr4: Robot) -> None:
    """Baseline: read right after a fast move, the tool's inertia would count as weight."""
    hasty = FAST.model_copy(update={"poses": 4, "move": 0.4, "settle": 0.002, "average": 0.05})
    with pytest.raises(RunFailedError, match="still moved at pose"):
        run_identification(lwr4, noisy(lwr4), OperationalSpace(lwr4, "flange"), hasty)


def test_the_sensor_has_to_be_there(lwr4: Robot) -> None:
    with pytest.raises(RobotError, match="no force/torque sensor at frame 'flange'"):
        run_identification(lwr4, MujocoPlant(lwr4), OperationalSpace(lwr4, "flange", posture_stiffness=200.0), FAST)


def test_the_tour_is_consistent_and_rests(lwr4: Robot) -> None:
    """Its task is that of its posture, its twist the derivative of its pose, and it stands still in its rests."""
    tour = identification_tour(lwr4, FAST)
    plant = MujocoPlant(lwr4)
    measurement, _ = plant.init()
    estimator = DirectEstimator()
    estimate, _ = estimator.step(measurement, estimator.init(measurement))
    state = tour.init(estimate)
    at = lambda time: tour.step(replace(estimate, time=time), state)[0]  # noqa: E731
    h = 1e-5
    for time in np.linspace(0.95, tour.duration - 1e-3, 12):
        task = at(time).tasks[0]
        np.testing.assert_allclose(task.position, lwr4.placement(at(time).posture, "flange")[0])
        rate = (at(time + h).tasks[0].position - at(time - h).tasks[0].position) / (2 * h)
        np.testing.assert_allclose(task.velocity[:3], rate, atol=1e-5)
        change = (at(time + h).tasks[0].velocity - at(time - h).tasks[0].velocity) / (2 * h)
        np.testing.assert_allclose(task.acceleration, change, atol=1e-3)
    assert len(tour.rests()) == FAST.poses
    for begin, end in tour.rests():
        np.testing.assert_array_equal(at(begin + 1e-9).tasks[0].position, at(end - 1e-9).tasks[0].position)
