"""The tables of the pages on the stack and the haptic study, from the results of their runs.

Run: pliant study stack --seeds 2 --out stack; python benchmarks/docs_tables.py stack stack
     pliant study haptic --seeds 2 --out haptic; python benchmarks/docs_tables.py haptic haptic

Several folders are put together, so that a study may be run case by case; of the same run the last one counts.
"""

from __future__ import annotations

import sys
from pathlib import Path

from pliant.experiments.base import Result
from pliant.experiments.registry import get_study
from pliant.experiments.results import key, read_results
from pliant.experiments.summarise import summarised
from pliant.telemetry.summary import CaseSummary, Metric, Summary
from pliant.telemetry.table import number, target_text, value_text

AXES = ("RMSE x", "RMSE y", "RMSE z")
COMPARED = ("figure8-plain", "figure8-gazebo", "figure8-hardware", "line-hardware")


def stack_tables(summary: Summary) -> str:
    """RMSE and largest torque step of every case, then every controller on four of them."""
    lines = [
        "| case | runs | pliant, RMSE x / y / z (mm) | paper | target | largest torque step (% of limit) |",
        "|---|---:|---|---|---|---:|",
    ]
    for row in summary.cases:
        if row.name == "stack" and all(found_in(row, name) for name in AXES):
            values, paper, target = _three(row)
            step = found_in(row, "torque step")
            cells = (f"`{row.case}`", str(row.runs), values, paper, target, number(step.value) if step else "–")
            lines.append(f"| {' | '.join(cells)} |")
    names = dict.fromkeys(row.name for row in summary.cases if row.case in COMPARED)
    lines += ["", "| controller | " + " | ".join(f"`{case}`" for case in COMPARED) + " |", "|---|" + "---|" * 4]
    for name in names:
        rows = [next((r for r in summary.cases if (r.case, r.name) == (case, name)), None) for case in COMPARED]
        lines.append(f"| {name} | " + " | ".join(_compared(row) for row in rows) + " |")
    return "\n".join(lines)


def haptic_table(summary: Summary) -> str:
    """A line per metric of every case, the printed algorithm beside it."""
    lines = ["| case | runs | metric | pliant | target | as printed |", "|---|---:|---|---:|---:|---:|"]
    for row in summary.cases:
        if row.controller != "haptic" or row.variant:
            continue
        printed = next((r for r in summary.cases if (r.case, r.controller) == (row.case, "haptic-paper")), None)
        for metric in row.metrics:
            beside = found_in(printed, metric.name) if printed else None
            unit = "" if metric.unit in ("1", "") else f", {metric.unit}"
            ours, theirs = _value(metric), _value(beside) if beside else "–"
            target = target_text(metric) if metric.target is not None else ""
            name = metric.name.replace("|", "\\|")
            lines.append(f"| {row.case} | {row.runs} | {name}{unit} | {ours} | {target} | {theirs} |")
    return "\n".join(lines)


def _value(metric: Metric) -> str:
    return "< 1e-6" if 0.0 < metric.value < 1e-6 else value_text(metric)


def found_in(row: CaseSummary, name: str) -> Metric | None:
    return next((metric for metric in row.metrics if metric.name == name), None)


def _three(row: CaseSummary) -> tuple[str, str, str]:
    found = [metric for name in AXES if (metric := found_in(row, name))]
    papers, targets = [m.paper for m in found], [m.target for m in found]
    paper = "–" if None in papers else " / ".join(f"{p:g}" for p in papers if p is not None)
    target = "–" if None in targets else " / ".join(f"{t:g}" for t in targets if t is not None)
    return " / ".join(value_text(m) for m in found), paper, target


def _compared(row: CaseSummary | None) -> str:
    if row is None:
        return "–"
    failed = f"{len(row.failures)} of {row.runs} failed" if row.failures else ""
    return failed if len(row.failures) == row.runs else ", ".join(filter(None, (_three(row)[0], failed)))


def main(name: str, *folders: str) -> None:
    study, runs = get_study(name), dict[str, Result]()
    for folder in folders:
        for run in read_results(Path(folder) / "results.parquet")[1]:
            runs[key(run.result.config)] = run.result
    summary = summarised(study, list(runs.values()))
    print(stack_tables(summary) if name == "stack" else haptic_table(summary))
    for row in summary.cases:
        for failure in row.failures:
            print(f"failed: {row.case}, {row.name}, {failure}", file=sys.stderr)
        missed = [metric.name for metric in row.metrics if metric.met is False]
        if missed:
            print(f"missed: {row.case}, {row.name}: {', '.join(missed)}", file=sys.stderr)


if __name__ == "__main__":
    main(*sys.argv[1:])
