"""Summaries as Markdown, for reports and documentation."""

from __future__ import annotations

from pliant.telemetry.summary import CaseSummary, Summary
from pliant.telemetry.table import COUNTING, MET, MISSED, failed_text, number, runs_text, target_text, value_text


def summary_markdown(summary: Summary) -> str:
    """One table per summary: a row per metric, failed runs and notes below it."""
    lines = [
        "| case | controller | metric | value | paper | target | unit | runs | |",
        "|---|---|---|---:|---:|---:|---|---|---|",
    ]
    for case in summary.cases:
        lines += _rows(case)
    remarks = [
        f"- {case.case}, {case.name}: {text}"
        for case in summary.cases
        for text in (failed_text(case), case.note)
        if text
    ]
    if any(case.runs > 1 for case in summary.cases):
        remarks += ["", COUNTING]
    return "\n".join([*lines, *(["", *remarks] if remarks else [])]) + "\n"


def _rows(case: CaseSummary) -> list[str]:
    rows: list[str] = []
    for metric in case.metrics:
        mark = "" if metric.met is None else MET if metric.met else MISSED
        value = f"**{value_text(metric)}**" if metric.met is False else value_text(metric)
        cells = (
            case.case,
            case.name,
            metric.name,
            value,
            number(metric.paper),
            target_text(metric),
            metric.unit,
            runs_text(metric),
            mark,
        )
        rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return rows
