"""Joint torques from the model, and a filtered force without lag: against the simulator's truth, with baselines."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.errors import ConfigError
from pliant.estimation import (
    Butterworth,
    ComplementaryForce,
    DirectEstimator,
    FilteredEstimator,
    ModelledTorqueEstimator,
    WrenchEstimator,
)
from pliant.interfaces import Estimator
from pliant.robot import Robot, Tool
from pliant.signals import Measurement
from pliant.simulation import ForceSensor, MujocoPlant, Scene, Surface, table
from pliant.surfaces import PlaneSurface
from tests.estimation.test_external_torque import PERIOD, Sway, run

ROBOT = Robot.load("iiwa14", tool=Tool()).with_contact("tool", 0.015)
STIFFNESS = 1e4  # N/m
LEVEL = PlaneSurface.facing((0.0, 0.0, 1.0))


class Dip(Sway):
    """Presses more and less on one spot, 4 times a second."""

    def step(self, estimate, state):
        reference, _ = super().step(estimate, state)
        reference.tasks[0].position[2] += 2e-3 * np.sin(8.0 * np.pi * estimate.time)
        return reference, None


def pressed(estimator: Estimator, swing: float = 0.03, source: type[Sway] = Sway, damping: float = 500.0):
    height = ROBOT.placement(ROBOT.home, "tool")[0][2] - 0.015
    scene = Scene((table((0.6, 0.0, height), surface=Surface(STIFFNESS, damping, 0.3)),))
    plant = MujocoPlant(ROBOT, scene, sensors=[ForceSensor("tool")])
    return run(plant, estimator, source(ROBOT, "tool", swing, lower=0.02), ROBOT, "tool", 800)[300:]


def test_the_modelled_torque_is_the_one_at_the_links() -> None:
    """RNEA − Jᵀλ gives what the joint sensors of a robot without imperfections say; without τ_ext it is far off."""
    modelled = ModelledTorqueEstimator(WrenchEstimator(ROBOT), ROBOT, "tool", PERIOD)
    ticks = pressed(modelled)
    off = np.array([tick.estimate.torque - tick.truth.torque for tick in ticks])
    free = ModelledTorqueEstimator(DirectEstimator(), ROBOT, "tool", PERIOD)  # no wrench: τ_ext is zero
    without = np.array([tick.estimate.torque - tick.truth.torque for tick in pressed(free)])
    assert np.sqrt(np.mean(off**2)) < 0.1  # N·m
    assert np.sqrt(np.mean(without**2)) > 20.0 * np.sqrt(np.mean(off**2))


def test_the_sensors_errors_are_not_in_it() -> None:
    n = ROBOT.n
    estimator = ModelledTorqueEstimator(DirectEstimator(), ROBOT, "tool", PERIOD)
    right = Measurement(0.0, ROBOT.home, np.zeros(n), np.zeros(n), np.zeros(n))
    wrong = Measurement(0.0, ROBOT.home, np.zeros(n), np.full(n, 5.0), np.zeros(n))
    first, second = (estimator.step(one, estimator.init(one))[0].torque for one in (right, wrong))
    np.testing.assert_array_equal(first, second)


def rms_error(estimator: Estimator) -> float:
    ticks = pressed(estimator, swing=0.0, source=Dip, damping=50.0)  # the model has none
    found = np.array([tick.estimate.wrenches["tool"][2] for tick in ticks])
    true = np.array([tick.truth.wrenches["tool"][2] for tick in ticks])
    assert np.std(true) > 3.0  # there is something to be late for
    return float(np.sqrt(np.mean((found - true) ** 2)))


@pytest.mark.parametrize("cutoff", [10.0, 30.0])
def test_the_motion_fills_in_what_the_filter_is_late_by(cutoff: float) -> None:
    felt, low_pass = WrenchEstimator(ROBOT), Butterworth(cutoff, PERIOD)
    late = rms_error(FilteredEstimator(felt, wrench=low_pass))
    filled = rms_error(ComplementaryForce(felt, ROBOT, "tool", low_pass, STIFFNESS, LEVEL))
    wrong = rms_error(ComplementaryForce(felt, ROBOT, "tool", low_pass, -STIFFNESS, LEVEL))  # baseline
    assert filled < 0.4 * late < late < wrong


def test_a_ripple_of_the_sensor_is_taken_off_all_the_same() -> None:
    """At rest on the table a 35 Hz error of the reading shrinks as behind the filter alone."""
    n, filter_ = ROBOT.n, Butterworth(15.0, PERIOD)
    felt = WrenchEstimator(ROBOT)
    both = (FilteredEstimator(felt, wrench=filter_), ComplementaryForce(felt, ROBOT, "tool", filter_, 1e4, LEVEL))
    heights: list[list[float]] = []
    for estimator in both:
        state, seen = None, list[float]()
        for k in range(600):
            wrench = np.array([0.0, 0.0, -(50.0 + 5.0 * np.sin(2.0 * np.pi * 35.0 * k * PERIOD)), 0.0, 0.0, 0.0])
            now = Measurement(k * PERIOD, ROBOT.home, np.zeros(n), np.zeros(n), np.zeros(n), {"tool": wrench})
            state = estimator.init(now) if state is None else state
            estimate, state = estimator.step(now, state)
            seen.append(float(estimate.wrenches["tool"][2]))
        heights.append(seen[300:])
    assert np.ptp(heights[1]) == pytest.approx(np.ptp(heights[0]), rel=1e-6)
    assert np.ptp(heights[1]) < 0.3 * 10.0


def test_a_cutoff_that_cannot_be_is_refused() -> None:
    with pytest.raises(ConfigError, match="half the sampling rate"):
        ModelledTorqueEstimator(DirectEstimator(), ROBOT, "tool", PERIOD, cutoff=600.0)
