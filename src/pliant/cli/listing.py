"""`pliant list`: robots, controllers, studies and tasks."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from pliant.cli.one_controller import print_controller
from pliant.errors import ConfigError, options
from pliant.experiments.registry import get_study, study_names
from pliant.robots import CATALOGUE, is_available
from pliant.tasks import Task
from pliant.tasks.files import catalogue, load_task, read_task
from pliant.tasks.phase import Track
from pliant.wiring.registry import broken_controllers, controllers, find_controller


def list_command(console: Console, what: str | None, name: str | None = None) -> None:
    """Prints one list, all lists, or the details of one controller. Raises ConfigError for an unknown name."""
    if what is not None and what not in _LISTS:
        raise ConfigError(f"there is no list of {what!r}; {options(_LISTS, what)}")
    if name is not None:
        if what != "controllers":
            remedy = "; `pliant doctor NAME` looks at a robot" if what == "robots" else ""
            raise ConfigError(f"one name is listed of controllers alone, got {what} {name!r}{remedy}")
        print_controller(console, find_controller(name))
        return
    for name, table in _LISTS.items():
        if what in (None, name):
            console.print(table())


def _robots() -> Table:
    table = Table("robot", "joints from", "what it is", title="robots", title_justify="left")
    for entry in CATALOGUE.values():
        remedy = (
            "pip install robot_descriptions"
            if entry.package == "robot_descriptions"
            else "pip install 'pliant\\[robots]'"
        )
        missing = "" if is_available(entry) else f" (not installed: {remedy})"
        table.add_row(entry.name, entry.package, entry.description + missing)
    table.add_row("FILE", "you", "any fixed-base URDF or MJCF with revolute and prismatic joints")
    return table


def _controllers() -> Table:
    table = Table(title="controllers", title_justify="left")
    table.add_column("controller", no_wrap=True)  # what the user has to type
    for heading in ("family", "needs", "guarantees", "what it is"):
        table.add_column(heading)
    for entry in controllers().values():
        needs = ", ".join(entry.needs(entry.default).words()) or "–"
        force = "" if entry.regulates_force else "; regulates no force"
        table.add_row(entry.name, entry.family, needs, entry.guarantees, entry.summary + force)
    for name, why in broken_controllers().items():
        table.add_row(name, "broken", "", "", escape(why))
    table.add_row("MODULE:CLASS", "own", "", "", "yours, from an importable module or my_file.py:MyController")
    return table


def _studies() -> Table:
    table = Table("study", "case", "controller", title="studies", title_justify="left")
    for name in study_names():
        study = get_study(name)
        for index, config in enumerate(case.config for case in study.cases.values()):
            table.add_row(name if index == 0 else "", config.case, config.controller)
        table.add_section()
    return table


def _tasks() -> Table:
    table = Table("task", "robot", "surface", "path", "what it is", title="tasks", title_justify="left")
    for name in catalogue():
        found = read_task(name)
        for variant, task in {name: found.task, **{key: load_task(name, key) for key in found.variants}}.items():
            label = name if variant == name else f"  --case {variant}"
            table.add_row(label, task.robot, *_where_and_what(task), task.description)
    table.add_row("FILE.toml", "", "", "", "yours; `pliant new task raster` writes one to begin with")
    return table


def _where_and_what(task: Task) -> tuple[str, str]:
    """What is touched, and the path on it; of a list of phases the things that stand around, and what moves."""
    if not task.phase:
        return task.surface.shape, task.path.pattern
    things = ", ".join(dict.fromkeys(thing.shape for thing in task.scene.values())) or "nothing"
    tracks = [track.shape for track in task.phase[0].tracks.values() if isinstance(track, Track)]
    count = len(task.phase)
    return things, tracks[0] if tracks else f"{count} phase{'s' if count > 1 else ''}"


_LISTS: Mapping[str, Callable[[], Table]] = {
    "robots": _robots,
    "controllers": _controllers,
    "studies": _studies,
    "tasks": _tasks,
}
