"""Energy that searched cycles draw from one sampled axis, with the account and, as a control, with the blend alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pliant.controllers.passivity_search import Draw, Sampling, energy_out, forces, search
from pliant.controllers.profiles import ForceProfile, Shape
from tests.laws.impedance_strategies import profile_of

STIFF = profile_of(20000.0, 150.0, 0.02, 0.006)
SOFT = profile_of(2500.0, 100.0, 0.06, 0.03)
LEG = profile_of(12000.0, 300.0, 0.025, shape=Shape.TANH)


def drawn(profile: ForceProfile, sampling: Sampling) -> Draw:
    return search(profile, sampling, histories=150, rounds=3, seed=5)


@pytest.mark.parametrize("profile", [STIFF, SOFT, LEG], ids=["stiff", "soft", "leg"])
def test_a_cycle_draws_little_at_1_kHz_and_300_m_s2(profile: ForceProfile) -> None:
    draw = drawn(profile, Sampling(1e-3, 300.0))
    assert draw.cycles > 3000
    assert draw.cycle < 1e-3  # J
    assert draw.total < 0.015  # what may be saved up and owed
    assert draw.force <= 1.0 + 1e-12
    control = drawn(profile, replace(Sampling(1e-3, 300.0), account=None))
    assert control.settled > 0.03
    assert control.total > 1.0


def test_a_knee_sharper_than_a_step_is_repaid_by_its_own_slope() -> None:
    """Repaid by K_0 alone, cycles across it drew 5 mJ each for as long as they went on."""
    assert drawn(profile_of(2107.0, 266.0, 0.0669, 0.06135), Sampling(1e-3, 300.0)).settled < 1e-3


@pytest.mark.parametrize(
    ("profile", "period", "start", "steps"),
    [
        (profile_of(5631.0, 95.7, 0.0129, 0.0111), 1e-3, 0.011328, (0.077, -0.129, -0.090, 0.142)),
        (profile_of(18258.9, 277.0, 0.0193, 0.0126), 3e-3, 0.012389, (0.336, -0.359, 0.023)),
    ],
    ids=["four periods", "three periods"],
)
def test_a_cycle_of_a_few_periods_is_foreseen(
    profile: ForceProfile, period: float, start: float, steps: tuple[float, ...]
) -> None:
    """Steps in mm. Guessed by their last change alone, they drew 1.1 and 11 mJ a cycle for as long as they lasted."""
    rounds = 100
    errors = start + 1e-3 * np.concatenate([[0.0], np.cumsum(np.tile(steps, rounds))])[:, None]
    half = len(steps) * (rounds // 2)

    def late(sampling: Sampling) -> float:
        out = energy_out(errors, forces(profile, sampling, errors)[0])
        return float(out[-1, 0] - out[half, 0]) / (rounds // 2)

    assert late(Sampling(period)) < 2e-4  # J a cycle
    assert late(Sampling(period, account=None)) > 1e-3  # baseline: the law with its blend


@pytest.mark.parametrize(
    "profile",
    [STIFF, SOFT, LEG],
    ids=["stiff", "soft", "leg"],
)
def test_a_cycle_draws_little_at_3_ms_and_100_m_s2(profile: ForceProfile) -> None:
    assert drawn(profile, Sampling(3e-3, 100.0)).cycle < 5e-3
    assert drawn(profile, replace(Sampling(3e-3, 100.0), account=None)).settled > 0.03
