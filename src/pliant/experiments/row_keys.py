"""Changes for a whole sweep must not touch what tells its rows apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pliant.errors import ConfigError
from pliant.experiments.base import CaseConfig

_ABSENT = object()
_REMEDIES = {"seed": "`--seeds` says how many there are", "controller": "`pliant run --controller` makes one run"}


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
        if own:
            name = ".".join(key)
            remedy = _REMEDIES.get(name, "`pliant run` makes one run with any value")
            raise ConfigError(
                f"{name!r} cannot be set for the whole case {base.case!r}: {len(own)} of its {len(rows)} runs have a"
                f" value of their own and are named after it; {remedy}"
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
