"""`pliant study`: every case of a study, with baselines and seeds; tables and figures, with the paper's numbers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from pliant.cli.choose import study_folder
from pliant.cli.paper_tables import paper_tables
from pliant.cli.progress import count_bar
from pliant.cli.report import print_results, save_summary
from pliant.errors import ConfigError, RunFailedError
from pliant.experiments.base import CaseConfig, Result, Study
from pliant.experiments.lock import locked
from pliant.experiments.open_pool import open_pool
from pliant.experiments.registry import get_study
from pliant.experiments.results import Request, ResultStore, Run, key, read_results, unsettled
from pliant.experiments.summarise import summarised
from pliant.experiments.sweep import asked_runs, check_buildable, sweep
from pliant.telemetry.markdown import summary_markdown
from pliant.telemetry.output import output_folder, write_text


def study_command(
    console: Console, complain: Console, request: Request, out: Path | None, jobs: int, scheduler: str | None
) -> None:
    """Runs a study, or some of its cases.

    Failed runs are counted and shown; after Ctrl-C the finished runs are kept.

    Raises:
        PliantError: bad input; nothing was run.
        RunFailedError: every run failed.
    """
    asked = asked_runs(request)
    if not request.controllers:
        _notes(complain, request, asked)
    folder = output_folder(out or study_folder(request.study))
    with locked(folder):
        _run(console, complain, request, asked, [], folder, jobs, scheduler)


def resume_command(
    console: Console, complain: Console, folder: Path, study: str | None, jobs: int, scheduler: str | None
) -> None:
    """Continues an interrupted study: makes the runs that its `results.parquet` lacks, and reports on all runs.

    Raises:
        PliantError: bad input; nothing was run.
        RunFailedError: every run failed.
    """
    if not folder.is_dir():
        raise ConfigError(f"--resume needs the folder of a study that was begun, got {folder}, which is not a folder")
    with locked(output_folder(folder)):
        _resume(console, complain, folder, study, jobs, scheduler)


def _notes(complain: Console, request: Request, asked: Sequence[CaseConfig]) -> None:
    study, first = get_study(request.study), {config.case: config for config in reversed(asked)}
    for config in reversed(first.values()):
        if note := study.note(config):
            complain.print(f"note: {note}", markup=False, highlight=False, soft_wrap=True)


def _resume(
    console: Console, complain: Console, folder: Path, study: str | None, jobs: int, scheduler: str | None
) -> None:
    request, runs = read_results(folder)
    if study not in (None, request.study):
        raise ConfigError(f"{folder} holds results of study {request.study!r}, not of {study!r}")
    asked = asked_runs(request)
    known = {key(config) for config in asked}
    if any(key(run.result.config) not in known for run in runs):
        raise ConfigError(f"{folder} holds runs that study {request.study!r} no longer has; start it again in another")
    _run(console, complain, request, asked, [run for run in runs if run.settled], folder, jobs, scheduler)


def _run(
    console: Console,
    complain: Console,
    request: Request,
    asked: Sequence[CaseConfig],
    before: Sequence[Run],
    folder: Path,
    jobs: int,
    scheduler: str | None,
) -> None:
    study, rest = get_study(request.study), unsettled(asked, before)
    for first in {config.controller: config for config in reversed(rest)}.values():  # one run of each controller
        check_buildable(request.study, first)
    store = ResultStore(folder, request, asked)
    store.add_before(before)
    whole = False
    try:
        _sweep(complain, store, request, rest, folder, min(jobs, max(len(rest), 1)), scheduler)
        whole = True
    except KeyboardInterrupt:
        raise KeyboardInterrupt(_how_to_resume(store, len(asked), folder)) from None
    finally:
        if store.runs:
            _finish(console, study, [run.result for run in store.runs], folder, store.path, figures=whole)
    results = [run.result for run in store.runs]
    if all(result.failure is not None for result in results):
        raise RunFailedError(f"all {len(results)} runs failed; the first: {results[0].failure}")


def _sweep(
    complain: Console,
    store: ResultStore,
    request: Request,
    rest: Sequence[CaseConfig],
    folder: Path,
    jobs: int,
    scheduler: str | None,
) -> None:
    done = len(store.runs)
    with (
        open_pool(jobs, scheduler) as pool,
        count_bar(complain, f"study {request.study}", done + len(rest), done) as step,
    ):
        store.begin()
        for run in sweep(request.study, rest, folder, pool=pool, logs=request.logs):
            store.add(run)
            step(run.result.failure is not None)


def _how_to_resume(store: ResultStore, total: int, folder: Path) -> str:
    return f"{len(store.runs)} of {total} runs are kept; go on with: pliant study --resume {folder}"


def _finish(
    console: Console, study: Study[Any], results: Sequence[Result], folder: Path, table: Path, *, figures: bool
) -> None:
    """Writes and prints the summary of all runs; after an interruption, without figures."""
    summary = save_summary(study, results, folder)
    report = folder / "report.md"
    rows = summarised(study, results)
    parts = (f"# {study.title}\n", paper_tables(study, rows), summary_markdown(rows))
    write_text(report, "\n".join(part for part in parts if part))
    print_results(console, study, results)
    drawn = study.summary_figures(results, folder) if figures else []
    files = [("summary", summary), ("report", report), ("results", table)]
    for kind, path in [*files, *(("figure", figure) for figure in drawn)]:
        console.print(f"{kind:8s} {path}", markup=False, highlight=False, soft_wrap=True)
