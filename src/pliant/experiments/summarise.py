"""Results of runs → the summary of a study."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pliant.experiments.base import Result, Study
from pliant.telemetry.summary import Case, Summary, over_runs


def summarised(study: Study[Any], results: Sequence[Result]) -> Summary:
    """One row per case, controller and variant; seeds are averaged, failures counted."""
    groups: dict[tuple[str, str, str], list[Result]] = {}
    for result in results:
        config = result.config
        groups.setdefault((config.case, config.controller, config.variant), []).append(result)
    seeds = {result.config.seed for result in results}
    return Summary(
        study.name, min(seeds, default=None), tuple(_case(study, *names, found) for names, found in groups.items())
    )


def _case(study: Study[Any], case: str, controller: str, variant: str, results: Sequence[Result]) -> Case:
    failures = tuple(f"seed {r.config.seed}: {r.failure}" for r in results if r.failure is not None)
    name = f"{controller} ({variant})" if variant else controller
    return Case(
        case=case,
        controller=name,
        metrics=over_runs([r.metrics for r in results if r.failure is None], study.worst),
        runs=len(results),
        failures=failures,
        seeds=tuple(r.config.seed for r in results),
    )
