"""Stiffness and damping are found over the whole range of contacts, followed when they change, kept at standstill."""

from __future__ import annotations

import numpy as np
import pytest

from pliant import loop
from pliant.controllers.operational_space import OperationalSpace
from pliant.errors import ConfigError, RobotError
from pliant.estimation import EnvironmentEstimator, EnvironmentFit, FitConfig, WrenchEstimator
from pliant.estimation.environment_fit import FitState
from pliant.interfaces import ReferenceSource
from pliant.robot import Robot, Tool
from pliant.signals import Estimate, Reference, TaskReference
from pliant.simulation import ForceSensor, MujocoPlant, Scene, Surface, table

PERIOD = 1e-3
STIFFNESSES = [3e2, 1e3, 3e3, 1e4, 1e5, 1e6]
NOISE_FORCE = 0.02  # N


def damping_of(K: float) -> float:
    return 0.01 * K  # N s/m; a corner of 16 Hz


def samples(K: float, B: float, seconds: float, *, moving: bool = True, relative_noise: float = 0.002, seed: int = 0):
    """Force, depth and rate of a tool that presses 20 N, plus 8 N up and down with two frequencies if it moves.

    The noise of the motion is a share of 8 N / K, for a position noise in metres that hides 1e6 N/m would hide it from
    any method.
    """
    draw, t = np.random.default_rng(seed), np.arange(0.0, seconds, PERIOD)
    amplitude = 8.0 / K
    w = 2 * np.pi * np.array([1.5, 7.0])
    depth, rate = np.full(t.size, 20.0 / K), np.zeros(t.size)
    if moving:
        for omega, share in zip(w, (0.7, 0.3), strict=True):
            depth = depth + share * amplitude * np.sin(omega * t)
            rate = rate + share * amplitude * omega * np.cos(omega * t)
    force = K * depth + B * rate + NOISE_FORCE * draw.normal(size=t.size)
    depth = 0.4 + depth + relative_noise * amplitude * draw.normal(size=t.size)  # the zero of the depth is unknown
    rate = rate + relative_noise * amplitude * w[1] * draw.normal(size=t.size)
    return zip(force, depth, rate, strict=True)


def run(fit: EnvironmentFit, *parts, state: FitState | None = None) -> list[FitState]:
    state, states = state or FitState(), []
    for part in parts:
        for force, depth, rate in part:
            state = fit.step(force, depth, rate, state)
            states.append(state)
    return states


@pytest.mark.parametrize("K", STIFFNESSES)
def test_stiffness_and_damping_are_found(K: float) -> None:
    states = run(EnvironmentFit(FitConfig(least_motion=0.0), PERIOD), samples(K, damping_of(K), 1.0))
    found = states[-1].found
    assert found is not None
    assert found.stiffness == pytest.approx(K, rel=0.03)
    assert found.damping == pytest.approx(damping_of(K), rel=0.1)
    early = states[300].found  # within 0.3 s it is good enough to act on
    assert early is not None
    assert early.stiffness == pytest.approx(K, rel=0.1)


@pytest.mark.parametrize("K", [3e2, 1e4, 1e6])
def test_without_noise_it_is_exact(K: float) -> None:
    part = [(K * p + damping_of(K) * r, p + 0.4, r) for _, p, r in exact(K)]
    found = run(EnvironmentFit(FitConfig(), PERIOD), part)[-1].found
    assert found is not None
    assert found.stiffness == pytest.approx(K, rel=1e-5)
    assert found.damping == pytest.approx(damping_of(K), rel=1e-5)


def exact(K: float):
    t = np.arange(0.0, 0.6, PERIOD)
    p = 20.0 / K + 8.0 / K * np.sin(20.0 * t)
    return zip(t, p, 8.0 / K * 20.0 * np.cos(20.0 * t), strict=True)


def test_a_change_of_the_surface_is_followed() -> None:
    soft, stiff = samples(1e3, 10.0, 0.8), samples(5e3, 50.0, 1.2, seed=1)
    fit = EnvironmentFit(FitConfig(memory=150), PERIOD)
    found = run(fit, soft, [(0.0, 0.0, 0.0)], stiff)[-1].found  # lifted between the two
    assert found is not None
    assert found.stiffness == pytest.approx(5e3, rel=0.05)


def test_the_belief_is_kept_at_standstill() -> None:
    K, B = 1e4, 100.0
    fit = EnvironmentFit(FitConfig(), PERIOD)
    moved = run(fit, samples(K, B, 1.0))[-1]
    # still, but noisy in position: all that is new is noise
    stood = run(fit, samples(K, B, 3.0, moving=False, relative_noise=0.02, seed=2), state=moved)[-1]
    assert stood.found is not None
    assert stood.found.stiffness == pytest.approx(K, rel=0.03)
    assert stood.covariance[0, 0] > 0.5 * moved.covariance[0, 0]  # nothing is forgotten


def test_ungated_standstill_would_lose_it() -> None:
    """Baseline: with every sample used, and shown however inaccurate, noise replaces what was learnt."""
    K, B = 1e4, 100.0
    fit = EnvironmentFit(FitConfig(least_force=0.0, least_motion=0.0, accuracy=1e9), PERIOD)
    moved = run(fit, samples(K, B, 1.0))[-1]
    stood = run(fit, samples(K, B, 3.0, moving=False, relative_noise=0.02, seed=2), state=moved)[-1]
    assert stood.found is not None
    assert abs(stood.found.stiffness - K) > 0.3 * K


def test_position_noise_biases_as_documented() -> None:
    K = 1e4
    fit = EnvironmentFit(FitConfig(cutoff=400.0, memory=1e5, least_force=0.0, least_motion=0.0), PERIOD)
    t = np.arange(0.0, 4.0, PERIOD)
    draw, sigma, amplitude = np.random.default_rng(0), 2e-4, 8e-4
    depth, rate = 2e-3 + amplitude * np.sin(20.0 * t), amplitude * 20.0 * np.cos(20.0 * t)
    part = zip(K * depth, depth + sigma * draw.normal(size=t.size), rate, strict=True)
    found = run(fit, part)[-1].found
    assert found is not None
    expected = K / (1.0 + sigma**2 / (amplitude**2 / 2.0))
    assert found.stiffness == pytest.approx(expected, rel=0.03)
    assert expected < 0.9 * K


def hidden(K: float, config: FitConfig, sigma: float = 2e-4) -> float | None:
    """K found from a depth with white noise of `sigma` m, a force of 20 ± 8 N."""
    t = np.arange(0.0, 4.0, PERIOD)
    p, rate = (20.0 + 8.0 * np.sin(20.0 * t)) / K, 160.0 * np.cos(20.0 * t) / K
    depth = p + sigma * np.random.default_rng(3).normal(size=t.size)
    found = run(EnvironmentFit(config, PERIOD), zip(K * p, depth, rate, strict=True))[-1].found
    return None if found is None else found.stiffness


def test_known_noise_does_not_bias_and_hides_what_it_hides() -> None:
    config = FitConfig(memory=3000.0, cutoff=100.0, least_motion=0.0)
    knowing = config.model_copy(update={"noise_depth": 2e-4})
    assert hidden(1e4, knowing) == pytest.approx(1e4, rel=0.02)
    assert hidden(1e6, knowing) is None  # 8 µm behind 0.2 mm
    blind = hidden(1e4, config)  # baseline
    assert blind is not None
    assert blind < 0.98 * 1e4


class Pump(ReferenceSource[None]):
    """Presses on a table, deeper and less deep."""

    def __init__(self, robot: Robot, deep: float) -> None:
        self.position, self.rotation = robot.placement(robot.home, "tool")
        self.posture, self.deep = robot.home, deep

    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, state: None) -> tuple[Reference, None]:
        t = estimate.time
        depth = self.deep * (1.0 + 0.5 * np.sin(12.0 * t) + 0.2 * np.sin(40.0 * t))
        task = TaskReference("tool", self.position - [0.0, 0.0, depth], self.rotation)
        return Reference(t, (task,), self.posture), None


@pytest.mark.parametrize("K", [3e3, 3e4])
def test_a_table_in_the_simulator_is_found(K: float) -> None:
    robot = Robot.load("iiwa14", tool=Tool()).with_contact("tool", 0.015)
    height = robot.placement(robot.home, "tool")[0][2] - 0.015
    scene = Scene((table((0.6, 0.0, height), surface=Surface(K, 300.0, 0.3)),))
    plant = MujocoPlant(robot, scene, sensors=[ForceSensor("tool")])
    estimator = EnvironmentEstimator(WrenchEstimator(robot), robot, "tool", PERIOD)
    ticks = []
    loop.run(plant, estimator, Pump(robot, 0.02), OperationalSpace(robot, "tool"), range(900), [ticks.append])
    found = ticks[-1].estimate.environments["tool"]
    assert found.stiffness == pytest.approx(K, rel=0.05)
    assert found.damping == pytest.approx(300.0, rel=0.15)
    assert "tool" not in ticks[0].estimate.environments  # nothing is believed before it is known


def test_bad_input_is_named(lwr4: Robot) -> None:
    with pytest.raises(ConfigError, match="half the sampling rate"):
        EnvironmentEstimator(WrenchEstimator(lwr4), lwr4, "flange", 0.02)
    with pytest.raises(RobotError, match="no frame"):
        EnvironmentEstimator(WrenchEstimator(lwr4), lwr4, "tol", PERIOD)


def crossing(fit: EnvironmentFit) -> float:
    """K that is found while a force of 20 ± 4 N at 15 Hz slides over a table that falls by 50 mm/s."""
    t, K = np.arange(0.0, 2.0, PERIOD), 1e4
    p, rate = (20.0 + 4.0 * np.sin(94.0 * t)) / K, 4.0 * 94.0 * np.cos(94.0 * t) / K
    found = run(fit, zip(K * p, p + 0.05 * t, rate + 0.05, strict=True))[-1].found
    return 0.0 if found is None else found.stiffness


def test_a_drift_of_the_depth_is_taken_off() -> None:
    config = FitConfig(least_force=0.0, least_motion=0.0, memory=150.0, accuracy=1e9)
    assert crossing(EnvironmentFit(config.model_copy(update={"drift": 8.0}), PERIOD)) == pytest.approx(1e4, rel=0.03)
    assert abs(crossing(EnvironmentFit(config, PERIOD)) - 1e4) > 0.3 * 1e4  # control: a tilt looks like a soft table
