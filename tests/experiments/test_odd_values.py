"""Every leaf of a configuration with values that make no sense: refused in a sentence, or wired and stepped."""

from __future__ import annotations

import math
import os
import random
from collections.abc import Iterator
from typing import Any

import pytest

from pliant import loop
from pliant.configuration import merged
from pliant.errors import ConfigError, PliantError
from pliant.experiments.base import check_windows
from pliant.experiments.config import assigned
from pliant.experiments.registry import get_study

CASES = {"haptic": "online", "polishing": "ideal", "stack": "rest-plain"}
WHOLE = bool(os.environ.get("PLIANT_WHOLE_SEARCH"))
STEPPED = {"haptic": 1.0, "polishing": 1.0 if WHOLE else 0.02, "stack": 1.0 if WHOLE else 0.02}
"""share of what is accepted that is wired and stepped: the others take longer to wire than the haptic study; all with
`PLIANT_WHOLE_SEARCH=1 pytest tests/experiments/test_odd_values.py`"""
ODD = (math.nan, math.inf, -math.inf, -1, 0, 1e300, 10**23, "text")


def _leaves(tree: dict[str, Any], above: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    for key, value in tree.items():
        if isinstance(value, dict) and value:
            yield from _leaves(value, (*above, key))
        else:
            yield (*above, key), value


def _tree(keys: tuple[str, ...], value: Any) -> dict[str, Any]:
    for key in reversed(keys):
        value = {key: value}
    return value


@pytest.mark.parametrize("name", CASES)
def test_an_odd_value_anywhere_is_refused_in_a_sentence_or_can_be_stepped(name: str) -> None:
    study = get_study(name)
    config = merged(study.case(CASES[name]), {})  # which is possible: only the odd value can be refused
    rng = random.Random(name)
    tried, refused = 0, list[str]()
    for keys, old in _leaves(config.model_dump()):
        for odd in ODD:
            value = [odd] * len(old) if isinstance(old, (list, tuple)) and old else odd
            tried += 1
            try:
                changed = merged(config, _tree(keys, value))
                if rng.random() > STEPPED[name]:
                    continue
                wired = study.build(changed)
                loop.run(wired.plant, wired.estimator, wired.source, wired.controller, range(2), [], wired.robot)
            except PliantError as error:
                refused.append(f"{keys} {odd!r}: {error}")
    assert tried >= 200
    assert tried // 4 < len(refused) < tried
    assert [text for text in refused if len(text.splitlines()) > 1] == []


ENDLESS = [
    ("stack", {"duration": 1e300}),
    ("stack", {"duration": 1e11}),
    ("stack", {"period": 1e-12}),
    ("haptic", {"physics_step": 1e-300}),
    ("polishing", {"physics_step": 1e-9}),
    ("polishing", {"physics_step": 1e-7, "duration": 3.5}),
    ("stack", {"physics_step": 1e-9, "duration": 0.05}),
    ("stack", {"wall": {"friction": 1e300}}),
    ("stack", {"pushes": {"duration": [0, 0], "gap": [0, 0]}}),
    ("stack", {"retuning": {"factor": [0, 2]}}),
    ("haptic", {"online": {"count": 10**23}}),
]


@pytest.mark.parametrize(("name", "changes"), ENDLESS, ids=[f"{n}-{c}" for n, c in ENDLESS])
def test_what_would_not_end_or_makes_no_sense_is_refused(name: str, changes: dict[str, Any]) -> None:
    study = get_study(name)
    with pytest.raises(ConfigError):
        merged(study.case(next(iter(study.cases))), changes)


def test_a_window_outside_the_run_is_refused_before_it_starts() -> None:
    for name in CASES:
        study = get_study(name)
        config = study.case(next(iter(study.cases)))
        check_windows(config)
        with pytest.raises(ConfigError, match="no part of the run"):
            check_windows(merged(config, {"duration": 0.1}))


@pytest.mark.parametrize("key", ["case", "study", "variant"])
def test_which_run_it_is_cannot_be_set(key: str) -> None:
    with pytest.raises(ConfigError, match=f"--set cannot change '{key}'"):
        assigned([f"{key}=other"])
