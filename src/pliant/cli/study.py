"""`pliant study`: every case of a study, with control arms and seeds; tables and figures beside the paper's."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from pliant.cli.progress import count_bar
from pliant.cli.report import print_results, save_summary, summarised
from pliant.errors import RunFailedError
from pliant.studies.base import CaseConfig, Result, Study
from pliant.studies.config import merged, parse_assignments
from pliant.studies.registry import get_study
from pliant.studies.sweep import sweep
from pliant.telemetry.markdown import summary_markdown
from pliant.telemetry.output import output_folder, write_text


def study_command(
    console: Console,
    complain: Console,
    name: str,
    cases: Sequence[str],
    seeds: int | None,
    jobs: int,
    logs: bool,
    assignments: Sequence[str],
    out: Path | None,
) -> None:
    """Runs a study, or some of its cases.

    Failed runs are counted and shown; Ctrl-C keeps what was finished.

    Raises:
        PliantError: bad input; nothing was run.
        RunFailedError: every run failed.
    """
    study = get_study(name)
    changes = parse_assignments(assignments)
    runs = [merged(config, changes) for case in cases or study.cases for config in study.runs(case, seeds)]
    folder = output_folder(out or Path("pliant-out") / name)
    results: list[Result] = []
    try:
        with count_bar(complain, f"study {name}", len(runs)) as done:
            for result in sweep(name, runs, folder, jobs=jobs, logs=logs):
                results.append(result)
                done()
    finally:
        if results:
            _finish(console, study, _in_order(results, runs), folder)
    if all(result.failure is not None for result in results):
        raise RunFailedError(f"all {len(results)} runs failed; the first: {results[0].failure}")


def _finish(console: Console, study: Study[Any], results: Sequence[Result], folder: Path) -> None:
    summary = save_summary(study, results, folder)
    report = folder / "report.md"
    parts = (f"# {study.title}\n", study.report(results), summary_markdown(summarised(study, results)))
    write_text(report, "\n".join(part for part in parts if part))
    print_results(console, study, results)
    figures = study.summary_figures(results, folder)
    for kind, path in [("summary", summary), ("report", report), *(("figure", figure) for figure in figures)]:
        console.print(f"{kind:8s} {path}", markup=False, highlight=False, soft_wrap=True)


def _in_order(results: Sequence[Result], runs: Sequence[CaseConfig]) -> list[Result]:
    """The results in the order in which the runs were asked for, whichever ended first."""
    place = {config.model_dump_json(): index for index, config in enumerate(runs)}
    return sorted(results, key=lambda result: place[result.config.model_dump_json()])
