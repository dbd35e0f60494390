"""Joint positions from velocities and positions: less noise, no lag, no drift."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.errors import ConfigError, SignalError
from pliant.estimation import DirectEstimator, FilteredEstimator, FirstOrder, JointStateFilter
from pliant.interfaces import Estimator
from pliant.signals import Measurement

PERIOD, N, SIGMA = 1e-3, 3, 1e-3  # s, joints, rad


def measured(tick: int, rng: np.random.Generator, velocity_error: float = 0.0, noise: float = SIGMA) -> Measurement:
    time = tick * PERIOD
    q, v = np.full(N, np.sin(3.0 * time)), np.full(N, 3.0 * np.cos(3.0 * time))
    return Measurement(time, q + noise * rng.standard_normal(N), v + velocity_error, np.zeros(N), np.zeros(N))


def errors(estimator: Estimator, ticks: int = 6000, **changes: float) -> np.ndarray:
    """(ticks, n) rad, estimated minus true."""
    rng = np.random.default_rng(2)
    state = estimator.init(measured(0, rng, **changes))
    found = []
    for tick in range(ticks):
        estimate, state = estimator.step(measured(tick, rng, **changes), state)
        found.append(estimate.q - np.sin(3.0 * tick * PERIOD))
    return np.array(found)


def test_noise_shrinks_as_the_docstring_says() -> None:
    """σ_q √(a/(2 − a)); baseline: no filter."""
    gain = PERIOD / 0.3
    settled = errors(JointStateFilter(DirectEstimator(), 0.3))[1500:]
    assert settled.std() == pytest.approx(SIGMA * np.sqrt(gain / (2.0 - gain)), rel=0.25)
    assert errors(DirectEstimator())[1500:].std() == pytest.approx(SIGMA, rel=0.05)


def test_there_is_no_lag() -> None:
    """Without noise the moving joint is followed to the error of the trapezium; baseline: a low-pass of the same
    memory lags."""
    assert np.abs(errors(JointStateFilter(DirectEstimator(), 0.3), noise=0.0)).max() < 1e-6
    q, lag = 0.0, 0.0
    for tick in range(3000):
        now = np.sin(3.0 * tick * PERIOD)
        q += PERIOD / 0.3 * (now - q)
        lag = max(lag, abs(q - now))
    assert lag > 0.3


def test_a_velocity_error_shifts_it_by_the_memory() -> None:
    """A constant error b of v shifts q̂ by b · memory, and no further: nothing drifts."""
    found = errors(JointStateFilter(DirectEstimator(), 0.1), noise=0.0, velocity_error=0.01)
    np.testing.assert_allclose(found[-1], 0.01 * 0.1, rtol=0.02)


def test_the_first_readings_are_averaged() -> None:
    found = np.abs(errors(JointStateFilter(DirectEstimator(), 10.0), ticks=200)[-1])
    assert found.max() < 4.0 * SIGMA / np.sqrt(200)


def test_other_signals_pass_and_bad_input_is_named() -> None:
    rng = np.random.default_rng(0)
    inner = FilteredEstimator(DirectEstimator(), velocity=FirstOrder(50.0, PERIOD))
    estimator = JointStateFilter(inner, 0.3)
    state = estimator.init(measured(0, rng))
    estimate, after = estimator.step(measured(5, rng), state)
    np.testing.assert_array_equal(estimate.torque, 0.0)
    with pytest.raises(SignalError, match="in order"):
        estimator.step(measured(4, rng), after)
    for memory in (0.0, -1.0, float("nan")):
        with pytest.raises(ConfigError, match="above zero"):
            JointStateFilter(inner, memory)
