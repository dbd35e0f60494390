"""Swing and spectral lines of signals whose answers are known."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pliant.errors import ShapeError
from pliant.telemetry.steadiness import largest_line, swing

PERIOD = 1e-3
TIME = np.arange(4000) * PERIOD
STILL = np.full(4000, 20.0)


def test_a_sine_is_found_with_its_amplitude() -> None:
    force = STILL + 0.6 * np.sin(2 * np.pi * 25.0 * TIME)
    assert largest_line(force, STILL, PERIOD) == pytest.approx(0.03, rel=1e-6)
    assert swing(force, STILL, PERIOD) == pytest.approx(0.03 / math.sqrt(2.0), rel=1e-6)


@given(frequency=st.floats(3.0, 99.0), share=st.floats(0.005, 0.2), phase=st.floats(0.0, 6.3))
def test_a_sine_between_two_steps_of_the_spectrum_shows_most_of_itself(
    frequency: float, share: float, phase: float
) -> None:
    force = STILL * (1.0 + share * np.sin(2 * np.pi * frequency * TIME + phase))
    assert 0.84 * share < largest_line(force, STILL, PERIOD) < 1.01 * share


def test_an_offset_and_a_slow_drift_are_no_line() -> None:
    drift = STILL + 3.0 + 0.2 * TIME
    assert largest_line(drift, STILL, PERIOD) < 0.003
    assert largest_line(STILL + np.sin(2 * np.pi * 150.0 * TIME), STILL, PERIOD) < 1e-3  # beyond the band


def test_what_happens_around_a_change_is_left_out() -> None:
    wanted = np.where(TIME < 2.0, 10.0, 20.0)
    force = wanted.copy()
    force[2000:2500] += 15.0  # the half second after the step
    assert swing(force, wanted, PERIOD) == 0.0
    force[2600:2700] += 15.0  # and the control: a hit inside a window
    assert swing(force, wanted, PERIOD) > 0.1


def test_a_ramp_has_no_window_and_gives_no_number() -> None:
    ramp = np.linspace(5.0, 25.0, 4000)
    assert math.isnan(swing(ramp, ramp, PERIOD))
    assert math.isnan(largest_line(ramp, ramp, PERIOD))


def test_no_force_is_asked_so_nothing_is_a_share_of_it() -> None:
    assert math.isnan(swing(STILL, np.zeros(4000), PERIOD))


def test_shapes_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ShapeError):
        swing(STILL, STILL[:-1], PERIOD)
    with pytest.raises(ShapeError, match="one signal"):
        swing(np.zeros((4, 2)), np.zeros((4, 2)), PERIOD)
