"""The file `summary.json`: the metrics of every case of a study beside the paper's numbers and the targets."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

import pliant
from pliant.errors import OutputError
from pliant.files import read_file
from pliant.telemetry.output import write_text

FILE = "summary.json"
_LARGEST = 1e8  # bytes


@dataclass(frozen=True, slots=True)
class Metric:
    """One metric of a run or of a set of runs."""

    name: str
    value: float
    """NaN where no run gave one"""
    unit: str
    paper: float | None = None
    """the number that the paper prints"""
    target: float | None = None
    """the bound that the value should keep"""
    at_least: bool = False
    """whether the target is a lower bound; else an upper one"""
    std: float | None = None
    """sample standard deviation over runs, of n − 1"""
    runs: int | None = None
    """number of runs of the value, all of which reached their end; None: it is not of several runs"""
    worst: bool = False
    """whether it is the worst of those runs, else their mean"""

    @property
    def met(self) -> bool | None:
        """Whether the target is kept; None without a target. A value that is not finite keeps none."""
        if self.target is None:
            return None
        return self.value >= self.target if self.at_least else self.value <= self.target


@dataclass(frozen=True, slots=True)
class CaseSummary:
    """The result of one case with one controller."""

    case: str
    controller: str
    metrics: tuple[Metric, ...] = ()
    runs: int = 1
    """runs that were started"""
    failures: tuple[str, ...] = ()
    """one sentence per run that did not reach its end; such runs count"""
    seeds: tuple[int, ...] = ()
    note: str = ""
    """choices that the reader should know"""
    variant: str = ""
    """label of the row, where a controller has several"""

    @property
    def name(self) -> str:
        """Controller and label, for people."""
        return f"{self.controller} ({self.variant})" if self.variant else self.controller

    def metric(self, name: str) -> Metric:
        """The metric of that name. Raises KeyError if there is none."""
        for metric in self.metrics:
            if metric.name == name:
                return metric
        raise KeyError(name)


@dataclass(frozen=True, slots=True)
class Summary:
    """The results of a study."""

    study: str
    seed: int | None
    cases: tuple[CaseSummary, ...] = ()
    version: str = field(default=pliant.__version__)

    def write(self, folder: Path) -> Path:
        """Writes `summary.json` into a folder.

        Returns:
            The file.

        Raises:
            OutputError: it cannot be written.
        """
        path = folder / FILE
        content = {
            "study": self.study,
            "version": self.version,
            "seed": self.seed,
            "cases": [_case_to_json(case) for case in self.cases],
        }
        write_text(path, json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
        return path

    @staticmethod
    def read(path: Path) -> Summary:
        """Reads a `summary.json`, or the one in a folder.

        Raises:
            OutputError: it cannot be read or is not a summary.
        """
        path = path / FILE if path.is_dir() else path
        try:
            content = json.loads(read_file(path, _LARGEST).decode("utf-8-sig"))
            cases = tuple(_case_from_json(entry) for entry in content["cases"])
            return Summary(content["study"], content["seed"], cases, content["version"])
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
            raise OutputError(f"{path} is not a summary of a pliant study ({type(error).__name__}: {error})") from error


def over_runs(runs: Sequence[Sequence[Metric]], worst: Collection[str] = ()) -> tuple[Metric, ...]:
    """Mean and sample standard deviation (n − 1) of each metric over runs, or the worst run's value.

    Args:
        runs: the metrics of each run that reached its end; failed runs are excluded, from means and from worst values,
            and counted separately. A metric that some runs lack is averaged over the others; one that is not finite
            makes the mean so, so that no failure hides.
        worst: names of metrics that the worst run decides, as λ_max and t_break do in [FFMPC]; those have no deviation.

    Returns:
        One metric per name, in the order of first appearance, with the number of runs that it is of.
    """
    values: dict[str, list[Metric]] = {}
    for run in runs:
        for metric in run:
            values.setdefault(metric.name, []).append(metric)
    return tuple(_worst(found) if name in worst else _averaged(found) for name, found in values.items())


def _averaged(found: Sequence[Metric]) -> Metric:
    numbers = [metric.value for metric in found]
    mean = float(np.mean(numbers))  # NaN and infinity pass through
    if len(found) == 1:
        return replace(found[0], runs=1)
    deviation = float(np.std(numbers, ddof=1)) if math.isfinite(mean) else math.nan
    return replace(found[0], value=mean, std=deviation, runs=len(found))


def _worst(found: Sequence[Metric]) -> Metric:
    numbers = [metric.value for metric in found]
    worst = float(np.min(numbers) if found[0].at_least else np.max(numbers))
    return replace(found[0], value=worst, runs=len(found), worst=True)


def _case_to_json(case: CaseSummary) -> dict[str, Any]:
    content: dict[str, Any] = {
        "case": case.case,
        "controller": case.name,
        "metrics": {metric.name: _metric_to_json(metric) for metric in case.metrics},
        "runs": case.runs,
        "failed": len(case.failures),
        "failure": list(case.failures),
        "seeds": list(case.seeds),
    }
    if case.variant:
        content["row"] = {"controller": case.controller, "variant": case.variant}
    if case.note:
        content["note"] = case.note
    return content


def _metric_to_json(metric: Metric) -> dict[str, Any]:
    content: dict[str, Any] = {"value": _number(metric.value), "unit": metric.unit, "paper": metric.paper}
    if metric.target is not None:
        content |= {"target": metric.target, "met": metric.met}
    if metric.at_least:
        content["at_least"] = True
    if metric.std is not None:
        content["std"] = _number(metric.std)
    if metric.runs is not None:
        content |= {"runs": metric.runs, "statistic": "worst" if metric.worst else "mean"}
    return content


def _number(value: float) -> float | None:
    """JSON has no NaN and no infinity: both become null."""
    return float(value) if math.isfinite(value) else None


def _case_from_json(content: dict[str, Any]) -> CaseSummary:
    metrics = tuple(
        Metric(
            name=name,
            value=math.nan if about["value"] is None else float(about["value"]),
            unit=about["unit"],
            paper=about["paper"],
            target=about.get("target"),
            at_least=about.get("at_least", False),
            std=about.get("std"),
            runs=about.get("runs"),
            worst=about.get("statistic") == "worst",
        )
        for name, about in content["metrics"].items()
    )
    row = content.get("row", {"controller": content["controller"]})
    return CaseSummary(
        case=content["case"],
        controller=row["controller"],
        variant=row.get("variant", ""),
        metrics=metrics,
        runs=content.get("runs", 1),
        failures=tuple(content.get("failure", ())),
        seeds=tuple(content.get("seeds", ())),
        note=content.get("note", ""),
    )
