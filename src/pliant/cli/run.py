"""`pliant run`: one case, with a progress bar, a table, figures, a log and summary.json."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console

from pliant.cli.choose import default_folder, resolve
from pliant.cli.progress import progress_bar
from pliant.cli.report import print_results, save_summary
from pliant.errors import RunFailedError
from pliant.experiments.base import CaseConfig, Experiment, Study, check_windows
from pliant.experiments.origins import origins
from pliant.experiments.repeat import write_config
from pliant.experiments.runner import run_case
from pliant.rules import Rule
from pliant.telemetry.output import output_folder


def run_command(
    console: Console,
    complain: Console,
    target: str,
    case: str | None,
    overrides: Mapping[str, Any],
    assignments: Sequence[str],
    out: Path | None,
    live: bool = False,
    figures: bool = True,
) -> None:
    """Runs one case. Args: live: with a live page, at the speed of wall time; figures: whether to write figures.

    Raises:
        PliantError: bad input; nothing was run.
        RunFailedError: the run stopped early; what was recorded is kept.
    """
    choice = resolve(target, case, overrides, assignments)
    study, config = choice.study, choice.config
    check_windows(config)
    folder = output_folder(out or default_folder(study, config.case))
    experiment = study.build(config)
    for note in experiment.robot.notes:
        complain.print(f"note: {note}", markup=False, highlight=False, soft_wrap=True)
    _warn(complain, experiment.warnings)
    again = write_config(study, config, folder)  # written before the run, so that an interrupted run can be repeated
    with (
        _page(console, complain, study, config, experiment, folder, live) as more,
        progress_bar(complain, f"{study.name} {config.case} · {config.controller}") as progress,
    ):
        result = run_case(study, config, folder, progress=progress, figures=figures, **more)
    _warn(complain, result.warnings[len(experiment.warnings) :])
    summary = save_summary(study, [result], folder)
    if result.failure is not None:
        if result.metrics:  # it reached its end, but its metrics may still make it a failure
            print_results(console, study, [result])
        raise RunFailedError(f"{result.failure}; the log until then is {result.log}")
    print_results(console, study, [result])
    files = [("log", result.log), ("summary", summary), *(("figure", figure) for figure in result.figures)]
    console.print()
    for what, file in (*files, ("again", f"pliant run {again}")):
        console.print(f"{what:7s}  {file}", markup=False, highlight=False, soft_wrap=True)


def _warn(complain: Console, warnings: Sequence[str]) -> None:
    for warning in warnings:
        complain.print(f"warning: {warning}", style="yellow", markup=False, highlight=False, soft_wrap=True)


@contextmanager
def _page(
    console: Console,
    complain: Console,
    study: Study[Any],
    config: CaseConfig,
    experiment: Experiment,
    folder: Path,
    live: bool,
) -> Generator[dict[str, Any], None, None]:
    """Arguments of `run_case`: with a page, a loop that the page can show and steer."""
    if not live:
        yield {"experiment": experiment}
        return
    from pliant.cli.live import DEFAULT_HOST, announce, require_viser

    require_viser()
    from pliant.live.server.run_page import page_for_run

    def tell(url: str, exposed: bool) -> None:
        announce(console, complain, url, exposed)

    with page_for_run(study, config, experiment, DEFAULT_HOST, 0, folder, tell) as page:
        yield {"experiment": page.experiment, "observers": page.observers, "pace": page.pace}


def show_config(
    console: Console,
    target: str,
    case: str | None,
    overrides: Mapping[str, Any],
    assignments: Sequence[str],
) -> None:
    """Prints each value of a run, its unit and its origin, and the rules of what is suggested; runs nothing.

    Raises:
        PliantError: bad input.
    """
    choice = resolve(target, case, overrides, assignments)
    rows = origins(choice, choice.study.build(choice.config).parameters)
    rules = list(dict.fromkeys(row.rule for row in rows if row.rule is not None))
    numbers: dict[Rule | None, str] = {rule: f" [{number}]" for number, rule in enumerate(rules, start=1)}
    named = [(row.key, row.shown, row.unit, row.origin + numbers.get(row.rule, "")) for row in rows]
    table = [("key", "value", "unit", "from"), *named]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    lines = ["  ".join(map(str.ljust, cells, widths)) for cells in table]
    told = [f"{number.strip()} {rule.told}" for rule, number in numbers.items() if rule is not None]
    for line in (*lines, *(["", "rules of what is suggested:", *told] if told else ())):
        console.print(line.rstrip(), markup=False, highlight=False, soft_wrap=True)
