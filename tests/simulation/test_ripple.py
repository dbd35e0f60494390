"""Gearing ripple: pitch follows speed, size follows force and speed, and nothing happens at rest."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.simulation.imperfections.config import Imperfections
from pliant.simulation.imperfections.ripple import RippleConfig
from tests.simulation.scripted import moving, readings

DT = 1e-3  # s
CONFIG = RippleConfig(amplitude=2.0, frequency=35.0, speed=0.35, force=50.0)
WRENCH = np.array([0.0, 0.0, 50.0, 0.1, 0.0, 0.0])


def ripple(speed: float, wrench: np.ndarray = WRENCH, config: RippleConfig = CONFIG, steps: int = 4000) -> np.ndarray:
    """What is added to the normal force, (steps,) N."""
    plant = moving(2, np.array([speed, 0.0]), wrench)
    log = readings(Imperfections(ripple=config), plant, [np.zeros(2)] * steps)
    return np.array([reading.wrenches["tool"][2] - wrench[2] for reading in log[1:]])


def peak_frequency(signal: np.ndarray) -> float:
    spectrum = np.abs(np.fft.rfft(signal * np.hanning(signal.size)))
    return float(np.fft.rfftfreq(signal.size, DT)[np.argmax(spectrum)])


@pytest.mark.parametrize("speed", [0.30, 0.35, 0.40, 0.70])
def test_frequency_is_proportional_to_speed_and_30_to_40_hz_while_polishing(speed: float) -> None:
    frequency = peak_frequency(ripple(speed))
    assert frequency == pytest.approx(35.0 * speed / 0.35, abs=0.3)
    if speed <= 0.40:
        assert 29.5 <= frequency <= 40.5


def test_amplitude_grows_with_force_and_speed() -> None:
    amplitude = np.abs(ripple(0.35)).max()
    assert amplitude == pytest.approx(2.0, rel=0.01)
    assert np.abs(ripple(0.70)).max() == pytest.approx(2.0 * amplitude, rel=0.01)
    assert np.abs(ripple(0.35, 0.5 * WRENCH)).max() == pytest.approx(0.5 * amplitude, rel=0.01)


def test_no_ripple_at_rest_without_force_or_switched_off() -> None:
    assert not ripple(0.0, steps=50).any()
    assert not ripple(0.35, np.zeros(6), steps=50).any()
    assert not ripple(0.35, config=RippleConfig(), steps=50).any()


def test_the_true_wrench_is_not_changed() -> None:
    wrench = WRENCH.copy()
    ripple(0.35, wrench, steps=10)
    assert np.array_equal(wrench, WRENCH)
