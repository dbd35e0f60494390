"""Sensors: noise of the stated size, exact delay, and sources that do not disturb each other."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from pliant.errors import ConfigError, ShapeError
from pliant.signals import Measurement
from pliant.simulation.imperfections.config import Imperfections
from pliant.simulation.imperfections.link_config import per_joint
from pliant.simulation.imperfections.sensing import SensingConfig
from tests.simulation.scripted import Scripted, moving
from tests.simulation.scripted import readings as readings_of

N = 3
PERIOD = 1e-3  # s
DRAWS = 4000


def true_measurement(tick: int = 0) -> Measurement:
    return Measurement(
        time=tick * PERIOD,
        q=np.full(N, float(tick)),
        v=np.full(N, 10.0 + tick),
        torque=np.full(N, 30.0 + tick),
        torque_sent=np.full(N, 30.0 + tick),
        wrenches={"tool": np.full(6, 40.0 + tick)},
    )


def readings(config: SensingConfig, count: int, seed: int = 3) -> list[Measurement]:
    plant = Scripted(lambda tick, _: true_measurement(tick), N)
    sent = [np.full(N, 31.0 + tick) for tick in range(count - 1)]
    return readings_of(Imperfections(sensing=config), plant, sent, seed)


NOISY = SensingConfig(noise_q=1e-3, noise_v=2e-3, noise_torque=(0.03, 0.02, 0.01), noise_force=0.01, noise_moment=0.004)


def test_noise_has_the_stated_standard_deviation_zero_mean_and_no_memory() -> None:
    log = readings(NOISY, DRAWS)
    true = [true_measurement(tick) for tick in range(DRAWS)]
    channels = {
        "q": (np.array([r.q - t.q for r, t in zip(log, true, strict=True)]), 1e-3),
        "v": (np.array([r.v - t.v for r, t in zip(log, true, strict=True)]), 2e-3),
        "torque": (np.array([r.torque - t.torque for r, t in zip(log, true, strict=True)]), [0.03, 0.02, 0.01]),
        "wrench": (
            np.array([r.wrenches["tool"] - t.wrenches["tool"] for r, t in zip(log, true, strict=True)]),
            [0.01] * 3 + [0.004] * 3,
        ),
    }
    for name, (error, sigma) in channels.items():
        unit = error / sigma
        bound = 5.0 / np.sqrt(DRAWS)  # five standard errors
        assert np.abs(unit.mean(axis=0)).max() < bound, name
        assert np.abs(unit.std(axis=0) - 1.0).max() < bound, name
        assert np.abs((unit[1:] * unit[:-1]).mean(axis=0)).max() < bound, name


def test_noise_is_not_added_to_the_true_signal() -> None:
    true = true_measurement()
    readings_of(Imperfections(sensing=NOISY), Scripted(lambda *_: true, N), [np.zeros(N)] * 10)
    fresh = true_measurement()
    assert np.array_equal(true.q, fresh.q)
    assert np.array_equal(true.torque, fresh.torque)
    assert np.array_equal(true.wrenches["tool"], fresh.wrenches["tool"])


@pytest.mark.parametrize("ticks", [0, 1, 7])
def test_readings_are_exactly_the_delay_old(ticks: int) -> None:
    for now, reading in enumerate(readings(SensingConfig(delay=ticks * PERIOD), 20)):
        then = true_measurement(max(now - ticks, 0))
        assert np.array_equal(reading.q, then.q)
        assert np.array_equal(reading.wrenches["tool"], then.wrenches["tool"])
        # What the controller knows without a sensor is not late.
        assert reading.time == pytest.approx(now * PERIOD)
        assert np.array_equal(reading.torque_sent, true_measurement(now).torque_sent)


def test_the_same_seed_gives_the_same_readings_bit_for_bit_and_another_one_does_not() -> None:
    first, second, other = readings(NOISY, 50), readings(NOISY, 50), readings(NOISY, 50, seed=4)
    assert all(
        np.array_equal(a.q, b.q) and np.array_equal(a.torque, b.torque) for a, b in zip(first, second, strict=True)
    )
    assert not np.array_equal(first[0].q, other[0].q)


@pytest.mark.parametrize("off", ["noise_q", "noise_v", "noise_torque", "noise_force"])
def test_switching_one_source_off_leaves_the_other_draws_unchanged(off: str) -> None:
    with_all = readings(NOISY, 20)[-1]
    without = readings(NOISY.model_copy(update={off: 0.0}), 20)[-1]
    values = {
        "noise_q": (with_all.q, without.q),
        "noise_v": (with_all.v, without.v),
        "noise_torque": (with_all.torque, without.torque),
        "noise_force": (with_all.wrenches["tool"][:3], without.wrenches["tool"][:3]),
    }
    for name, (a, b) in values.items():
        assert np.array_equal(a, b) == (name != off), name


def test_sources_are_independent_of_each_other() -> None:
    log = readings(NOISY, DRAWS)
    q = np.array([r.q - t for t, r in enumerate(log)]) / 1e-3
    v = np.array([r.v - 10.0 - t for t, r in enumerate(log)]) / 2e-3
    assert np.abs((q * v).mean(axis=0)).max() < 5.0 / np.sqrt(DRAWS)


def test_torque_sensor_mismatch_is_a_constant_gain_and_offset_within_its_range() -> None:
    config = SensingConfig(torque_gain_error=0.1, torque_offset=0.5)
    log = np.array([r.torque for r in readings(config, 30)])
    true = np.array([true_measurement(t).torque for t in range(30)])
    for joint in range(N):
        gain, offset = np.polyfit(true[:, joint], log[:, joint], 1)
        assert 0.0 < abs(gain - 1.0) <= 0.1
        assert 0.0 < abs(offset) <= 0.5
        assert np.allclose(gain * true[:, joint] + offset, log[:, joint])


def test_bad_values_are_refused_with_the_rule() -> None:
    with pytest.raises(ValidationError, match="greater than or equal to 0"):
        SensingConfig(noise_q=-1.0)
    with pytest.raises(ValidationError):
        SensingConfig(noise_q=float("nan"))
    with pytest.raises(ConfigError, match="whole multiple"):
        readings(SensingConfig(delay=1.5e-3), 1)
    with pytest.raises(ShapeError, match="noise_q must have 3 entries"):
        readings(SensingConfig(noise_q=(1.0, 2.0)), 1)


@pytest.mark.parametrize("n", [3, 6, 7, 9])
def test_the_published_noise_fits_any_number_of_joints(n: int) -> None:
    config = Imperfections.p3().sensing
    noise = per_joint(config.noise_torque, n, "noise_torque", fitted=config.fit_joints)
    np.testing.assert_array_equal(noise, [0.03, 0.03, 0.02, 0.02, 0.01, 0.01, 0.01, 0.01, 0.01][:n])
    readings_of(Imperfections(sensing=config), moving(n, np.zeros(n)), [])
    if n != 6:
        fixed = config.model_copy(update={"fit_joints": False})
        with pytest.raises(ShapeError, match="noise_torque"):
            readings_of(Imperfections(sensing=fixed), moving(n, np.zeros(n)), [])
