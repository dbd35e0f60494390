"""Every function that makes text of metrics, against the exact text: a lost sign or a swapped column is noticed."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Mapping
from typing import Any

import pytest
from rich.console import Console

from pliant.cli import paper_tables
from pliant.experiments.base import Result, Study
from pliant.experiments.summarise import summarised
from pliant.studies.polishing import STUDY
from pliant.telemetry import markdown, proportion, table
from pliant.telemetry.summary import CaseSummary, Metric, Summary
from tests.telemetry.own_functions import functions_of

AVERAGED = Metric("RMSE y", -3.5, "mm", 2.0, -3.0, std=1.25, runs=2)
WORST = Metric("margin", -0.25, "J", None, -0.5, at_least=True, runs=3, worst=True)
CASE = CaseSummary("line", "stack", (AVERAGED, WORST), 4, ("seed 1: it | fell",), note="as printed", variant="no wall")
SUMMARY = Summary("stack", 7, (CASE, CaseSummary("line", "spring", (Metric("RMSE y", 12.25, "mm"),))), version="0")
LINES = """\
| case | controller | metric | value | paper | target | unit | runs | |
|---|---|---|---:|---:|---:|---|---|---|
| line | stack (no wall) | RMSE y | -3.50 ± 1.2 | 2.00 | ≤ -3.00 | mm | mean of 2 | ✓ |
| line | stack (no wall) | margin | -0.250 | – | ≥ -0.500 | J | worst of 3 | ✓ |
| line | spring | RMSE y | 12.2 | – | – | mm |  |  |

- line, stack (no wall): 1 of 4 runs failed (≤ 75 %): seed 1: it | fell
- line, stack (no wall): as printed

"""


def _rendered(summary: Summary) -> str:
    console = Console(file=io.StringIO(), width=100, color_system=None)
    with console.capture() as captured:
        console.print(table.summary_table(summary))
    return captured.get()


def _paper(without: float, within: float) -> str:
    case = STUDY.cases["tables-2-3-4"]
    runs: list[Result] = []
    for label, force in (("no PID", without), ("PID", within)):
        values = {"controller": "torque-feedback-mpc", "variant": label, "seed": 3}
        config = case.config.model_copy(update=values)
        runs.append(Result(config, case.beside(config, (Metric("E_λ", force, "N"), Metric("E_τ", 0.5 * force, "N·m")))))
    return paper_tables.paper_tables(STUDY, summarised(STUDY, runs))


ANSWERS: Mapping[str, tuple[Callable[[], Any], Any]] = {
    "number": (lambda: [table.number(x) for x in (-3.5, 0.0123456, 1e7, None)], ["-3.50", "0.0123", "1.00e+07", "–"]),
    "value_text": (lambda: table.value_text(AVERAGED), "-3.50 ± 1.2"),
    "runs_text": (lambda: [table.runs_text(m) for m in (AVERAGED, WORST)], ["mean of 2", "worst of 3"]),
    "target_text": (lambda: [table.target_text(m) for m in (AVERAGED, WORST)], ["≤ -3.00", "≥ -0.500"]),
    "failed_text": (lambda: table.failed_text(CASE), "1 of 4 runs failed (≤ 75 %): seed 1: it | fell"),
    "summary_table": (
        lambda: [
            line.replace("│", " ").split()
            for line in _rendered(SUMMARY).splitlines()
            if "RMSE y" in line or "margin" in line
        ],
        [
            ["RMSE", "y", "-3.50", "±", "1.2", "2.00", "≤", "-3.00", "mm", "mean", "of", "2", "✓"],
            ["margin", "-0.250", "–", "≥", "-0.500", "J", "worst", "of", "3", "✓"],
            ["RMSE", "y", "12.2", "–", "–", "mm"],
        ],
    ),
    "summary_markdown": (lambda: markdown.summary_markdown(SUMMARY).split(table.COUNTING)[0], LINES),
    "share_bound": (lambda: round(proportion.share_bound(1, 4), 4), 0.7514),  # Beta(2, 3): 1 − p⁴ (…)
    "share_text": (lambda: proportion.share_text(1, 4), "1 of 4: ≤ 75 %"),
    "bound_text": (lambda: proportion.bound_text(1, 4), "75 %"),
    "paper_tables": (
        lambda: [line for line in _paper(30.0, 41.5).splitlines() if "E_λ" in line],
        [
            "| E_λ, N, mean | 30.0 (33.98) |",
            "| E_λ, N, mean | 41.5 (12.44) |",
            "| ΔE_λ, N, mean | -11.5 (21.55) |",
        ],
    ),
}
"""function → call, answer"""


def test_every_function_that_makes_text_has_a_known_answer() -> None:
    assert functions_of(table, markdown, proportion, paper_tables) == set(ANSWERS)


@pytest.mark.parametrize("name", ANSWERS)
def test_text(name: str) -> None:
    call, answer = ANSWERS[name]
    assert call() == answer


def test_the_share_is_the_one_at_which_so_few_failures_have_five_percent() -> None:
    p = proportion.share_bound(1, 4)
    assert (1 - p) ** 4 + 4 * p * (1 - p) ** 3 == pytest.approx(0.05, abs=1e-9)
    assert math.isclose(proportion.share_bound(0, 10), 1.0 - 0.05**0.1, rel_tol=1e-9)


def test_a_pair_needs_both_runs() -> None:
    """Runs of which one failed are left out; others go by controller and seed."""
    study: Study[Any] = STUDY
    case = study.cases["tables-2-3-4"]
    pair = case.pairs[0]

    def ran(label: str, seed: int, force: float, failure: str | None = None) -> Result:
        config = case.config.model_copy(update={"variant": label, "seed": seed})
        return Result(config, () if failure else (Metric("E_λ", force, "N"),), failure)

    here = [ran("no PID", 0, 7.0), ran("no PID", 1, 6.0), ran("no PID", 2, 5.0), ran("no PID", 3, 1.0, "fell")]
    there = [ran("PID", 2, 9.0), ran("PID", 0, 2.0), ran("PID", 1, 0.0, "fell"), ran("PID", 3, 0.0)]
    assert [(m.name, m.value, m.unit) for m in pair.metrics(here, there)] == [("ΔE_λ", 5.0, "N"), ("ΔE_λ", -4.0, "N")]
