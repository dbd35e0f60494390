"""The account of one axis, as a value: what it forgets and how fast."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from pliant.controllers.passivity_account import ACCOUNT, Account, ErrorMotion, likely_step
from pliant.controllers.profiles import ForceProfile
from pliant.signals import ImpedanceTuning


def test_the_largest_surprise_decays_with_its_own_time() -> None:
    """A jump nobody expected is remembered for `surprise_time`, and not written off like a debt."""
    period, one = 1e-3, np.ones(1)
    profile = ForceProfile.of(ImpedanceTuning(500.0 * one, 50.0 * one, 0.3 * one))
    account = Account(period, one, one)
    state = account.init(profile, np.zeros(1))
    jumped = account.book(state, np.zeros(1), np.zeros(1), 0.01 * one, ErrorMotion(0.01 * one, np.zeros(1)))
    assert jumped.surprise[0] == pytest.approx(0.01)
    expected = 0.01
    for _ in range(20):
        jumped = account.book(jumped, 0.01 * one, np.zeros(1), 0.01 * one, ErrorMotion(0.01 * one, np.zeros(1)))
        expected *= math.exp(-period / ACCOUNT.surprise_time)
        assert jumped.surprise[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    "cycle", [[0.3, -0.3], [0.3, -0.4, 0.1], [0.1, 0.3, -0.2, -0.2], [1.0, -0.2, -0.2, -0.2, -0.4]]
)
def test_a_step_that_comes_again_is_foreseen(cycle: list[float]) -> None:
    """mm a period: cycles of 2 to 4 periods are known after a few rounds."""
    one, error = np.ones(1), np.zeros(1)
    profile = ForceProfile.of(ImpedanceTuning(500.0 * one, 50.0 * one, 0.3 * one))
    account = Account(1e-3, one, one)
    state = account.init(profile, error)
    for tick in range(40 * len(cycle)):
        moved = error + 1e-3 * cycle[tick % len(cycle)]
        state = account.book(state, error, np.zeros(1), moved, ErrorMotion(moved, np.zeros(1)))
        error = moved
    assert likely_step(state)[0] == pytest.approx(1e-3 * cycle[0], abs=1e-9)


def test_a_smooth_motion_is_foreseen_by_its_change() -> None:
    one = np.ones(1)
    profile = ForceProfile.of(ImpedanceTuning(500.0 * one, 50.0 * one, 0.3 * one))
    account = Account(1e-3, one, one)
    errors = 0.02 * np.sin(2.0 * math.pi * 5.0 * 1e-3 * np.arange(400))[:, None]
    state = account.init(profile, errors[0])
    for last, error in pairwise(errors[:-1]):
        state = account.book(state, last, np.zeros(1), error, ErrorMotion(error, np.zeros(1)))
    assert likely_step(state)[0] == pytest.approx((errors[-1] - errors[-2])[0], rel=0.01)
