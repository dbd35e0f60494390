"""What each parameter does: the same steps on a rigid floor and on a soft ball, one parameter changed at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.configuration import parse_assignments
from pliant.experiments.case import Case, Row
from pliant.experiments.result import Result
from pliant.studies.haptic.scene_config import Material
from pliant.telemetry.plots import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Parameter:
    """One parameter and the values that are tried."""

    key: str
    """as in `--set`; {} is where the value goes"""
    label: str
    values: tuple[float, ...]


PARAMETERS: tuple[Parameter, ...] = (
    Parameter("exploration.gain={}", "gain k_I, 1/s", (10.0, 25.0, 45.0, 100.0)),
    Parameter("exploration.speed={}", "speed v_max, m/s", (0.02, 0.05, 0.15, 0.5)),
    Parameter("exploration.stiffness_floor={}", "stiffness_floor, N/m", (100.0, 300.0, 1000.0, 6000.0)),
    Parameter("exploration.window={}", "window, s", (0.005, 0.01, 0.02, 0.06)),
    Parameter("impedance.stiffness=[6000.0, 6000.0, {}]", "K_0 along z, N/m", (2000.0, 4000.0, 8000.0, 12000.0)),
    Parameter("impedance.range=[0.025, 0.025, {}]", "x_b along z, m", (0.005, 0.010, 0.015, 0.025)),
    Parameter("impedance.force_max=[150.0, 150.0, {}]", "F_max along z, N", (12.0, 18.0, 50.0, 300.0)),
    Parameter("planner.speed={}", "planner's speed, m/s", (0.05, 0.1, 0.2, 0.4)),
)
SURFACES: Mapping[str, Material] = {"rigid": Material(), "soft": Material(stiffness=1e3, damping=1e2)}


def parameter_rows() -> list[Row]:
    """Every parameter's values on every surface."""
    rows: list[Row] = []
    for surface, material in SURFACES.items():
        ground = {"environment": {"floor": {"material": material.model_dump()}}}
        for parameter in PARAMETERS:
            for value in parameter.values:
                changes = ground | parse_assignments([parameter.key.format(value)])
                label = f"{surface} · {parameter.label} · {value:g}"
                rows.append(Row(label, changes=changes, group=(surface, parameter.label), value=value))
    return rows


def parameter_figure(case: Case[Any], results: Sequence[Result]) -> Mapping[str, Figure]:
    """Settling time of a force step up and down, against each parameter; crosses never settle."""
    found: dict[tuple[tuple[str, ...], float], Mapping[str, float]] = {}
    for result in results:
        row = case.row_of(result.config)
        if row is not None and row.value is not None:
            found[row.group, row.value] = {metric.name: metric.value for metric in result.metrics}
    if not found:
        return {}
    made = style.figure(11.0, 4.8, "What each parameter does: steps from 10 to 15 N and back to 10 N")
    axes = made.subplots(2, 4).ravel()
    for ax, parameter in zip(axes, PARAMETERS, strict=True):
        _panel(ax, parameter, found)
    style.legend(axes[3], outside=True)
    return {"parameters": made}


def _panel(ax: Axes, parameter: Parameter, found: Mapping[tuple[tuple[str, ...], float], Mapping[str, float]]) -> None:
    style.dress(ax, parameter.label, "settle, s")
    x = np.arange(len(parameter.values))
    for index, (surface, name) in enumerate((s, n) for s in SURFACES for n in ("up", "down")):
        runs = [found.get(((surface, parameter.label), value), {}) for value in parameter.values]
        y = np.array([run.get(name, np.nan) for run in runs])
        colour, finite = style.colour(index), np.isfinite(y)
        label = f"{surface}, {name}"
        ax.plot(x[finite], y[finite], "o-", color=colour, linewidth=style.LINE, markersize=3.2, label=label)
        never = x[~finite]
        ax.plot(never, np.full(never.shape, 0.97 - 0.05 * index), "x", color=colour, transform=ax.get_xaxis_transform())
    ax.set_xticks(x, [f"{value:g}" for value in parameter.values])
    ax.set_ylim(0.0, 0.5)
