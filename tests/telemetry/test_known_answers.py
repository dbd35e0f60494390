"""Every function of the metrics against a value worked out by hand, on ten samples with unequal axes.

A function that is added has no answer here at first: the test that compares names fails until it has one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from pliant.telemetry import contact_metrics, metrics
from tests.telemetry.own_functions import functions_of
from tests.telemetry.ten_samples import K, columns

PAIR = (columns(K, -2.0 * K), columns(1.0, 0.0))
"""(10, 2) actual and reference: errors k − 1 and −2 k. Σ k = 45, Σ k² = 285, Σ (k − 1)² = 285 − 90 + 10 = 205"""


FUNCTIONS: Mapping[str, tuple[Callable[[], Any], Any]] = {
    "between": (lambda: metrics.between(0.1 * K, 0.3, 0.6).nonzero()[0].tolist(), [3, 4, 5]),
    "rmse": (lambda: metrics.rmse(*PAIR), [math.sqrt(20.5), math.sqrt(4.0 * 28.5)]),
    "rms_error": (lambda: metrics.rms_error(*PAIR), math.sqrt((205.0 + 4.0 * 285.0) / 20.0)),
    "mae": (lambda: metrics.mae(*PAIR), (37.0 + 90.0) / 20.0),  # Σ |k − 1| = 1 + Σ 0…8 = 37
    "error_of": (lambda: metrics.error_of(*PAIR)[3], [2.0, -6.0]),
    "some_values": (lambda: metrics.some_values([1, 2]), [1.0, 2.0]),
    "max_error": (lambda: metrics.max_error(*PAIR), 18.0),
    "moving_average": (
        lambda: metrics.moving_average(columns(K**2, -K), 3)[[0, 4, 9]],
        [[0.0, 0.0], [(9.0 + 16.0 + 25.0) / 3.0, -4.0], [81.0, -9.0]],
    ),
    "torque_variation": (lambda: metrics.torque_variation(columns(K**2, -K), 0.5), (9.0 + 1.0) / 2.0 / 0.5),
    "peak": (lambda: metrics.peak(columns(K, -2.0 * K)), 18.0),
    "torque_step_fraction": (
        lambda: metrics.torque_step_fraction(columns(K**2, -3.0 * K), np.array([170.0, 20.0])),
        3.0 / 20.0,  # not 17/170
    ),
    "switch_rate": (lambda: metrics.switch_rate(columns(K > 3, 0.0), 0.5), 1.0 / 9.0 / 2.0 / 0.5),
    "storage_margin": (lambda: metrics.storage_margin(7.0 + K, 3.0 + 1.5 * K), -4.5),
    "break_share": (lambda: contact_metrics.break_share(K - 3.0), 0.4),
    "contact_breaks": (lambda: contact_metrics.contact_breaks(np.array([0, 2, 2, 0, 0, 3, -1, 4, 4, 0.0])), 3.0),
    "settling_time": (
        lambda: contact_metrics.settling_time(
            0.1 * K, np.array([4, 4, 5, 7, 9, 8.3, 8.1, 7.9, 8.1, 8.0]), 8.0, 4.0, 0.2
        ),
        0.4,  # within 0.2 of 8 from 0.6 s on, 0.4 s after the command
    ),
    "overshoot": (lambda: contact_metrics.overshoot(np.array([4, 9, 8.0]), 8.0, 4.0), 1.0),
}
"""function of `telemetry/metrics.py` or `contact_metrics.py` → call, answer"""


def test_every_function_has_a_known_answer() -> None:
    assert functions_of(metrics, contact_metrics) == set(FUNCTIONS)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_function(name: str) -> None:
    call, answer = FUNCTIONS[name]
    np.testing.assert_allclose(call(), answer, rtol=1e-12)
