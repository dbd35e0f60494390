"""What the strength of the elbow's task costs the tool."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.experiments.case import Case
from pliant.experiments.result import Result
from pliant.telemetry.plots import sweep

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def balance_figure(case: Case[Any], results: Sequence[Result]) -> Mapping[str, Figure]:
    """Tool error against the strength of the elbow's task; none of fewer than two runs."""
    curves: dict[float, list[float]] = {}
    for result in results:
        row = case.row_of(result.config)
        if row is not None and row.value is not None and result.metrics:
            values = {metric.name: metric.value for metric in result.metrics}
            curves[row.value] = [values[f"RMSE {axis}"] for axis in "xyz"]
    if len(curves) < 2:
        return {}
    forces = sorted(curves)
    errors = np.array([curves[force] for force in forces])
    ordered = {f"tool, {axis}": errors[:, i] for i, axis in enumerate("xyz")}
    labels = ("F_max of the elbow's task, N", "RMSE of the tool, mm")
    return {"balance": sweep(np.array(forces), ordered, *labels, "Tool error against the strength of the elbow's task")}
