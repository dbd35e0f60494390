"""Filters: gain, phase and steps against exact answers; the wrapper filters what it is told to and nothing else."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import signal

from pliant.errors import ConfigError
from pliant.estimation import Butterworth, DirectEstimator, FilteredEstimator, FirstOrder
from pliant.signals import Measurement

PERIOD = 1e-3


def output(low_pass, values):
    state, out = low_pass.init(values[0]), []
    for value in values:
        filtered, state = low_pass.step(value, state)
        out.append(filtered)
    return np.array(out)


def gain_at(low_pass, frequency: float) -> float:
    t = np.arange(0.0, 2.0, PERIOD)
    out = output(low_pass, np.sin(2 * np.pi * frequency * t)[:, None])[1000:, 0]
    return float(np.sqrt(2.0 * np.mean(out**2)))


@pytest.mark.parametrize("cutoff", [5.0, 40.0, 200.0])
def test_butterworth_is_scipys(cutoff: float) -> None:
    values = np.random.default_rng(0).normal(size=(300, 2))
    values[0] = 0.0
    b, a = signal.butter(2, cutoff, fs=1.0 / PERIOD)
    np.testing.assert_allclose(
        output(Butterworth(cutoff, PERIOD), values), signal.lfilter(b, a, values, axis=0), atol=1e-12
    )


def test_gain_at_the_cutoff_and_far_above() -> None:
    assert gain_at(Butterworth(20.0, PERIOD), 20.0) == pytest.approx(1 / math.sqrt(2), abs=1e-3)
    assert gain_at(Butterworth(20.0, PERIOD), 100.0) == pytest.approx(1 / 25, rel=0.15)  # 40 dB per decade
    assert gain_at(FirstOrder(20.0, PERIOD), 100.0) == pytest.approx(1 / 5, rel=0.1)  # baseline: 20 dB per decade


def test_first_order_hits_the_continuous_step_response() -> None:
    values = np.ones((50, 1))
    values[0] = 0.0
    out = output(FirstOrder(10.0, PERIOD), values)[:, 0]
    np.testing.assert_allclose(out, 1.0 - np.exp(-2 * np.pi * 10.0 * PERIOD * np.arange(50)), atol=1e-12)


@pytest.mark.parametrize("low_pass", [FirstOrder(7.0, PERIOD), Butterworth(7.0, PERIOD)])
def test_starts_without_a_transient(low_pass) -> None:
    constant = np.full((20, 3), 4.2)
    np.testing.assert_allclose(output(low_pass, constant), constant, rtol=1e-12)


def measurement(tick: int, v: float, force: float) -> Measurement:
    return Measurement(
        tick * PERIOD, np.zeros(2), np.full(2, v), np.full(2, 3.0 * v), np.zeros(2), {"tool": np.full(6, force)}
    )


def test_estimator_filters_what_it_is_told_to() -> None:
    estimator = FilteredEstimator(DirectEstimator(), velocity=FirstOrder(10.0, PERIOD))
    state = estimator.init(measurement(0, 0.0, 0.0))
    for tick in range(20):
        estimate, state = estimator.step(measurement(tick, float(tick > 0), 1.0), state)
    assert 0.5 < estimate.v[0] < 0.8
    assert estimate.torque[0] == 3.0  # no filter given


@pytest.mark.parametrize(("cutoff", "period"), [(0.0, PERIOD), (1.0, math.nan), (500.0, PERIOD)])
def test_bad_input_is_named(cutoff: float, period: float) -> None:
    with pytest.raises(ConfigError, match="cutoff"):
        Butterworth(cutoff, period)
