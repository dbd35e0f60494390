"""Energy that searched cycles draw from one sampled axis, with the account and, as a control, with the blend alone."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pliant.controllers.passivity_search import Draw, Sampling, search
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
    assert draw.settled < 2e-3  # J
    assert draw.total < 0.016  # what may be saved up and owed
    assert draw.force <= 1.0 + 1e-12
    control = drawn(profile, replace(Sampling(1e-3, 300.0), account=None))
    assert control.settled > 0.03
    assert control.total > 1.0


def test_a_knee_sharper_than_a_step_is_repaid_by_its_own_slope() -> None:
    """Repaid by K_0 alone, cycles across it drew 5 mJ each for as long as they went on."""
    assert drawn(profile_of(2107.0, 266.0, 0.0669, 0.06135), Sampling(1e-3, 300.0)).settled < 2e-3


@pytest.mark.parametrize("profile", [STIFF, SOFT, LEG], ids=["stiff", "soft", "leg"])
def test_a_cycle_draws_little_at_3_ms_and_100_m_s2(profile: ForceProfile) -> None:
    assert drawn(profile, Sampling(3e-3, 100.0)).settled < 8e-3
    assert drawn(profile, replace(Sampling(3e-3, 100.0), account=None)).settled > 0.03
