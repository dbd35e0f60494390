"""Results of runs → the summary of a study. Only this module combines runs into rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pliant.experiments.base import Result, Study
from pliant.telemetry.summary import CaseSummary, Metric, Summary, over_runs

Groups = Mapping[tuple[str, str, str], Sequence[Result]]
"""(case, controller, label of the row) → runs"""


def summarised(study: Study[Any], results: Sequence[Result]) -> Summary:
    """One row per case, controller and label; seeds are averaged, failures counted, pairs of rows compared."""
    groups: dict[tuple[str, str, str], list[Result]] = {}
    for result in results:
        config = result.config
        groups.setdefault((config.case, config.controller, config.variant), []).append(result)
    seeds = {result.config.seed for result in results}
    return Summary(study.name, min(seeds, default=None), tuple(_row(study, groups, names) for names in groups))


def _row(study: Study[Any], groups: Groups, names: tuple[str, str, str]) -> CaseSummary:
    case, controller, label = names
    results = groups[names]
    ended = [run.metrics for run in results if run.failure is None]
    return CaseSummary(
        case=case,
        controller=controller,
        variant=label,
        metrics=(*over_runs(ended, study.worst), *_paired(study, groups, names)),
        runs=len(results),
        failures=tuple(f"seed {r.config.seed}: {r.failure}" for r in results if r.failure is not None),
        seeds=tuple(r.config.seed for r in results),
    )


def _paired(study: Study[Any], groups: Groups, names: tuple[str, str, str]) -> tuple[Metric, ...]:
    case, controller, label = names
    pairs = study.cases[case].pairs if case in study.cases else ()
    found = [
        pair.metrics(groups[names], groups.get((case, controller, pair.against), ()))
        for pair in pairs
        if pair.label == label
    ]
    return over_runs([[metric] for metrics in found for metric in metrics])
