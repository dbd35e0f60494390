"""Bounds of a share of failures, against the quantile of the beta distribution that defines them."""

from __future__ import annotations

import pytest
from scipy.stats import beta, binom

from pliant.telemetry.proportion import share_bound, share_text


@pytest.mark.parametrize(
    ("count", "runs"), [(0, 1), (0, 140), (1, 10), (7, 14), (13, 14), (15, 70), (499, 500), (3, 4000)]
)
@pytest.mark.parametrize("confidence", [0.5, 0.95, 0.999])
def test_the_bound_is_the_quantile_of_clopper_and_pearson(count: int, runs: int, confidence: float) -> None:
    assert share_bound(count, runs, confidence) == pytest.approx(
        beta.ppf(confidence, count + 1, runs - count), rel=1e-9
    )


@pytest.mark.parametrize("share", [0.01, 0.1, 0.37, 0.8])
def test_the_bound_covers_the_share_as_often_as_it_says_and_the_count_alone_does_not(share: float) -> None:
    runs = 40
    weight = binom.pmf(range(runs + 1), runs, share)
    covered = sum(w for k, w in enumerate(weight) if share_bound(k, runs) >= share)
    by_count = sum(w for k, w in enumerate(weight) if k / runs >= share)  # the count taken at its word
    assert covered >= 0.95
    assert by_count < 0.75


def test_bounds_at_the_ends() -> None:
    assert share_bound(0, 140) == pytest.approx(1.0 - 0.05 ** (1.0 / 140.0))
    assert share_bound(5, 5) == 1.0
    assert share_text(0, 140) == "0 of 140: ≤ 2.1 %"


@pytest.mark.parametrize(("count", "runs"), [(-1, 3), (4, 3), (0, 0)])
def test_what_is_no_count_is_refused(count: int, runs: int) -> None:
    with pytest.raises(ValueError, match="a share needs"):
        share_bound(count, runs)
