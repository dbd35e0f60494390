"""Changes for a whole sweep must not change keys that distinguish its rows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pliant.errors import ConfigError
from pliant.experiments.base_config import CaseConfig
from pliant.experiments.case import Row

Key = tuple[str, ...]
_ONE = "`pliant run` makes one run with any value"
_COUNTED = (("seed",), ("variant",))
"""key with a value per run: the seeds begin with the case's seed"""


def refuse_row_keys(
    base: CaseConfig, made: Sequence[tuple[Row, Sequence[CaseConfig]]], changes: Mapping[str, Any]
) -> None:
    """Refuses changes of a key that a row, or one of its draws, sets itself: the change would be lost, or the labels of
    the rows would be wrong.

    Args:
        base: the present configuration of the case.
        made: every row with its runs.
        changes: nested, for all rows.

    Raises:
        ConfigError: a row sets one of the keys.
    """
    values, total = base.model_dump(), sum(len(runs) for _, runs in made)
    for key in _leaves(changes):
        if key in _COUNTED:
            continue
        own = 0
        for row, runs in made:
            if any(_overlap(key, set_) for set_ in _leaves(row.changed(base))):
                own += len(runs)
            else:
                own += sum(_at(run.model_dump(), key) != _at(values, key) for run in runs)
        if own:
            name = ".".join(key)
            other = "`pliant compare` runs a case with any controllers" if key == ("controller",) else _ONE
            raise ConfigError(
                f"{name!r} cannot be set for the whole case {base.case!r}: {own} of its {total} runs have a value of"
                f" their own and are named after it; {other}"
            )


def refuse_same_names(runs: Sequence[CaseConfig]) -> None:
    """Raises ConfigError if two different runs of a sweep would have the same case, controller, variant and seed."""
    named: dict[tuple[object, ...], CaseConfig] = {}
    for run in runs:
        name = (run.case, run.controller, run.variant, run.seed)
        if named.setdefault(name, run) != run:
            raise ConfigError(
                f"two different runs of case {run.case!r} would have the same name (controller {run.controller},"
                f" variant {run.variant!r}, seed {run.seed}): its rows differ in more than what was set;"
                " `pliant run` makes one run"
            )


def _overlap(one: Key, other: Key) -> bool:
    return all(a == b for a, b in zip(one, other, strict=False))


def _leaves(changes: Mapping[str, Any], above: Key = ()) -> Iterator[Key]:
    for name, value in changes.items():
        key = (*above, name)
        if isinstance(value, Mapping) and value:
            yield from _leaves(value, key)
        else:
            yield key


def _at(values: Any, key: Sequence[str]) -> Any:
    for part in key:
        if not isinstance(values, Mapping) or part not in values:
            return None
        values = values[part]
    return values
