"""Commands that run something: `pliant run`, `study`, `live`, `compare`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from pliant.cli import program
from pliant.cli.guarded import guarded
from pliant.cli.program import Controller, Metrics, Out, RobotOption, Seed, Sets
from pliant.errors import ConfigError


@program.app.command()
@guarded
def run(
    target: Annotated[
        str,
        typer.Argument(
            metavar="[TASK.toml|TASK|STUDY|CONFIG.toml|FILE.mcap]",
            help="A task file, the name of a task or study, a TOML file with `study = ...` and any of its values, or"
            " the config.toml or log of a run, which is then repeated.",
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
    figures: Annotated[bool, typer.Option("--figures/--no-figures", help="Whether to write figures.")] = True,
    show: Annotated[
        bool, typer.Option("--show-config", help="Prints each value, its unit and its origin; runs nothing.")
    ] = False,
) -> None:
    """Runs one case: a table, figures, a log, summary.json, and config.toml, which repeats it."""
    from pliant.cli.run import run_command, show_config

    overrides = {"controller": controller, "robot": robot, "seed": seed, "own_metrics": metric}
    if show:
        show_config(program.out, target, case, overrides, set_ or [])
        return
    run_command(program.out, program.err, target, case, overrides, set_ or [], out, live, figures)


@program.app.command()
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
    jobs: Annotated[int, typer.Option(min=1, help="Number of parallel runs, each in its own process.")] = 1,
    scheduler: Annotated[
        str | None, typer.Option(metavar="tcp://HOST:PORT", help="Uses the workers of a running dask scheduler.")
    ] = None,
    resume: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Continues an interrupted study: makes the runs that are missing in DIR."),
    ] = None,
    logs: Annotated[
        bool, typer.Option("--logs", help="Keeps the log of every run, not only of those with figures.")
    ] = False,
    tune: Annotated[
        str | None,
        typer.Option(
            metavar="CONTROLLER",
            help="Searches for the best parameters of this controller instead, on the robot of a --case.",
        ),
    ] = None,
    trials: Annotated[
        int | None, typer.Option(min=1, help="Number of parameter sets that --tune tries.", show_default="64")
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed of --tune's search.", show_default="0")] = None,
    metric: Metrics = None,
    out: Out = None,
    set_: Sets = None,
) -> None:
    """Runs a whole study with its baselines: the tables and figures of a paper, with the paper's numbers."""
    from pliant.cli.study import resume_command, study_command
    from pliant.experiments.results import Request

    rest = {"--seeds": seeds, "--logs": logs, "--metric": metric}
    if tune is not None:
        from pliant.cli.tune import tune_command

        _refuse("--tune", rest | {"--resume": resume, "more than one --case": (case or [])[1:]})
        where = case[0] if case else None
        search = (name or "stack", tune, where, trials or 64, seed or 0, set_ or [])
        tune_command(program.out, program.err, *search, out, jobs, scheduler)
        return
    if trials is not None or seed is not None:
        raise ConfigError("--trials and --seed belong to --tune CONTROLLER, which is missing")
    if resume is not None:
        _refuse("--resume", rest | {"--case": case, "--set": set_, "--out": out})
        resume_command(program.out, program.err, resume, name, jobs, scheduler)
        return
    request = Request(name or "stack", tuple(case or ()), seeds, (*(set_ or ()), *_own(metric)), logs)
    study_command(program.out, program.err, request, out, jobs, scheduler)


def _own(metric: list[str] | None) -> tuple[str, ...]:
    return (f"own_metrics={json.dumps(metric)}",) if metric else ()


def _refuse(option: str, others: Mapping[str, object]) -> None:
    given = [name for name, value in others.items() if value]
    if given:
        raise ConfigError(f"{option} cannot be combined with {', '.join(given)}")


@program.app.command()
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
        str,
        typer.Option(
            help="Address to listen at. With any but the default, other machines that have the link can connect."
        ),
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port of the page; 0: any free port.")] = 8080,
    out: Out = None,
    set_: Sets = None,
) -> None:
    """Opens a page in the browser that shows the robot, changes parameters and pushes links."""
    from pliant.cli.live import live_command

    overrides = {"controller": controller, "robot": robot, "seed": seed}
    live_command(program.out, program.err, target, case, overrides, set_ or [], host, port, out)


@program.app.command()
@guarded
def compare(
    target: Annotated[
        str, typer.Argument(metavar="TASK.toml|TASK|STUDY", help="Task, study or file that each controller runs.")
    ],
    controllers: Annotated[
        str, typer.Option(metavar="A,B,…", help="Controllers, by name or as MODULE:CLASS or FILE.py:CLASS.")
    ],
    case: Annotated[str | None, typer.Option(help="Variant of the task, or case of the study.")] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Number of seeds per controller.")] = 3,
    jobs: Annotated[int, typer.Option(min=1, help="Number of parallel runs, each in its own process.")] = 1,
    metric: Metrics = None,
    out: Out = None,
    set_: Sets = None,
) -> None:
    """Runs one task with several controllers and the same seeds, and prints one table."""
    from pliant.cli.choose import study_folder
    from pliant.cli.study import study_command
    from pliant.experiments.registry import get_study
    from pliant.experiments.results import Request

    names = tuple(name.strip() for name in controllers.split(",") if name.strip())
    if not names:
        raise ConfigError("--controllers needs at least one name, for example --controllers offset-free-mpc,haptic")
    cases = (case or next(iter(get_study(target).cases)),)
    request = Request(target, cases, seeds, (*(set_ or ()), *_own(metric)), controllers=names)
    study_command(program.out, program.err, request, out or study_folder(target) / "compare", jobs, None)
