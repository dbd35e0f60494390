"""The paper's tables from our own runs, its numbers beside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pliant.experiments.base import Result
from pliant.studies.polishing.measure import WORST
from pliant.studies.polishing.paper import DIFFERENCE, STOCK
from pliant.telemetry.proportion import share_text
from pliant.telemetry.summary import Metric, over_runs
from pliant.telemetry.table import number, value_text

_SHORT = {
    "E_P": "E_P, mm",
    "E_λ": "E_λ, N",
    "λ_max": "λ_max, N",
    "λ_dev": "max \\|f − f̄\\|, N",
    "t_break": "t_break, %",
}
_TITLES = {
    ("tables-2-3-4", "no PID"): "Table II, without the drives' torque loop, δ_o = 0",
    ("tables-2-3-4", "PID"): "Table III, with the drives' torque loop, δ_o = 0",
    ("tables-2-3-4-delayed", "no PID"): "Table II, without the drives' torque loop, δ_o = 5 ms",
    ("tables-2-3-4-delayed", "PID"): "Table III, with the drives' torque loop, δ_o = 5 ms",
    ("slow", ""): "Table V, slow circle, horizontal table (the paper's numbers: on its robot)",
    ("slow-tilted", ""): "Table VI, slow circle, tilted table (the paper's numbers: on its robot)",
    ("fast-tilted", ""): "Table VII, fast circle, tilted table (the paper's numbers: on its robot)",
    ("fast-pushed", ""): "Fast circle under pushes",
    ("square", ""): "Force steps on one spot (the paper's numbers: on its robot)",
}
"""(case, variant) → heading"""


def report(results: Sequence[Result]) -> str:
    """Markdown: the tables of which there are runs."""
    groups: dict[tuple[str, str], dict[str, list[Result]]] = {}
    for result in results:
        config = result.config
        groups.setdefault((config.case, config.variant), {}).setdefault(config.controller, []).append(result)
    parts = [f"## {title}\n\n{_table(groups[key])}" for key, title in _TITLES.items() if key in groups]
    parts += [
        f"## {heading}\n\n{_difference(groups[case, 'no PID'], groups[case, 'PID'])}"
        for case, heading in (
            ("tables-2-3-4", "Table IV, without minus with the torque loop, δ_o = 0"),
            ("tables-2-3-4-delayed", "Table IV, without minus with the torque loop, δ_o = 5 ms"),
        )
        if (case, "PID") in groups and (case, "no PID") in groups
    ]
    return "\n".join(parts)


def _table(found: Mapping[str, Sequence[Result]]) -> str:
    """A row per metric, a column per controller; the paper's number in brackets. Runs that failed enter no row but
    the last one."""
    columns = {name: {m.name: m for m in _averaged(runs)} for name, runs in found.items()}
    lines = ["| | " + " | ".join(columns) + " |", "|---|" + "---:|" * len(columns)]
    for name, title in _SHORT.items():
        statistic = "worst" if name in WORST else "mean"
        lines.append(
            f"| {title}, {statistic} | " + " | ".join(_cell(metrics.get(name)) for metrics in columns.values()) + " |"
        )
    failed = [sum(r.failure is not None for r in runs) for runs in found.values()]
    counts = [(count, len(runs)) for count, runs in zip(failed, found.values(), strict=True)]
    lines.append("| runs that means and worst are of | " + " | ".join(f"{n - count}" for count, n in counts) + " |")
    lines.append("| failed, one-sided 95 % bound | " + " | ".join(share_text(*pair) for pair in counts) + " |")
    return "\n".join(lines) + "\n"


def _averaged(runs: Sequence[Result]) -> tuple[Metric, ...]:
    return over_runs([run.metrics for run in runs if run.failure is None], WORST)


def _cell(metric: Metric | None) -> str:
    if metric is None:
        return "–"
    return value_text(metric) + ("" if metric.paper is None else f" ({metric.paper:g})")


def _difference(without: Mapping[str, Sequence[Result]], within: Mapping[str, Sequence[Result]]) -> str:
    """Mean ± sample deviation (n − 1) over pairs of runs with the same draws, and how many; pairs of which one failed
    are left out."""
    names = [name for name in without if name in within]
    lines = ["| | " + " | ".join(names) + " |", "|---|" + "---:|" * len(names)]
    for metric, unit in (("E_λ", "N"), ("E_τ", "N·m")):
        cells: list[str] = []
        for name in names:
            pairs = _pairs(without[name], within[name], metric)
            paper = f" ({DIFFERENCE[metric][STOCK.index(name)]:g})" if name in STOCK else ""
            text = _mean_text(pairs)
            cells.append(text + paper)
        lines.append(f"| Δ{metric}, {unit} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _mean_text(values: Sequence[float]) -> str:
    if not values:
        return "–"
    deviation = f" ± {number(float(np.std(values, ddof=1)), 2)}" if len(values) > 1 else ""
    return f"{number(float(np.mean(values)))}{deviation}, n = {len(values)}"


def _pairs(without: Sequence[Result], within: Sequence[Result], metric: str) -> list[float]:
    partner = {r.config.seed: _value(r, metric) for r in within if r.failure is None}
    return [
        _value(r, metric) - partner[r.config.seed] for r in without if r.failure is None and r.config.seed in partner
    ]


def _value(result: Result, name: str) -> float:
    return next(metric.value for metric in result.metrics if metric.name == name)
