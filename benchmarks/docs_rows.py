"""The rows of one case as a table of a page: a line a row, a column a metric, the paper's numbers in brackets.

Run: pliant study polishing --case naive --seeds 1 --out naive; python benchmarks/docs_rows.py naive "E_λ,E_P,λ_max"

Names that have a comma themselves are parted by semicolons: "hold, rms; slide, rms". A last argument chooses a case.
"""

from __future__ import annotations

import sys
from pathlib import Path

from pliant.telemetry.summary import CaseSummary, Metric, Summary
from pliant.telemetry.table import value_text


def cell(row: CaseSummary, name: str) -> str:
    """The value with its deviation, and the paper's number."""
    found = next((metric for metric in row.metrics if metric.name == name), None)
    if found is None:
        return "–"
    return value_text(found) + ("" if found.paper is None else f" ({found.paper:g})")


def rows(summary: Summary, names: list[str], case: str | None = None) -> str:
    """Markdown. Args: case: the only one that is shown; None: all."""
    units: dict[str, Metric] = {}
    for row in summary.cases:
        for metric in row.metrics:
            units.setdefault(metric.name, metric)
    heads = [
        f"{name}, {units[name].unit}" if name in units and units[name].unit not in ("", "1") else name for name in names
    ]
    heads = [head.replace("|", "\\|") for head in heads]
    lines = [f"| controller | row | {' | '.join(heads)} | failed |", f"|---|---|{'---:|' * len(names)}---:|"]
    for row in summary.cases:
        if case not in (None, row.case):
            continue
        cells = [cell(row, name) for name in names]
        failed = f"{len(row.failures)} of {row.runs}"
        lines.append(f"| `{row.controller}` | {row.variant or '–'} | {' | '.join(cells)} | {failed} |")
    return "\n".join(lines)


if __name__ == "__main__":
    wanted = sys.argv[2].split(";" if ";" in sys.argv[2] else ",")
    print(rows(Summary.read(Path(sys.argv[1])), [name.strip() for name in wanted], *sys.argv[3:4]))
