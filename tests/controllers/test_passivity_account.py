"""The account of one axis, as a value: what it forgets and how fast."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pliant.controllers.passivity_account import ACCOUNT, Account, Motion
from pliant.controllers.profiles import ForceProfile
from pliant.signals import ImpedanceTuning


def test_the_largest_surprise_decays_with_its_own_time() -> None:
    """A jump nobody expected is remembered for `peak_time`, and not written off like a debt."""
    period, one = 1e-3, np.ones(1)
    profile = ForceProfile.of(ImpedanceTuning(500.0 * one, 50.0 * one, 0.3 * one))
    account = Account(period, one, one)
    state = account.init(profile, np.zeros(1))
    jumped = account.book(state, np.zeros(1), np.zeros(1), 0.01 * one, Motion(0.01 * one, np.zeros(1)))
    assert jumped.surprise[0] == pytest.approx(0.01)
    expected = 0.01
    for _ in range(20):
        jumped = account.book(jumped, 0.01 * one, np.zeros(1), 0.01 * one, Motion(0.01 * one, np.zeros(1)))
        expected *= math.exp(-period / ACCOUNT.peak_time)
        assert jumped.surprise[0] == pytest.approx(expected, rel=1e-9)
