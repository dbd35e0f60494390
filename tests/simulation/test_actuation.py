"""Motors and gears: each effect alone against its formula."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from pliant.simulation.imperfections.actuation import ActuationConfig
from pliant.simulation.imperfections.chain import drawn_once
from pliant.simulation.imperfections.config import Imperfections
from tests.simulation.scripted import moving, readings

DT = 1e-3  # s
N = 3
STILL = np.zeros(N)


def run(config: ActuationConfig, motor: np.ndarray, v: np.ndarray = STILL, steps: int = 1, seed: int = 0) -> np.ndarray:
    """Torques (steps, N) under a constant motor torque."""
    plant = moving(N, v)
    readings(Imperfections(actuation=config), plant, [motor] * steps, seed)
    return np.array(plant.received)


def drawn(config: ActuationConfig, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Gain and bias (N,) of a run."""
    found = drawn_once(Imperfections(actuation=config), N, seed)
    return found["gain"], found["bias"]


def test_perfect_by_default() -> None:
    motor = np.array([1.0, -50.0, 3.0])
    assert np.array_equal(run(ActuationConfig(), motor, np.array([1.0, -2.0, 0.5]))[0], motor)


@pytest.mark.parametrize("bandwidth", [5.0, 20.0, 200.0])
def test_first_order_step_response_is_the_analytic_one_at_every_sample(bandwidth: float) -> None:
    response = run(ActuationConfig(bandwidth=bandwidth), np.full(N, 10.0), steps=200)[:, 0]
    t = DT * np.arange(1, 201)
    assert np.allclose(response, 10.0 * (1.0 - np.exp(-2.0 * np.pi * bandwidth * t)), rtol=1e-12)


def test_the_corner_frequency_attenuates_by_3_db() -> None:
    bandwidth, plant = 20.0, moving(1, np.zeros(1))
    t = DT * np.arange(4000)
    config = Imperfections(actuation=ActuationConfig(bandwidth=bandwidth))
    readings(config, plant, [np.array([u]) for u in np.sin(2.0 * np.pi * bandwidth * t)])
    assert np.abs(np.array(plant.received)[2000:]).max() == pytest.approx(np.sqrt(0.5), rel=0.06)


def test_friction_follows_its_formula_and_opposes_motion() -> None:
    config = ActuationConfig(dry_friction=1.0, friction_velocity=0.1, viscous_friction=(0.5, 0.0, 2.0))
    v = np.array([0.05, -0.3, 1.0])
    torque = run(config, np.zeros(N), v)[0]
    assert np.allclose(torque, -np.tanh(v / 0.1) - np.array([0.5, 0.0, 2.0]) * v, rtol=1e-14)
    assert np.all(torque * v < 0.0)


def test_gain_and_bias_are_drawn_once_per_run_uniformly_within_their_ranges() -> None:
    config = ActuationConfig(gain=(0.8, 1.2), bias=(-2.0, 2.0))
    gains, biases = (np.concatenate(values) for values in zip(*(drawn(config, s) for s in range(400)), strict=True))
    for values, low, high in ((gains, 0.8, 1.2), (biases, -2.0, 2.0)):
        assert values.min() >= low
        assert values.max() <= high
        spread = (high - low) / np.sqrt(12.0)
        assert abs(values.mean() - 0.5 * (low + high)) < 5.0 * spread / np.sqrt(values.size)
        assert values.std() == pytest.approx(spread, rel=0.06)
    torque = run(config, np.full(N, 10.0), steps=3, seed=7)
    assert np.array_equal(torque[0], torque[2])  # a bias, not a noise
    gain, bias = drawn(config, 7)
    assert np.allclose(torque[0], gain * 10.0 + bias)


def test_the_peak_torque_clamps_before_the_gears_and_what_it_takes_is_visible() -> None:
    config = ActuationConfig(peak_torque=40.0, gain=(1.1, 1.1))
    plant = moving(N, STILL)
    reading = readings(Imperfections(actuation=config), plant, [np.array([60.0, -45.0, 10.0])])[-1]
    assert np.allclose(plant.received[0], 1.1 * np.array([40.0, -40.0, 10.0]))
    assert np.allclose(reading.torque_sent, [40.0, -40.0, 10.0])


def test_torque_noise_has_its_standard_deviation() -> None:
    noise = run(ActuationConfig(noise=(0.1, 0.0, 0.3)), np.zeros(N), steps=4000)
    assert np.allclose(noise.std(axis=0), [0.1, 0.0, 0.3], rtol=0.06)


def test_switching_one_draw_off_leaves_the_others_unchanged() -> None:
    full = ActuationConfig(gain=(0.8, 1.2), bias=(-2.0, 2.0), noise=0.1)
    (gain, bias), (_, same_bias), (same_gain, _) = (
        drawn(config, 11)
        for config in (full, full.model_copy(update={"gain": (1.0, 1.0)}), full.model_copy(update={"noise": 0.0}))
    )
    assert np.array_equal(bias, same_bias)
    assert np.array_equal(gain, same_gain)
    assert not np.array_equal(gain, np.ones(N))


def test_bad_values_are_refused() -> None:
    with pytest.raises(ValidationError, match="from low to high"):
        ActuationConfig(gain=(1.2, 0.8))
    with pytest.raises(ValidationError):
        ActuationConfig(dry_friction=-1.0)
    with pytest.raises(ValidationError):
        ActuationConfig(bandwith=20.0)  # type: ignore[call-arg]  # a typing slip is an error
