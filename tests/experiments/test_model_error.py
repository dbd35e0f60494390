"""Masses that a controller's model has wrong: by how much, to which side, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.errors import ConfigError
from pliant.experiments.model_error import with_mass_error
from pliant.robot import Robot


def test_each_link_is_off_to_either_side_by_the_share_at_most(lwr4: Robot) -> None:
    share, factors = 0.2, []
    for seed in range(40):
        wrong = with_mass_error(lwr4, share, np.random.default_rng(seed))
        for joint in range(1, lwr4.model.njoints):
            true, believed = lwr4.model.inertias[joint], wrong.model.inertias[joint]
            factors.append(believed.mass / true.mass)
            np.testing.assert_allclose(believed.inertia, factors[-1] * true.inertia, atol=1e-12)
            np.testing.assert_array_equal(believed.lever, true.lever)
    assert 0.8 <= min(factors) < 0.82
    assert 1.18 < max(factors) <= 1.2
    assert np.mean(factors) == pytest.approx(1.0, abs=0.02)


def test_none_changes_nothing_and_draws_nothing(lwr4: Robot) -> None:
    rng = np.random.default_rng(0)
    assert with_mass_error(lwr4, 0.0, rng) is lwr4
    assert rng.uniform() == np.random.default_rng(0).uniform()
    with pytest.raises(ConfigError, match="got 1"):
        with_mass_error(lwr4, 1.0, rng)
