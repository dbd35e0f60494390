"""A task with the values of its `[draw]` as the seed gives them."""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from pliant.configuration import validated
from pliant.errors import ConfigError, options
from pliant.simulation.seeding import generator
from pliant.studies.task.config import TaskCase
from pliant.tasks.draws import DrawnValue, Follows, Least, drawn


def as_drawn(case: TaskCase) -> TaskCase:
    """The task of one run; without `draw` the same. Each value has a generator of its own.

    Raises:
        ConfigError: a key that the task does not have, or a value that it refuses.
    """
    if not case.draw:
        return case
    values = case.model_dump()
    found: dict[str, float] = {}
    for key, how in case.draw.items():
        found[key] = _value(key, how, found, generator(case.seed, f"draw.{key}"))
        _put(values, key, found[key])
    return validated(TaskCase, values | {"draw": {}})


def _value(key: str, how: DrawnValue, before: dict[str, float], rng: np.random.Generator) -> float:
    if isinstance(how, Least):
        return min(_value(key, one, before, rng) for one in how.least)
    if isinstance(how, Follows):
        if how.of not in before:
            raise ConfigError(
                f"draw: {key} follows {how.of!r}, which is not drawn before it; {options(before, how.of)}"
            )
        return float(how.factor * before[how.of] ** how.power)
    return drawn(how, rng)


def _put(values: Any, key: str, value: float) -> None:
    """Sets a number at a dotted key; entries of lists are called by their name or number, the first 1."""
    *way, last = key.split(".")
    node = values
    for depth, part in enumerate(way):
        place = _place(node, part)
        if place is None:
            raise ConfigError(f"draw: the task has no {'.'.join(way[: depth + 1])!r}; {options(_names(node), part)}")
        if isinstance(node[place], tuple):
            node[place] = list(node[place])
        node = node[place]
    place = _place(node, last)
    old = None if place is None else node[place]
    if place is None or isinstance(old, dict | list | tuple | str):
        raise ConfigError(f"draw: {key!r} is no number of the task; {options(_names(node), last)}")
    node[place] = value


def _names(node: Any) -> list[str]:
    if isinstance(node, dict):
        return [str(name) for name in cast("dict[str, Any]", node)]
    if isinstance(node, list):
        entries = enumerate(cast("list[Any]", node), start=1)
        return [str(one.get("name") or place) if isinstance(one, dict) else str(place) for place, one in entries]  # pyright: ignore[reportUnknownMemberType, reportUnknownArgumentType]
    return []


def _place(node: Any, part: str) -> Any:
    names = _names(node)
    if part not in names:
        return None
    return part if isinstance(node, dict) else names.index(part)
