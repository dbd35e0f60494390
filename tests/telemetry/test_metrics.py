"""Metrics against values worked out by hand, and against the laws that hold for any signal."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from pliant.errors import ShapeError
from pliant.telemetry import contact_metrics, in_parts, metrics

T_S = 1e-3  # s
finite = st.floats(-1e3, 1e3).map(lambda x: round(x, 9))  # squares of tinier numbers would vanish
series = arrays(np.float64, st.integers(2, 40), elements=finite)


def test_errors_by_hand() -> None:
    actual = np.array([[1.0, 0.0], [3.0, 0.0], [-1.0, 3.0], [-3.0, -3.0]])
    reference = np.zeros((4, 2))
    np.testing.assert_allclose(metrics.rmse(actual, reference), [math.sqrt(5.0), math.sqrt(4.5)])
    assert metrics.rms_error(actual, reference) == pytest.approx(math.sqrt(4.75))
    assert metrics.mae(actual, reference) == pytest.approx(14.0 / 8.0)
    assert metrics.max_error(actual, reference) == 3.0


@given(series)
def test_mean_is_below_rms_is_below_maximum(values: np.ndarray) -> None:
    zero = np.zeros_like(values)
    mae, rms, largest = metrics.mae(values, zero), metrics.rms_error(values, zero), metrics.max_error(values, zero)
    assert mae <= rms * (1 + 1e-12) + 1e-300
    assert rms <= largest * (1 + 1e-12) + 1e-300


@given(series, finite)
def test_an_error_does_not_depend_on_the_origin(values: np.ndarray, shift: float) -> None:
    reference = np.linspace(-1.0, 1.0, values.size)
    moved = metrics.rms_error(values + shift, reference + shift)
    assert moved == pytest.approx(metrics.rms_error(values, reference), abs=1e-9)


def test_torque_variation_of_a_ramp_is_its_slope_and_of_chatter_its_jump() -> None:
    time = np.arange(100) * T_S
    ramp = np.stack((50.0 * time, -150.0 * time), axis=1)  # 50 and 150 N·m/s
    assert metrics.torque_variation(ramp, T_S) == pytest.approx(100.0)
    chatter = np.tile([[1.0], [-1.0]], (50, 1))
    assert metrics.torque_variation(chatter, T_S) == pytest.approx(2.0 / T_S)


def test_torque_step_is_relative_to_the_joints_own_limit() -> None:
    torque = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, -9.0], [10.0, -9.0]])
    assert metrics.torque_step_fraction(torque, np.array([100.0, 30.0])) == pytest.approx(0.3)
    assert metrics.torque_step_fraction(torque, np.array([20.0, 30.0])) == pytest.approx(0.5)
    assert metrics.peak(torque) == 10.0


def test_switch_rate_counts_changes_per_second_and_axis() -> None:
    phase = np.zeros((1001, 2))
    phase[500:, 0] = 1.0  # one switch in one second on one of two axes
    assert metrics.switch_rate(phase, T_S) == pytest.approx(0.5)
    assert metrics.switch_rate(phase[:, 0].astype(bool), T_S) == pytest.approx(1.0)


def test_storage_margin_tells_a_passive_port_from_an_active_one() -> None:
    supplied = np.array([0.0, 1.0, 2.0, 1.5])
    assert metrics.storage_margin(supplied, 5.0 + 0.9 * supplied) >= 0.0
    assert metrics.storage_margin(supplied, 5.0 + 1.2 * supplied) == pytest.approx(-0.4)


def test_breaks_are_counted_and_timed() -> None:
    force = np.array([0.0, 0.0, 5.0, 5.0, 0.0, 5.0, 1e-3, 1e-3, 5.0, 5.0])
    assert contact_metrics.contact_breaks(force) == 2
    assert contact_metrics.break_share(force) == pytest.approx(0.5)
    assert contact_metrics.contact_breaks(np.full(5, 3.0)) == 0
    assert contact_metrics.contact_breaks(-force) == 0  # a pull is no contact


def first_order(constant: float, end: float = 2.0) -> tuple[np.ndarray, np.ndarray]:
    """40 N → 80 N from t = 1 s on, in a given time constant."""
    time = np.arange(0.0, 1.0 + end, T_S)
    return time, np.where(time < 1.0, 40.0, 80.0 - 40.0 * np.exp(-(time - 1.0) / constant))


@given(st.floats(0.01, 0.3), st.floats(0.01, 0.2))
def test_settling_time_of_a_first_order_lag(constant: float, band: float) -> None:
    time, value = first_order(constant, end=3.0)
    expected = constant * math.log(1.0 / band)
    assert contact_metrics.settling_time(time, value, 80.0, 40.0, 1.0, band) == pytest.approx(expected, abs=1.01 * T_S)


def test_settling_counts_the_last_exit_and_admits_never() -> None:
    time, value = first_order(0.05)
    late = value.copy()
    late[2000] = 85.0  # out of the band once more, 1 s after the command
    assert contact_metrics.settling_time(time, late, 80.0, 40.0, 1.0) == pytest.approx(1.001)
    assert contact_metrics.settling_time(time, value + 3.0, 80.0, 40.0, 1.0) == math.inf
    assert contact_metrics.settling_time(time, np.where(time > 1.5, np.nan, value), 80.0, 40.0, 1.0) == math.inf
    assert contact_metrics.settling_time(time, np.full_like(time, 80.0), 80.0, 40.0, 1.0) == 0.0


def test_overshoot_has_the_direction_of_the_step() -> None:
    assert contact_metrics.overshoot(np.array([40.0, 90.0, 80.0]), 80.0, 40.0) == 10.0
    assert contact_metrics.overshoot(np.array([80.0, 15.0, 20.0]), 20.0, 80.0) == 5.0
    assert contact_metrics.overshoot(np.array([40.0, 79.0]), 80.0, 40.0) == 0.0


@given(arrays(np.float64, st.integers(1, 80), elements=finite), st.sampled_from([1, 3, 21]))
def test_moving_average_is_the_mean_of_its_window(values: np.ndarray, window: int) -> None:
    smooth = metrics.moving_average(values, window)
    for i in range(values.size):
        half = min(window // 2, i, values.size - 1 - i)
        assert smooth[i] == pytest.approx(values[i - half : i + half + 1].mean(), abs=1e-8)


def test_the_authors_variant_is_easier_than_the_true_one() -> None:
    noisy = 50.0 + np.random.default_rng(0).standard_normal(2000)
    reference = np.full(2000, 50.0)
    assert metrics.mae(metrics.moving_average(noisy), reference) < 0.5 * metrics.mae(noisy, reference)


def test_window_by_time() -> None:
    time = np.arange(10) * 0.1
    assert metrics.between(time, 0.3, 0.6).sum() == 3
    assert metrics.between(time, 0.3).sum() == 7


NAN = np.array([1.0, np.nan, 2.0])


@pytest.mark.parametrize(
    "result",
    [
        metrics.rms_error(NAN, np.zeros(3)),
        metrics.mae(NAN, np.zeros(3)),
        metrics.max_error(NAN, np.zeros(3)),
        metrics.peak(NAN),
        metrics.torque_variation(NAN, T_S),
        metrics.torque_step_fraction(NAN[:, None], np.ones(1)),
        contact_metrics.break_share(NAN),
        contact_metrics.contact_breaks(NAN),
        contact_metrics.overshoot(NAN, 1.0, 0.0),
        metrics.storage_margin(NAN, NAN),
    ],
)
def test_a_sample_that_is_not_finite_never_looks_good(result: float) -> None:
    assert math.isnan(result)


def test_shapes_that_do_not_fit() -> None:
    with pytest.raises(ShapeError, match="one shape"):
        metrics.rmse(np.zeros((3, 2)), np.zeros((4, 2)))
    with pytest.raises(ShapeError, match="window outside the run"):
        metrics.mae(np.zeros(0), np.zeros(0))
    with pytest.raises(ShapeError, match="two samples"):
        metrics.torque_variation(np.zeros((1, 7)), T_S)
    with pytest.raises(ShapeError, match="odd"):
        metrics.moving_average(np.zeros(5), 4)


def test_a_mean_over_steps_is_the_same_in_parts_that_begin_with_the_sample_before() -> None:
    """Control: parts that begin with their own first sample miss the step between them."""
    torque = np.array([[0.0], [1.0], [1.0], [9.0], [9.0], [10.0]])
    whole = metrics.torque_variation(torque, T_S)
    assert in_parts.of_steps(metrics.torque_variation, [(torque[:3],), (torque[2:],)], T_S) == pytest.approx(whole)
    assert in_parts.of_steps(metrics.torque_variation, [(torque[:3],), (torque[3:],)], T_S) < 0.5 * whole
    with pytest.raises(ShapeError, match="at least one sample"):
        in_parts.of_steps(metrics.torque_variation, [(torque[:1],)], T_S)
