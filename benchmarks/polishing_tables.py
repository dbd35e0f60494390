"""The tables of the polishing study's page and of the README, from the results of its runs.

Run: pliant study polishing --case tables-2-3-4 --jobs 2 --out tables; python benchmarks/polishing_tables.py tables

Each case that a folder has replaces its table between <!-- name of the case --> and <!-- end --> in
`docs/study_polishing.md`; both cases of the paper's tables together that of the README, too.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from docs_rows import rows
from docs_tables import found_in
from tasks import put_into

from pliant.cli.paper_tables import paper_tables
from pliant.experiments.registry import get_study
from pliant.experiments.results import read_results
from pliant.experiments.summarise import summarised
from pliant.telemetry.proportion import share_text
from pliant.telemetry.summary import CaseSummary, Summary
from pliant.telemetry.table import value_text

PAGE, README = Path("docs/study_polishing.md"), Path("README.md")
PAPER = ("tables-2-3-4", "tables-2-3-4-delayed", "square", "slow", "slow-tilted", "fast-tilted", "fast-pushed")
SWEPT: Mapping[str, Sequence[str]] = {
    "horizon": ("E_λ", "E_P", "λ_max", "t_break"),
    "stiffness": ("E_λ", "E_P", "λ_max", "t_break"),
    "force-weight": ("E_λ", "E_P", "λ_max", "t_break"),
    "iterations": ("E_λ", "E_P", "λ_max", "t_break"),
    "anchor": ("E_λ", "E_P", "λ_max", "t_break", "first contact peak"),
    "ripple": ("E_λ", "E_P", "λ_max"),
    "ten-circles": ("E_λ of a circle", "E_λ from circle to circle", "E_P of a circle", "E_P from circle to circle"),
    "naive": ("E_λ", "E_P", "λ_max", "t_break"),
    "torque-loop": ("E_λ", "t_break", "E_τ", "E_τ averaged over 21 ms"),
    "sensor-mismatch": ("E_λ", "E_P", "E_τ averaged over 21 ms"),
}
"""case → metrics of its table with a line a row"""
LOOPS = {"PID": "with", "no PID": "without"}


def cell(row: CaseSummary | None, name: str) -> str:
    metric = None if row is None else found_in(row, name)
    return "–" if metric is None else value_text(metric)


def failed(row: CaseSummary | None) -> str:
    return "–" if row is None else f"{len(row.failures)} of {row.runs}"


def by_paper(case: str, summary: Summary) -> str:
    """The report's tables, with bold titles in place of headings."""
    return re.sub(r"^## (.*)$", r"**\1**", paper_tables(get_study("polishing"), summary), flags=re.MULTILINE).rstrip()


def ablation(case: str, summary: Summary) -> str:
    """With and without the drives' torque loop side by side."""
    by_name = {(row.controller, row.variant): row for row in summary.cases if row.case == case}
    lines = [
        "| controller | | E_λ, N | E_P, mm | failed | E_λ, N, no PID | E_P, mm, no PID | failed, no PID |",
        f"|---|---|{6 * '---:|'}",
    ]
    for controller, variant in by_name:
        if (part := variant.removesuffix(", PID")) == variant:
            continue
        cells: list[str] = []
        for loop in ("PID", "no PID"):
            row = by_name.get((controller, f"{part}, {loop}"))
            cells += [cell(row, "E_λ"), cell(row, "E_P"), failed(row)]
        lines.append(f"| `{controller}` | {part} | {' | '.join(cells)} |")
    return "\n".join(lines)


def robustness(case: str, summary: Summary) -> str:
    """A line for each thing that was changed, with its bounds."""
    lines = [
        "| | E_λ, N | E_P, mm | λ_max, N | t_break, % | target E_λ / E_P | failed |",
        f"|---|{6 * '---:|'}",
    ]
    for row in (row for row in summary.cases if row.case == case):
        values = [cell(row, name) for name in ("E_λ", "E_P", "λ_max", "t_break")]
        bounds = [m.target for name in ("E_λ", "E_P") if (m := found_in(row, name)) and m.target is not None]
        bound = " / ".join(f"{bound:g}" for bound in bounds) or "–"
        lines.append(f"| {row.variant} | {' | '.join(values)} | {bound} | {failed(row)} |")
    return "\n".join(lines)


def masses(case: str, summary: Summary) -> str:
    """A column for each controller."""
    columns = [row for row in summary.cases if row.case == case]
    lines = [f"| | {' | '.join(row.controller for row in columns)} |", f"|---|{len(columns) * '---:|'}"]
    for name, head in {"E_λ": "E_λ, N", "E_P": "E_P, mm", "λ_max": "λ_max, N"}.items():
        lines.append(f"| {head} | {' | '.join(cell(row, name) for row in columns)} |")
    bounds = [share_text(len(row.failures), row.runs) for row in columns]
    return "\n".join([*lines, f"| failed, one-sided 95 % bound | {' | '.join(bounds)} |"])


def swept(case: str, summary: Summary) -> str:
    return rows(summary, list(SWEPT[case]), case)


def readme(summary: Summary) -> str:
    """Both cases of the paper's tables: a line for each controller with and without the drives' torque loop."""
    lines = [
        "| force error E_λ, N / position error E_P, mm; with or without the drives' torque loop | at once | 5 ms late |"
        " target at 5 ms | paper |",
        "|---|---:|---:|---:|---:|",
    ]
    names = dict.fromkeys(row.controller for row in summary.cases if row.case in PAPER[:2])
    for label, loop in LOOPS.items():
        for controller in names:
            both = [_of(summary, case, controller, label) for case in PAPER[:2]]
            judged, paper = (
                [value for name in ("E_λ", "E_P") if (value := _first(these, name, what)) is not None]
                for these, what in ((both[1:], "target"), (both, "paper"))
            )
            cells = [_errors(row) for row in both]
            cells += [" / ".join(f"{value:g}" for value in values) or "–" for values in (judged, paper)]
            lines.append(f"| `{controller}`, {loop} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _of(summary: Summary, *wanted: str) -> CaseSummary | None:
    return next((row for row in summary.cases if (row.case, row.controller, row.variant) == wanted), None)


def _first(rows: Sequence[CaseSummary | None], name: str, what: str) -> float | None:
    """Target or paper's number of a metric, of the first row that has one."""
    metrics = [metric for row in rows if row is not None and (metric := found_in(row, name))]
    return next((value for metric in metrics if (value := getattr(metric, what)) is not None), None)


def _errors(row: CaseSummary | None) -> str:
    """Both errors with the runs that failed and how many there were."""
    if row is None:
        return "–"
    if len(row.failures) == row.runs:
        return f"all {row.runs} failed"
    ended = f"; {len(row.failures)} of {row.runs} failed" if row.failures else f" ({row.runs} runs)"
    return f"{cell(row, 'E_λ')} / {cell(row, 'E_P').partition(' ')[0]}{ended}"


FORMS: Mapping[str, Callable[[str, Summary], str]] = {
    **dict.fromkeys(PAPER, by_paper),
    **dict.fromkeys(SWEPT, swept),
    "ablation": ablation,
    "robustness": robustness,
    "wrong-masses": masses,
}


def main(*folders: str) -> None:
    results = [run.result for folder in folders for run in read_results(Path(folder) / "results.parquet")[1]]
    study = get_study("polishing")
    for case in dict.fromkeys(result.config.case for result in results):
        summary = summarised(study, [result for result in results if result.config.case == case])
        for row in summary.cases:
            missed = [metric.name for metric in row.metrics if metric.met is False]
            if missed or row.failures:
                print(f"{case}, {row.name}: missed {missed or 'nothing'}, failed {failed(row)}", file=sys.stderr)
        put_into(PAGE, case, FORMS[case](case, summary))
    if {result.config.case for result in results} >= set(PAPER[:2]):
        put_into(README, "polishing", readme(summarised(study, results)))


if __name__ == "__main__":
    main(*sys.argv[1:])
