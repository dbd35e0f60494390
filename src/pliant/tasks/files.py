"""Tasks from TOML files: inheritance, variants, and errors that name the file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from pliant.configuration import read_toml, validated
from pliant.errors import ConfigError, options
from pliant.overlay import overlaid
from pliant.tasks.task import Task

CATALOGUE = Path(__file__).parent / "catalogue"
_DEPTH = 8


@dataclass(frozen=True)
class TaskFile:
    """A file that was read."""

    path: Path
    task: Task
    variants: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """name → changes"""

    @property
    def name(self) -> str:
        """The file's, without its ending."""
        return self.path.stem


def load_task(path: str | Path, variant: str | None = None) -> Task:
    """A task from its file.

    Args:
        path: of a TOML file, or the name of a task of the catalogue (`pliant list tasks`).
        variant: one of its `[variant.NAME]`.

    Raises:
        ConfigError: no such file or variant, or it holds something that is no task; file and key are named.
    """
    file = located(path)
    return (_shipped if file.parent == CATALOGUE else _loaded)(file, variant)


def _loaded(file: Path, variant: str | None) -> Task:
    found = read_task(file)
    if variant is None:
        return found.task
    if variant not in found.variants:
        raise ConfigError(f"{found.path} has no variant {variant!r}; {options(found.variants, variant)}")
    return changed(found.path, found.task, found.variants[variant])


_shipped = cache(_loaded)
"""of files of the catalogue, which stay as they are: a study makes its cases of few of them"""


def read_task(path: str | Path) -> TaskFile:
    """A task file with its variants. Raises as `load_task`."""
    file = located(path)
    return (_shipped_file if file.parent == CATALOGUE else _read)(file)


def _read(file: Path) -> TaskFile:
    values = _with_base(file, 0)
    variants = values.pop("variant", {})
    if not isinstance(variants, dict) or not all(isinstance(changes, dict) for changes in variants.values()):
        raise ConfigError(f"{file}: variant: write [variant.NAME] with changes below it, got {variants!r}")
    for name in variants:
        if not name.strip() or re.search(r"[/\\\x00-\x1f]|\.\.", name):
            raise ConfigError(
                f"{file}: variant: its name becomes that of a folder: no '/', backslash or '..', got {name!r}"
            )
    return TaskFile(file, checked(file, values), variants)


_shipped_file = cache(_read)


def located(path: str | Path) -> Path:
    """The file of a path or of a catalogue name. Raises ConfigError if there is none."""
    file = Path(path).expanduser()
    if file.suffix == ".toml":
        return file
    name = str(path)
    names = catalogue()
    if name not in names:
        raise ConfigError(f"there is no task {name!r}; {options(names, name)} or the path of a .toml file")
    return CATALOGUE / f"{name}.toml"


def catalogue() -> list[str]:
    """Names of the tasks that ship."""
    return sorted(file.stem for file in CATALOGUE.glob("*.toml"))


def checked(file: Path, values: Mapping[str, Any]) -> Task:
    """The task that values stand for, files in it beside `file`. Raises ConfigError, which names the file."""
    try:
        task = validated(Task, values)
    except ConfigError as error:
        raise ConfigError(f"{file}: {error}") from None
    return _beside(file.parent, task)


def changed(file: Path, task: Task, changes: Mapping[str, Any]) -> Task:
    """A task with the changes of one of its variants. Args: file: where they stand; its errors name it."""
    return checked(file, _over(file, task.model_dump(), changes))


def _over(file: Path, base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    try:
        return overlaid(Task, base, changes)
    except ConfigError as error:
        raise ConfigError(f"{file}: {error}") from None


def _with_base(file: Path, depth: int) -> dict[str, Any]:
    """Values of a file over those of the files that it inherits from."""
    values = read_toml(file)
    base = values.pop("base", None)
    if base is None:
        return values
    if not isinstance(base, str):
        raise ConfigError(f"{file}: base: the path of another task file, or a name of the catalogue, got {base!r}")
    if depth >= _DEPTH:
        raise ConfigError(f"{file}: base: files inherit from each other in a circle, or more than {_DEPTH} deep")
    above = file.parent / base if base.endswith(".toml") else located(base)
    inherited = _with_base(above, depth + 1)
    inherited.pop("variant", None)  # variants are the file's own
    return _over(file, inherited, values)


def _beside(folder: Path, task: Task) -> Task:
    """The task with the paths of its files absolute, so that it can be run from anywhere."""
    update: dict[str, Any] = {}
    if task.path.file is not None:
        update["path"] = task.path.model_copy(update={"file": str((folder / task.path.file).resolve())})
    if task.surface.file is not None:
        update["surface"] = task.surface.model_copy(update={"file": str((folder / task.surface.file).resolve())})
    if any(one.file is not None for one in task.event):
        update["event"] = tuple(
            one if one.file is None else one.model_copy(update={"file": str((folder / one.file).resolve())})
            for one in task.event
        )
    if task.robot.endswith((".urdf", ".xml", ".mjcf")):
        update["robot"] = str((folder / Path(task.robot).expanduser()).resolve())
    return task.model_copy(update=update)
