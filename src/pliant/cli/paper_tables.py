"""Tables of a study in the form of the paper, in Markdown, from its summary."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pliant.experiments.base import Study
from pliant.experiments.case import PaperTable
from pliant.telemetry.proportion import share_text
from pliant.telemetry.summary import CaseSummary, Metric, Summary
from pliant.telemetry.table import value_text


def paper_tables(study: Study[Any], summary: Summary) -> str:
    """Every table that has rows; empty without any."""
    parts: list[str] = []
    for name, case in study.cases.items():
        for table in case.tables:
            rows = [row for row in summary.cases if (row.case, row.variant) == (name, table.label)]
            if any(_found(row, metric) for row in rows for metric in table.metrics):
                parts.append(f"## {table.title}\n\n{_markdown(table, rows)}")
    return "\n".join(parts)


def _markdown(table: PaperTable, rows: Sequence[CaseSummary]) -> str:
    """A line per metric, a column per controller; the paper's number in brackets. Failed runs count in the last line
    only."""
    lines = ["| | " + " | ".join(row.controller for row in rows) + " |", "|---|" + "---:|" * len(rows)]
    for name, heading in table.metrics.items():
        found = [_found(row, name) for row in rows]
        statistic = "worst" if any(metric and metric.worst for metric in found) else "mean"
        cells = [_cell(metric, _ended(row)) for metric, row in zip(found, rows, strict=True)]
        lines.append(f"| {heading}, {statistic} | " + " | ".join(cells) + " |")
    lines.append("| runs that means and worst are of | " + " | ".join(f"{_ended(row)}" for row in rows) + " |")
    bounds = [share_text(len(row.failures), row.runs) for row in rows]
    lines.append("| failed, one-sided 95 % bound | " + " | ".join(bounds) + " |")
    return "\n".join(lines) + "\n"


def _ended(row: CaseSummary) -> int:
    return row.runs - len(row.failures)


def _found(row: CaseSummary, name: str) -> Metric | None:
    return next((metric for metric in row.metrics if metric.name == name), None)


def _cell(metric: Metric | None, ended: int) -> str:
    """The value, the number of runs it is of if some runs lack it, and the paper's number."""
    if metric is None:
        return "–"
    fewer = "" if metric.runs in (None, ended) else f", n = {metric.runs}"
    return value_text(metric) + fewer + ("" if metric.paper is None else f" ({metric.paper:g})")
