"""`pliant new task`, `pliant task schema` and `pliant task check`."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from pliant.configuration import read_toml
from pliant.errors import ConfigError, options
from pliant.robots import CATALOGUE
from pliant.tasks.task import Task
from pliant.telemetry.output import output_folder, write_text

_SIZES = {
    "raster": ("size = [0.12, 0.08]", "m, along and across", "spacing = 0.02", "m"),
    "spiral": ("size = [0.10, 0.10]", "m, outer diameters", "spacing = 0.02", "m"),
    "circle": ("size = [0.10, 0.10]", "m, diameters", "turns = 2", ""),
    "line": ("size = [0.15, 0.0]", "m, along and across"),
    "square": ("size = [0.10, 0.10]", "m", "turns = 1", ""),
    "lemniscate": ("size = [0.12, 0.06]", "m", "turns = 1", ""),
    "hold": ("time = 4.0", "s"),
    "file": ('file = "path.csv"', "columns x, y; z, time, speed, force if wanted", 'unit = "mm"', ""),
}
"""pattern → lines of the file, with comments"""
_TEMPLATE = """\
format = 1
robot = "{robot}"                                 # `pliant list robots`, or a URDF or MJCF file
controller = "offset-free-mpc"                  # `pliant list controllers`
tool = {{ mass = 0.4, length = 0.2, radius = 0.015 }}
[surface]                                       # plane, cylinder, sphere; as the controller believes it
shape = "plane"
stiffness = 2e4                                 # N/m
[path]
pattern = "{pattern}"
{size}speed = 0.05                                    # m/s
[force]
normal = [[0.0, 5], [0.1, 20], [1.0, 20]]       # share of the path and N
[truth]                                         # how the world differs; one draw a seed
shift = {{ uniform = [-0.004, 0.004] }}           # m, along the normal
tilt = {{ uniform = [-4, 4] }}                    # degrees, about a random axis
imperfections = "p3"                            # noise, delays, friction in the drives
[accept]
force_error = 1.0                               # N
"""
_SAMPLE = "x,y\n-60,-20\n60,-20\n60,20\n-60,20\n"


def new_task_command(console: Console, pattern: str, out: Path | None, robot: str) -> None:
    """Writes a task file as a template. A file that does not end in .toml gets that ending.

    Raises:
        ConfigError: an unknown pattern or robot, or a file that exists already.
    """
    if pattern not in _SIZES:
        raise ConfigError(f"there is no pattern {pattern!r}; {options(_SIZES, pattern)}")
    if robot not in CATALOGUE and not Path(robot).expanduser().is_file():
        raise ConfigError(
            f"there is no robot {robot!r}; {options(CATALOGUE, robot)} or the path of a URDF or MJCF file"
        )
    file = out or Path(f"{pattern}.toml")
    if file.suffix != ".toml":
        file = file.with_name(f"{file.name}.toml")
    parts = _SIZES[pattern]
    lines = zip(parts[::2], parts[1::2], strict=True)
    size = "".join(f"{line:48s}# {note}\n" if note else f"{line}\n" for line, note in lines)
    written = {file: _TEMPLATE.format(robot=robot, pattern=pattern, size=size)}
    if pattern == "file":
        written[file.parent / "path.csv"] = _SAMPLE
    for path in written:
        if path.exists():
            raise ConfigError(f"{path} exists already: choose another name with -o")
    for path, text in written.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_text(path, text)
        console.print(f"wrote    {path}", markup=False, highlight=False, soft_wrap=True)
    console.print(
        f"next     pliant task check {file}; pliant run {file}", markup=False, highlight=False, soft_wrap=True
    )


def schema_command(console: Console, out: Path | None) -> None:
    """Prints, or writes, the JSON schema of a task file."""
    text = json.dumps(Task.model_json_schema(), indent=2, ensure_ascii=False)
    if out is not None:
        write_text(out, text + "\n")
        _say(console, f"schema   {out}")
    else:
        _say(console, text)


def check_command(
    console: Console,
    target: str,
    case: str | None,
    overrides: Mapping[str, Any],
    assignments: Sequence[str],
    out: Path | None,
) -> None:
    """Whether a robot can do a task, as believed and in ten random worlds: a table and a figure.

    Raises:
        PliantError: bad input.
        RunFailedError: it cannot; the sentence says where it first fails and what would help.
    """
    from pliant.cli.choose import resolve, study_folder
    from pliant.errors import RunFailedError
    from pliant.studies.task.config import TaskCase
    from pliant.studies.task.reach_figure import reach_figure
    from pliant.studies.task.task_study import TaskStudy
    from pliant.telemetry.plots import save

    asked = resolve(target, case, overrides, assignments)
    study, config = asked.study, asked.config
    if not isinstance(study, TaskStudy) or not isinstance(config, TaskCase):
        raise ConfigError(f"{target} is a study; `pliant task check` checks a task file")
    if target.endswith(".toml") and not read_toml(Path(target)):
        _say(console, f"note     {target} says nothing: robot, path, force and controller are all defaults")
    study.refuse_unknown(config)
    found = study.check(config)
    table = Table("world", "what", "least or most", "bound", "where", "kept")
    for row in found.rows():
        if row[0] == found.surfaces[0].label or row[-1] != "✓":
            table.add_row(*row)
    console.print(table)
    for what, about in study.about(config).items():
        _say(console, f"{what:7s}  {about}")
    file = save(
        reach_figure(found, config.case), output_folder(out or study_folder(target)) / f"{config.case}_check.png"
    )
    _say(console, f"figure   {file}")
    if not found.reachable:
        failed = next(check for check in found.surfaces if not check.reachable)
        told = f"not possible as {failed.label}: {failed.failure}"
        if config.check == "on":
            raise RunFailedError(f"{told}; {found.help}")
        _say(console, f'{told}; the task says check = "off"')
        return
    study.build(config)  # refuses what a run refuses beside the reach
    drawn = len(found.surfaces) - 1
    _say(
        console,
        f"possible as believed and in {drawn} random worlds" if drawn else "possible; no seed draws another way",
    )


def _say(console: Console, text: str) -> None:
    console.print(text, markup=False, highlight=False, soft_wrap=True)
