"""Every case of every study begins as it was recorded, with each controller of its rows."""

from __future__ import annotations

import pytest

from tests.regression.short_runs import TOLERANCE, begun, moved, recorded, starts

STARTS = {name: (study, config) for name, study, config in starts()}
RECORDED = recorded()
NOISY = "polishing/tables-2-3-4-delayed/offset-free-mpc"


@pytest.mark.parametrize("name", STARTS)
def test_it_begins_as_recorded(name: str) -> None:
    assert moved(RECORDED[name], begun(*STARTS[name])) <= TOLERANCE


def test_what_is_recorded_still_exists() -> None:
    assert set(RECORDED) == set(STARTS)


def test_another_seed_of_a_noisy_case_is_noticed() -> None:
    study, config = STARTS[NOISY]
    other = config.model_copy(update={"seed": config.seed + 1})
    assert moved(RECORDED[NOISY], begun(study, other)) > TOLERANCE  # baseline
