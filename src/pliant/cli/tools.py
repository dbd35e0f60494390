"""Commands that inspect something or write a template: `pliant log`, `bench`, `list`, `new`, `doctor`, `task`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pliant.cli import program
from pliant.cli.guarded import guarded
from pliant.cli.program import Out, RobotOption, Sets
from pliant.errors import ConfigError


@program.app.command()
@guarded
def log(
    words: Annotated[
        list[str],
        typer.Argument(
            metavar="[export|animate] FILE.mcap…", help="A log that pliant wrote; for an export, one or more."
        ),
    ],
    plot: Annotated[bool, typer.Option("--plot", help="Draws the log into PNG files.")] = False,
    lerobot: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Output of an export: a LeRobot data set, layout v2.1.")
    ] = None,
    fps: Annotated[int | None, typer.Option(help="Frames per second of an export.", show_default="50")] = None,
    action: Annotated[
        str | None,
        typer.Option(
            metavar="CHANNEL,…",
            help="Channels that are the action of an export, separated by commas.",
            show_default="command/torque",
        ),
    ] = None,
    out: Out = None,
) -> None:
    """Shows the contents of a log: channels, units, rates, metrics. Exports logs, or animates one (--out FILE.webp)."""
    from pliant.cli.log import animate_command, export_command, log_command

    given = [name for name, value in (("--lerobot", lerobot), ("--fps", fps), ("--action", action)) if value]
    if words[0] == "export":
        if lerobot is None or plot or out is not None:
            raise ConfigError("write pliant log export FILE.mcap… --lerobot DIR [--fps N] [--action CHANNEL,…]")
        export_command(program.out, [Path(word) for word in words[1:]], lerobot, fps or 50, action)
        return
    if words[0] == "animate" and not given and not plot:
        animate_command(program.out, [Path(word) for word in words[1:]], out)
        return
    if given or len(words) > 1:
        raise ConfigError(f"pliant log takes one file; {', '.join(given) or words[1]} belongs to pliant log export")
    log_command(program.out, Path(words[0]), plot, out)


@program.app.command()
@guarded
def bench(
    what: Annotated[str, typer.Argument(metavar="[controllers]", help="What to measure.")] = "controllers",
    json_: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Writes the numbers as JSON.")] = None,
) -> None:
    """Measures one step: median, p90, p99 and maximum of the CPU time, in microseconds."""
    from pliant.cli.bench import bench_command

    bench_command(program.out, what, json_)


@program.app.command("list")
@guarded
def list_(
    what: Annotated[
        str | None,
        typer.Argument(metavar="[robots|controllers|studies|tasks]", help="What to list; by default everything."),
    ] = None,
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="[NAME]",
            help="One controller, by name or as my_module:MyController: its needs, its parameters, and where"
            " it holds the force.",
        ),
    ] = None,
) -> None:
    """Lists robots, controllers, studies and tasks; for one controller, its details."""
    from pliant.cli.listing import list_command

    list_command(program.out, what, name)


@program.app.command()
@guarded
def new(
    what: Annotated[str, typer.Argument(metavar="task|controller", help="What to write.")],
    name: Annotated[
        str,
        typer.Argument(
            metavar="PATTERN|NAME",
            help="For a task its pattern (raster, spiral, circle, line, …); for a controller the name of its"
            " Python class.",
        ),
    ],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE", help="The file (default: from the name).")
    ] = None,
    robot: Annotated[str, typer.Option(metavar="NAME|FILE", help="The robot of a task.")] = "iiwa14",
) -> None:
    """Writes a template: a contact task, or a controller of your own with its test."""
    from pliant.cli.new import new_command
    from pliant.cli.task import new_task_command

    if what == "task":
        new_task_command(program.out, name, out, robot)
    else:
        new_command(program.out, what, name, out)


@program.app.command()
@guarded
def doctor(
    robot: Annotated[str | None, typer.Argument(metavar="[ROBOT|FILE]", help="A robot: name or file to check.")] = None,
    locked: Annotated[
        list[str] | None,
        typer.Option(metavar="JOINT=ANGLE", help="A joint of ROBOT that is fixed (rad or m); repeatable."),
    ] = None,
    config: Annotated[
        Path | None, typer.Option("--config", metavar="CONFIG.toml", help="A configuration to check for unsafe gains.")
    ] = None,
) -> None:
    """Checks this installation; with ROBOT, shows what was read from a robot file; with --config, checks a
    configuration."""
    from pliant.cli.doctor import doctor_command
    from pliant.cli.doctor_robot import print_robot

    if robot is None and locked:
        raise ConfigError("--locked needs a robot: pliant doctor ROBOT --locked JOINT=ANGLE")
    if robot is not None:
        print_robot(program.out, robot, locked or [])
    if robot is None or config is not None:
        doctor_command(program.out, config)


@program.app.command()
@guarded
def task(
    action: Annotated[str, typer.Argument(metavar="check|schema", help="What to do.")],
    target: Annotated[str | None, typer.Argument(metavar="[TASK.toml|TASK]", help="The task to check.")] = None,
    case: Annotated[str | None, typer.Option(help="Variant of the task.")] = None,
    robot: RobotOption = None,
    out: Out = None,
    set_: Sets = None,
) -> None:
    """Checks whether a robot can do a task (check), or prints the JSON schema of task files (schema)."""
    from pliant.cli.task import check_command, schema_command

    if action == "schema" and target is None:
        schema_command(program.out, out)
    elif action == "check" and target is not None:
        check_command(program.out, target, case, {"robot": robot}, set_ or [], out)
    else:
        raise ConfigError(f"write pliant task check TASK.toml, or pliant task schema, got {action!r} {target or ''}")
