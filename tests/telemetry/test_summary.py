"""Summaries: the file's exact form, runs that failed, tables that mark what was missed."""

from __future__ import annotations

import io
import json
import math
from pathlib import Path

import pytest
from rich.console import Console

import pliant
from pliant.errors import OutputError
from pliant.telemetry import CaseSummary, Metric, Summary, output_folder, over_runs
from pliant.telemetry.markdown import summary_markdown
from pliant.telemetry.proportion import bound_text
from pliant.telemetry.table import number, summary_table

SUMMARY = Summary(
    "stack",
    3,
    (
        CaseSummary(
            "figure8-plain",
            "capped",
            (
                Metric("rmse x", 0.81, "mm", paper=5.6, target=1.0, std=0.02),
                Metric("rmse y", 2.3, "mm", paper=4.6, target=1.2),
                Metric("settling", math.inf, "s", target=0.1),
                Metric("reach", 31.0, "N", target=30.0, at_least=True),
            ),
            runs=10,
            failures=("diverged at t = 3.1000 s",),
            seeds=tuple(range(10)),
        ),
        CaseSummary("figure8-plain", "spring", (Metric("peak torque", 176.0, "N·m"),), note="baseline"),
    ),
)


def test_the_file_has_the_promised_form(tmp_path: Path) -> None:
    content = json.loads(SUMMARY.write(tmp_path).read_text(encoding="utf-8"))
    assert {"study": "stack", "version": pliant.__version__, "seed": 3}.items() <= content.items()
    first = content["cases"][0]
    assert (first["case"], first["controller"]) == ("figure8-plain", "capped")
    assert {"value": 0.81, "unit": "mm", "paper": 5.6}.items() <= first["metrics"]["rmse x"].items()
    assert first["metrics"]["settling"]["value"] is None  # JSON has no infinity
    assert (first["runs"], first["failed"]) == (10, 1)
    assert content["cases"][1]["metrics"]["peak torque"] == {"value": 176.0, "unit": "N·m", "paper": None}


def test_what_was_written_is_read_back(tmp_path: Path) -> None:
    read = Summary.read(SUMMARY.write(tmp_path).parent)
    assert read.cases[1] == SUMMARY.cases[1]
    assert read.cases[0].metrics[:2] == SUMMARY.cases[0].metrics[:2]
    assert math.isnan(read.cases[0].metric("settling").value)
    assert read.cases[0].failures == SUMMARY.cases[0].failures


def test_targets() -> None:
    assert [metric.met for metric in SUMMARY.cases[0].metrics] == [True, False, False, True]
    assert Metric("x", 1.0, "").met is None
    assert Metric("x", math.nan, "", target=1.0).met is False
    assert Metric("x", math.nan, "", target=1.0, at_least=True).met is False


def test_mean_over_runs_hides_no_failure() -> None:
    runs = [(Metric("a", value, "N", 2.0, 3.0),) for value in (1.0, 2.0, 6.0)]
    (mean,) = over_runs(runs)
    assert mean.value == pytest.approx(3.0)
    assert mean.std == pytest.approx(math.sqrt(14.0 / 2.0))  # of n − 1
    assert (mean.runs, mean.worst) == (3, False)
    assert over_runs(runs[:1])[0].runs == 1
    assert over_runs(runs[:1])[0].std is None
    assert (mean.unit, mean.paper, mean.target) == ("N", 2.0, 3.0)
    (spoiled,) = over_runs([*runs, (Metric("a", math.nan, "N", 2.0, 3.0),)])
    assert math.isnan(spoiled.value)
    assert spoiled.met is False
    (never,) = over_runs([*runs, (Metric("a", math.inf, "N", 2.0, 3.0),)])
    assert never.value == math.inf


def test_the_worst_run_decides_where_it_should() -> None:
    runs = [
        (Metric("peak", value, "N", target=5.0), Metric("reach", value, "N", target=5.0, at_least=True))
        for value in (1.0, 9.0)
    ]
    largest, least = over_runs(runs, worst=("peak", "reach"))
    assert (largest.value, largest.met, largest.std) == (9.0, False, None)
    assert (largest.runs, largest.worst) == (2, True)
    assert (least.value, least.met) == (1.0, False)
    spoiled, _ = over_runs([*runs, (Metric("peak", math.nan, "N", target=5.0),)], worst=("peak",))
    assert math.isnan(spoiled.value)


def test_table_and_markdown_show_targets_and_failures() -> None:
    console = Console(width=160, record=True, file=io.StringIO())
    console.print(summary_table(SUMMARY))
    table = console.export_text()
    markdown = summary_markdown(SUMMARY)
    for text in (table, markdown):
        for expected in (
            "0.810 ± 0.020",
            "5.60",
            "≤ 1.00",
            "≥ 30.0",
            "never",
            "1 of 10 runs failed (≤ 39 %): diverged",
            "baseline",
        ):
            assert expected in text
        assert (text.count("✗"), text.count("✓")) in {(2, 2), (3, 2)}  # the terminal marks the failed run too
    assert "**2.30**" in markdown


def test_a_comparison_is_readable_at_eighty_columns() -> None:
    """Names of metrics stay whole, and columns that say nothing are left out."""
    metrics = tuple(Metric(f"landing_peak_force_{k}", 12.3456, "N", std=0.0123, runs=10) for k in range(3))
    cases = tuple(CaseSummary(name, "torque-feedback-mpc", metrics, runs=10) for name in ("wipe", "wipe-tilted"))
    console = Console(width=80, record=True, file=io.StringIO())
    console.print(summary_table(Summary("task", "0", cases)))
    text = console.export_text()
    assert text.count("landing_peak_force_1 ") == 2
    assert "wipe-tilted · torque-feedback-mpc" in text
    assert "paper" not in text
    assert "target" not in text
    whole = Summary("task", "0", (CaseSummary("wipe", "stack", (Metric("peak", 1.0, "N", paper=2.0, target=3.0),)),))
    console.print(summary_table(whole))
    text = console.export_text()
    assert all(word in text for word in ("paper", "target", "≤ 3.00"))


def test_the_bound_on_a_share_is_a_percentage() -> None:
    assert bound_text(2, 2) == "100 %"
    assert bound_text(0, 2) == "78 %"
    assert bound_text(0, 100) == "3 %"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1234.0, "1234"),
        (0.00123, "0.00123"),
        (99.96, "100.0"),
        (-2.0, "-2.00"),
        (1e-7, "1.00e-07"),
        (None, "–"),
    ],
)
def test_numbers_have_three_digits(value: float | None, text: str) -> None:
    assert number(value) == text


def test_output_folders(tmp_path: Path) -> None:
    assert output_folder(tmp_path / "a" / "b").is_dir()
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="a file of that name is there"):
        output_folder(tmp_path / "file")
    with pytest.raises(OutputError, match="cannot be created"):
        output_folder(tmp_path / "file" / "below")
    with pytest.raises(OutputError, match="cannot be"):
        output_folder("/proc/pliant")
    with pytest.raises(OutputError, match="cannot be written"):
        SUMMARY.write(tmp_path / "nowhere")


@pytest.mark.parametrize(
    "content", ["", "[]", '{"study": "x"}', '{"study": "x", "seed": 1, "version": "1", "cases": [1]}']
)
def test_a_file_that_is_no_summary(tmp_path: Path, content: str) -> None:
    (tmp_path / "summary.json").write_text(content)
    with pytest.raises(OutputError, match="not a summary"):
        Summary.read(tmp_path)


def test_every_row_says_of_how_many_runs_it_is() -> None:
    runs = [(Metric("a", value, "N"), Metric("peak", value, "N")) for value in (1.0, 2.0, 6.0)]
    metrics = over_runs(runs, worst=("peak",))
    summary = Summary(
        "toy", 0, (CaseSummary("c", "x", metrics, runs=5, failures=("fell", "fell")), CaseSummary("d", "x", runs=140))
    )
    text = summary_markdown(summary)
    assert "| c | x | a | 3.00 ± 2.6 | – | – | N | mean of 3 |  |" in text
    assert "| c | x | peak | 6.00 | – | – | N | worst of 3 |  |" in text
    assert "- c, x: 2 of 5 runs failed (≤ 81 %): fell (and 1 more)" in text
    assert "- d, x: no run failed in 140; with 95 % confidence fewer than 2.1 % would" in text
    assert "one-sided 95 % Clopper–Pearson bound" in text


def test_the_statistics_survive_the_file(tmp_path: Path) -> None:
    metrics = over_runs([(Metric("a", v, "N"), Metric("peak", v, "N")) for v in (1.0, 3.0)], worst=("peak",))
    path = Summary("toy", 0, (CaseSummary("c", "x", metrics, runs=2),)).write(tmp_path)
    stored = json.loads(path.read_text(encoding="utf-8"))["cases"][0]["metrics"]
    assert (stored["a"]["runs"], stored["a"]["statistic"]) == (2, "mean")
    assert (stored["peak"]["runs"], stored["peak"]["statistic"]) == (2, "worst")
    assert Summary.read(path).cases[0].metrics == metrics
