"""Summaries as tables for the terminal: each value beside the paper's and the target, with missed targets marked."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rich.table import Table
from rich.text import Text

from pliant.telemetry.proportion import bound_text
from pliant.telemetry.summary import CaseSummary, Metric, Summary

MET, MISSED = "✓", "✗"
COUNTING = (
    "Means, deviations (n − 1) and worst runs are of the runs that reached their end; in brackets or after ≤ the"
    " one-sided 95 % Clopper–Pearson bound on the share of runs that fail."
)
"""how tables of several runs count"""


def summary_table(summary: Summary) -> Table:
    """A table with one row per metric, under case and controller; empty columns are left out."""
    title = f"{summary.study} · pliant {summary.version}" + ("" if summary.seed is None else f" · seed {summary.seed}")
    table = Table(title=title, title_justify="left", title_style="bold", header_style="bold", expand=False)
    if single := len(summary.cases) == 1:
        table.title = f"{title} · {summary.cases[0].case} · {summary.cases[0].name}"
    metrics = [metric for case in summary.cases for metric in case.metrics]
    columns = _Columns(
        paper=any(metric.paper is not None for metric in metrics),
        target=any(metric.target is not None for metric in metrics),
    )
    table.add_column("metric", overflow="fold")
    for heading in ("value", *columns.headings):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("unit")
    table.add_column("runs", justify="right", no_wrap=True)
    table.add_column("", width=1)
    for case in summary.cases:
        _add_case(table, case, columns, single)
    if any(case.runs > 1 for case in summary.cases):
        table.caption, table.caption_justify = COUNTING, "left"
    return table


@dataclass(frozen=True)
class _Columns:
    """The columns next to the value that are not empty."""

    paper: bool
    target: bool

    @property
    def headings(self) -> tuple[str, ...]:
        return ("paper",) * self.paper + ("target",) * self.target

    def cells(self, metric: Metric) -> tuple[str, ...]:
        return (number(metric.paper),) * self.paper + (target_text(metric),) * self.target


def number(value: float | None, digits: int = 3) -> str:
    """A number with the given significant digits, without an exponent if it is readable; a dash for None."""
    if value is None:
        return "–"
    if math.isnan(value):
        return "none"
    if math.isinf(value):
        return "never" if value > 0 else "-inf"
    if value == 0.0:
        return "0"
    magnitude = math.floor(math.log10(abs(value)))
    if -4 <= magnitude < 6:
        return f"{value:.{max(0, digits - 1 - magnitude)}f}"
    return f"{value:.{digits - 1}e}"


def value_text(metric: Metric) -> str:
    """Value, with its standard deviation over runs where there is one."""
    return number(metric.value) if metric.std is None else f"{number(metric.value)} ± {number(metric.std, 2)}"


def runs_text(metric: Metric) -> str:
    """Of how many runs the value is the mean or the worst; empty if it is not of several."""
    if metric.runs is None or metric.runs == 1:
        return "" if metric.runs is None else "1"
    return f"worst of {metric.runs}" if metric.worst else f"mean of {metric.runs}"


def target_text(metric: Metric) -> str:
    """The bound with its direction; a dash without one."""
    if metric.target is None:
        return "–"
    return f"{'≥' if metric.at_least else '≤'} {number(metric.target)}"


def failed_text(case: CaseSummary) -> str:
    """How many runs of a case did not reach their end, with the bound of `share_bound` on the share; empty for a single
    run that did."""
    count = len(case.failures)
    if not count:
        if case.runs <= 1:
            return ""
        return f"no run failed in {case.runs}; with 95 % confidence fewer than {bound_text(0, case.runs)} would"
    more = f" (and {count - 1} more)" if count > 1 else ""
    bound = f" (≤ {bound_text(count, case.runs)})" if case.runs > 1 else ""
    return f"{count} of {case.runs} runs failed{bound}: {case.failures[0]}{more}"


def _add_case(table: Table, case: CaseSummary, columns: _Columns, single: bool) -> None:
    if not single:
        table.add_row(Text(f"{case.case} · {case.name}", style="bold"))
    indent = "" if single else "  "
    for metric in case.metrics:
        missed = metric.met is False
        mark = "" if metric.met is None else MISSED if missed else MET
        table.add_row(
            indent + metric.name,
            Text(value_text(metric), style="bold red" if missed else ""),
            *columns.cells(metric),
            metric.unit,
            runs_text(metric),
            Text(mark, style="bold red" if missed else "green"),
        )
    blank = [""] * (len(columns.headings) + 3)
    if failed := failed_text(case):
        style, mark = ("bold red", MISSED) if case.failures else ("dim", "")
        table.add_row(Text(failed, style=style), *blank, Text(mark, style=style))
    if case.note:
        table.add_row(Text(case.note, style="dim"))
    table.add_section()
