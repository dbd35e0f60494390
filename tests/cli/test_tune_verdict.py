"""A search says whether it improved what it started from."""

from __future__ import annotations

from pliant.cli.tune import compared_to_start
from pliant.experiments.search import Trial


def trial(objective: float, failed: int = 0) -> Trial:
    return Trial(0, {}, objective, failed, "")


def test_a_search_says_whether_it_was_better_than_its_start() -> None:
    assert compared_to_start(trial(4.0), trial(3.0)) == "Better than the start: the objective fell from 4.00 to 3.00."
    assert compared_to_start(trial(1e6, 2), trial(3.0)) == "Better than the start: 0 failed runs in place of 2."
    same = trial(4.0)
    assert compared_to_start(same, same).startswith("Not better than the start: ")
