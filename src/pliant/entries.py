"""How a package offers its controllers by name: a typed default configuration and a way to build one from it.

Each package that has controllers (`controllers`, `mpc`, …) keeps a table of its own; whoever stands above them merges
the tables. So no package needs to know another.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from pliant.configuration import Config
from pliant.errors import ConfigError, options
from pliant.interfaces import Controller
from pliant.robot import Robot


class ControllerConfig(Config):
    """Base of a controller's configuration."""


C = TypeVar("C", bound=ControllerConfig)


def _no_advice(robot: Robot, config: Any, period: float) -> tuple[str, ...]:
    return ()


@dataclass(frozen=True)
class ControllerEntry(Generic[C]):
    """A controller that can be chosen by name."""

    name: str
    summary: str
    """one line, for `pliant list controllers`"""
    default: C
    """its configuration where the user says nothing; the type of it is the schema"""
    build: Callable[[Robot, C, float], Controller[Any]]
    """robot, configuration, control period in s → controller"""
    advise: Callable[[Robot, C, float], tuple[str, ...]] = _no_advice
    """robot, configuration, control period in s → what is unsafe about the parameters, in sentences"""


def merged_entries(*tables: Mapping[str, ControllerEntry[Any]]) -> dict[str, ControllerEntry[Any]]:
    """One table out of several. Raises ConfigError if two offer the same name."""
    merged: dict[str, ControllerEntry[Any]] = {}
    for table in tables:
        for name, entry in table.items():
            if name in merged:
                raise ConfigError(f"two controllers are called {name!r}: give one of them another name")
            merged[name] = entry
    return merged


def find_entry(table: Mapping[str, ControllerEntry[Any]], name: str) -> ControllerEntry[Any]:
    """The entry of a name. Raises ConfigError, with the names there are, if it does not exist."""
    if name not in table:
        raise ConfigError(f"there is no controller {name!r}; {options(table, name)}")
    return table[name]
