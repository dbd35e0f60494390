"""`pliant list`: robots, controllers, studies and tasks, from rows that were written before."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.metadata import entry_points

from rich.console import Console

from pliant.cli.list_file import written
from pliant.cli.plain_table import PlainTable
from pliant.errors import ConfigError, options
from pliant.robots import CATALOGUE, is_available
from pliant.wiring.entry_group import GROUP


def list_command(console: Console, what: str | None, name: str | None = None) -> None:
    """Prints one list, all lists, or the details of one controller. Raises ConfigError for an unknown name."""
    if what is not None and what not in _LISTS:
        raise ConfigError(f"there is no list of {what!r}; {options(_LISTS, what)}")
    if name is not None:
        if what != "controllers":
            remedy = "; `pliant doctor NAME` looks at a robot" if what == "robots" else ""
            raise ConfigError(f"one name is listed of controllers alone, got {what} {name!r}{remedy}")
        from pliant.cli.one_controller import print_controller
        from pliant.wiring.registry import find_controller

        print_controller(console, find_controller(name))
        return
    for name, table in _LISTS.items():
        if what in (None, name):
            table().print(console)


def _robots() -> PlainTable:
    table = PlainTable("robots", ("robot", "joints from", "what it is"), kept=2)
    for entry in CATALOGUE.values():
        remedy = (
            "pip install robot_descriptions"
            if entry.package == "robot_descriptions"
            else "pip install 'pliant[robots]'"
        )
        missing = "" if is_available(entry) else f" (not installed: {remedy})"
        table.rows.append((entry.name, entry.package, entry.description + missing))
    table.rows.append(("FILE", "you", "any fixed-base URDF or MJCF with revolute and prismatic joints"))
    return table


def _controllers() -> PlainTable:
    table = PlainTable("controllers", ("controller", "family", "needs", "guarantees", "what it is"))
    rows = written("controllers")
    if entry_points(group=GROUP):  # what other packages offer is not in the file
        from pliant.cli.list_rows import controller_rows

        rows = controller_rows()
    own = ("MODULE:CLASS", "own", "", "", "yours, from an importable module or my_file.py:MyController")
    table.rows += [*rows, own]
    return table


def _studies() -> PlainTable:
    table = PlainTable("studies", ("study", "case", "controller"), kept=3)
    last = ""
    for study, case, controller in written("studies"):
        if study != last and last:
            table.breaks.add(len(table.rows))
        table.rows.append((study if study != last else "", case, controller))
        last = study
    return table


def _tasks() -> PlainTable:
    table = PlainTable("tasks", ("task", "robot", "surface", "path", "what it is"))
    own = ("FILE.toml", "", "", "", "yours; `pliant new task raster` writes one to begin with")
    table.rows += [*written("tasks"), own]
    return table


_LISTS: Mapping[str, Callable[[], PlainTable]] = {
    "robots": _robots,
    "controllers": _controllers,
    "studies": _studies,
    "tasks": _tasks,
}
