"""The command line: `pliant run`, `study`, `live`, `log`, `bench`, `list`, `doctor`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from pliant import __version__
from pliant.cli.guarded import guarded
from pliant.errors import ConfigError

app = typer.Typer(
    name="pliant",
    help="Contact control for torque-controlled robots: run a contact task, see it, measure it.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
_out = Console()
_err = Console(stderr=True)

Out = Annotated[Path | None, typer.Option("--out", help="Folder for logs, figures and summary.json.")]
Sets = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Overrides one value, e.g. plant.period=0.002; repeatable."),
]
Controller = Annotated[
    str | None,
    typer.Option(
        metavar="NAME|MODULE:CLASS|FILE.py:CLASS", help="Controller by name, see `pliant list controllers`, or yours."
    ),
]
Metrics = Annotated[
    list[str] | None,
    typer.Option(
        "--metric",
        metavar="MODULE:FUNCTION|FILE.py:FUNCTION",
        help="One more metric, a function (log, config) -> pliant.Metric; repeatable.",
    ),
]
RobotOption = Annotated[
    str | None, typer.Option("--robot", metavar="NAME|FILE", help="Catalogue name, or a URDF or MJCF file.")
]
Seed = Annotated[int | None, typer.Option(min=0, help="Seed of every random draw.")]


@app.command()
@guarded
def run(
    target: Annotated[
        str,
        typer.Argument(
            metavar="[TASK.toml|TASK|STUDY|CONFIG.toml|FILE.mcap]",
            help="A task file, a task or study by name, a TOML file with `study = ...` and any of its values, or"
            " config.toml or log of a run, which is repeated.",
        ),
    ] = "stack",
    case: Annotated[str | None, typer.Option(help="Case of the study; see `pliant list studies`.")] = None,
    controller: Controller = None,
    robot: RobotOption = None,
    seed: Seed = None,
    metric: Metrics = None,
    out: Out = None,
    set_: Sets = None,
    live: Annotated[
        bool, typer.Option("--live", help="Opens a page beside the run, which then follows wall time.")
    ] = False,
    figures: Annotated[bool, typer.Option("--figures/--no-figures", help="Whether to draw.")] = True,
    show: Annotated[
        bool, typer.Option("--show-config", help="Prints every value, its unit and where it comes from; runs nothing.")
    ] = False,
) -> None:
    """Runs one case: a table, figures, a log, summary.json, and config.toml, which repeats it."""
    from pliant.cli.run import run_command, show_config

    overrides = {"controller": controller, "robot": robot, "seed": seed, "own_metrics": metric}
    if show:
        show_config(_out, target, case, overrides, set_ or [])
        return
    run_command(_out, _err, target, case, overrides, set_ or [], out, live, figures)


@app.command()
@guarded
def study(
    name: Annotated[
        str | None,
        typer.Argument(metavar="[STUDY|TASK.toml]", help="Study or task file with [sweep].", show_default="stack"),
    ] = None,
    case: Annotated[list[str] | None, typer.Option(help="Only this case; repeatable.")] = None,
    seeds: Annotated[
        int | None, typer.Option(min=1, help="Seeds per case with random draws (default: the study's own).")
    ] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Runs at the same time, each in a process of its own.")] = 1,
    scheduler: Annotated[
        str | None, typer.Option(metavar="tcp://HOST:PORT", help="Runs on the workers of a running dask scheduler.")
    ] = None,
    resume: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Goes on with an interrupted study: runs what DIR lacks.")
    ] = None,
    logs: Annotated[
        bool, typer.Option("--logs", help="Keep the log of every run, not only of those that are drawn.")
    ] = False,
    tune: Annotated[
        str | None,
        typer.Option(
            metavar="CONTROLLER",
            help="Searches for this controller's best parameters instead, on the robot of a --case.",
        ),
    ] = None,
    trials: Annotated[
        int | None, typer.Option(min=1, help="Parameter sets that --tune tries.", show_default="64")
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed of --tune's search.", show_default="0")] = None,
    metric: Metrics = None,
    out: Out = None,
    set_: Sets = None,
) -> None:
    """Runs a whole study, baselines included: the tables and figures of a paper, beside the paper's numbers."""
    from pliant.cli.study import resume_command, study_command
    from pliant.experiments.results import Request

    rest = {"--seeds": seeds, "--logs": logs, "--metric": metric}
    if tune is not None:
        from pliant.cli.tune import tune_command

        _refuse("--tune", rest | {"--resume": resume, "more than one --case": (case or [])[1:]})
        where = case[0] if case else None
        tune_command(
            _out, _err, name or "stack", tune, where, trials or 64, seed or 0, set_ or [], out, jobs, scheduler
        )
        return
    if trials is not None or seed is not None:
        raise ConfigError("--trials and --seed belong to --tune CONTROLLER, which is missing")
    if resume is not None:
        _refuse("--resume", rest | {"--case": case, "--set": set_, "--out": out})
        resume_command(_out, _err, resume, name, jobs, scheduler)
        return
    request = Request(name or "stack", tuple(case or ()), seeds, (*(set_ or ()), *_own(metric)), logs)
    study_command(_out, _err, request, out, jobs, scheduler)


def _own(metric: list[str] | None) -> tuple[str, ...]:
    return (f"own_metrics={json.dumps(metric)}",) if metric else ()


def _refuse(option: str, others: Mapping[str, object]) -> None:
    given = [name for name, value in others.items() if value]
    if given:
        raise ConfigError(f"{option} cannot be combined with {', '.join(given)}")


@app.command()
@guarded
def live(
    target: Annotated[
        str, typer.Argument(metavar="[TASK.toml|STUDY|CONFIG.toml|FILE.mcap]", help="What to run, or a log to replay.")
    ] = "stack",
    case: Annotated[str | None, typer.Option(help="Case of the study; see `pliant list studies`.")] = None,
    controller: Controller = None,
    robot: RobotOption = None,
    seed: Seed = None,
    host: Annotated[
        str, typer.Option(help="Address to listen at. Any but the default lets other machines in that have the link.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port of the page; 0: any free one.")] = 8080,
    out: Out = None,
    set_: Sets = None,
) -> None:
    """Opens a page in the browser: the robot moves, every parameter can be turned, every link pushed."""
    from pliant.cli.live import live_command

    overrides = {"controller": controller, "robot": robot, "seed": seed}
    live_command(_out, _err, target, case, overrides, set_ or [], host, port, out)


@app.command()
@guarded
def log(
    file: Annotated[Path, typer.Argument(metavar="FILE.mcap", help="A log that pliant wrote.")],
    plot: Annotated[bool, typer.Option("--plot", help="Draws the log into PNG files.")] = False,
    out: Out = None,
) -> None:
    """Says what is in a log: channels, units, rates, metrics."""
    from pliant.cli.log import log_command

    log_command(_out, file, plot, out)


@app.command()
@guarded
def bench(
    what: Annotated[str, typer.Argument(metavar="[controllers]", help="What to time.")] = "controllers",
    json_: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Writes the numbers as JSON.")] = None,
) -> None:
    """Times one step: median, p90, p99 and maximum of the CPU time, in microseconds."""
    from pliant.cli.bench import bench_command

    bench_command(_out, what, json_)


@app.command("list")
@guarded
def list_(
    what: Annotated[
        str | None, typer.Argument(metavar="[robots|controllers|studies|tasks]", help="What to list; nothing: all.")
    ] = None,
) -> None:
    """Lists robots, controllers, studies and tasks."""
    from pliant.cli.listing import list_command

    list_command(_out, what)


@app.command()
@guarded
def new(
    what: Annotated[str, typer.Argument(metavar="task|controller", help="What to begin.")],
    name: Annotated[
        str,
        typer.Argument(metavar="PATTERN|NAME", help="A task's raster, spiral, circle, line, …; a Python class's name."),
    ],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE", help="The file (default: after its name).")
    ] = None,
    robot: Annotated[str, typer.Option(metavar="NAME|FILE", help="The robot of a task.")] = "iiwa14",
) -> None:
    """Writes a file to begin with: a contact task, or a controller of your own with a test of it."""
    from pliant.cli.new import new_command
    from pliant.cli.task import new_task_command

    if what == "task":
        new_task_command(_out, name, out, robot)
    else:
        new_command(_out, what, name, out)


@app.command()
@guarded
def doctor(
    robot: Annotated[
        str | None, typer.Argument(metavar="[ROBOT|FILE]", help="A robot: what was understood of it.")
    ] = None,
    locked: Annotated[
        list[str] | None,
        typer.Option(metavar="JOINT=ANGLE", help="A joint of ROBOT that is fixed (rad or m); can be repeated."),
    ] = None,
    config: Annotated[
        Path | None, typer.Option("--config", metavar="CONFIG.toml", help="A configuration to check for unsafe gains.")
    ] = None,
) -> None:
    """Checks this installation; with ROBOT, what was understood of a robot file; with --config, a configuration."""
    from pliant.cli.doctor import doctor_command
    from pliant.cli.doctor_robot import print_robot

    if robot is None and locked:
        raise ConfigError("--locked is of a robot: pliant doctor ROBOT --locked JOINT=ANGLE")
    if robot is not None:
        print_robot(_out, robot, locked or [])
    if robot is None or config is not None:
        doctor_command(_out, config)


@app.command()
@guarded
def compare(
    target: Annotated[str, typer.Argument(metavar="TASK.toml|TASK|STUDY", help="What to run with each controller.")],
    controllers: Annotated[
        str, typer.Option(metavar="A,B,…", help="Controllers, by name or as MODULE:CLASS or FILE.py:CLASS.")
    ],
    case: Annotated[str | None, typer.Option(help="Variant of the task, or case of the study.")] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Seeds of each.")] = 3,
    jobs: Annotated[int, typer.Option(min=1, help="Runs at the same time, each in a process of its own.")] = 1,
    metric: Metrics = None,
    out: Out = None,
    set_: Sets = None,
) -> None:
    """Runs one task with several controllers, on the same seeds, and puts them into one table."""
    from pliant.cli.run import study_folder
    from pliant.cli.study import study_command
    from pliant.experiments.registry import get_study
    from pliant.experiments.results import Request

    names = tuple(name.strip() for name in controllers.split(",") if name.strip())
    if not names:
        raise ConfigError("--controllers needs at least one name, for example --controllers offset-free-mpc,haptic")
    cases = (case or next(iter(get_study(target).cases)),)
    request = Request(target, cases, seeds, (*(set_ or ()), *_own(metric)), controllers=names)
    study_command(_out, _err, request, out or study_folder(target) / "compare", jobs, None)


@app.command()
@guarded
def task(
    action: Annotated[str, typer.Argument(metavar="check|schema", help="What to do.")],
    target: Annotated[str | None, typer.Argument(metavar="[TASK.toml|TASK]", help="The task to check.")] = None,
    case: Annotated[str | None, typer.Option(help="Variant of the task.")] = None,
    robot: RobotOption = None,
    out: Out = None,
    set_: Sets = None,
) -> None:
    """Says whether a robot can do a task (check), or what can stand in a task file (schema)."""
    from pliant.cli.task import check_command, schema_command

    if action == "schema" and target is None:
        schema_command(_out, out)
    elif action == "check" and target is not None:
        check_command(_out, target, case, {"robot": robot}, set_ or [], out)
    else:
        raise ConfigError(f"write pliant task check TASK.toml, or pliant task schema, got {action!r} {target or ''}")


def _version(show: bool) -> None:
    if show:
        _out.print(f"pliant {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Prints the version.")
    ] = False,
) -> None:
    pass


def main() -> None:
    """Entry point."""
    app()
