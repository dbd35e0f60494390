"""Confidence bound on a failure rate from a count of failures."""

from __future__ import annotations

import math

CONFIDENCE = 0.95
"""of a one-sided bound"""


def share_bound(count: int, runs: int, confidence: float = CONFIDENCE) -> float:
    """One-sided upper bound of a failure rate, for `count` failures in `runs` independent runs.

    Clopper and Pearson, Biometrika 26 (1934): the p at which `count` or fewer are seen with probability
    1 − `confidence`; the quantile of Beta(count + 1, runs − count). It holds for runs that are drawn independently
    from what the share is asked of, not for a grid of settings.

    Args:
        count: failures, 0 … runs.
        runs: at least 1.
        confidence: above 0, below 1.

    Returns:
        A share, 0 … 1; 1 if all failed.

    Raises:
        ValueError: invalid numbers.
    """
    if not (0 <= count <= runs and runs > 0 and 0.0 < confidence < 1.0):
        raise ValueError(
            f"a share needs 0 ≤ count ≤ runs, runs > 0 and 0 < confidence < 1, got {count} of {runs}, {confidence:g}"
        )
    if count == runs:
        return 1.0
    low, high = count / runs, 1.0
    for _ in range(60):  # bisection down to rounding: the tail falls with the share
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _at_most(count, runs, middle) > 1.0 - confidence else (low, middle)
    return 0.5 * (low + high)


def share_text(count: int, runs: int) -> str:
    """The count with its bound: `0 of 140: ≤ 2.1 %`."""
    return f"{count} of {runs}: ≤ {bound_text(count, runs)}" if runs else "0 of 0"


def bound_text(count: int, runs: int) -> str:
    """`share_bound` in percent, two digits."""
    percent = 100.0 * share_bound(count, runs)
    return "100 %" if percent >= 99.5 else f"{percent:.2g} %"


def _at_most(count: int, runs: int, share: float) -> float:
    """Probability of `count` or fewer in so many runs."""
    if share in (0.0, 1.0):
        return 1.0 if share == 0.0 else 0.0
    odds, rest, all_ways = math.log(share), math.log1p(-share), math.lgamma(runs + 1)
    return sum(
        math.exp(all_ways - math.lgamma(k + 1) - math.lgamma(runs - k + 1) + k * odds + (runs - k) * rest)
        for k in range(count + 1)
    )
