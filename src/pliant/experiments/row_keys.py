"""Changes for a whole sweep must not touch what tells its rows apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pliant.errors import ConfigError
from pliant.experiments.base import CaseConfig

_ABSENT = object()
_LABELS = ("controller", "variant", "seed")
"""what a row is named after; setting one makes rows the same, not wrong"""


def refuse_row_keys(base: CaseConfig, rows: Sequence[CaseConfig], changes: Mapping[str, Any]) -> None:
    """Refuses changes of a key to which some row gives a value of its own: its label would then be wrong.

    Args:
        base: the case.
        rows: every run of it.
        changes: nested, meant for all of them.

    Raises:
        ConfigError: a row sets one of the keys.
    """
    values = base.model_dump()
    dumped = [row.model_dump() for row in rows]
    for key in _leaves(changes):
        own = [row for row in dumped if _at(row, key) != _at(values, key)]
        if own and key[0] not in _LABELS:
            name = ".".join(key)
            raise ConfigError(
                f"{name!r} cannot be set for the whole case {base.case!r}: {len(own)} of its {len(rows)} runs have a"
                " value of their own and are named after it; `pliant run` makes one run with any value"
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


def _leaves(changes: Mapping[str, Any], above: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for name, value in changes.items():
        key = (*above, name)
        if isinstance(value, Mapping) and value:
            yield from _leaves(value, key)
        else:
            yield key


def _at(values: Any, key: Sequence[str]) -> Any:
    for part in key:
        if not isinstance(values, Mapping) or part not in values:
            return _ABSENT
        values = values[part]
    return values
