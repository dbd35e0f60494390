"""Figures of several runs together: [FFMPC] Figs. 4 and 6 to 9, its parameter studies, and ours."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pliant.experiments.base import Result
from pliant.spatial import Array
from pliant.studies.polishing.cases import ALL
from pliant.studies.polishing.config import FRAME, PolishingConfig
from pliant.studies.polishing.targets import targets_of
from pliant.telemetry.log import Log
from pliant.telemetry.plots import Curve, Panel, dots, save, sweep, time_series

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COMPARED = ("square", "slow", "slow-tilted", "fast-tilted", "fast-pushed")
"""cases whose controllers are drawn over each other, and the figure of the paper that shows the same on its robot"""
_PAPER_FIGURE = {"square": 4, "slow": 6, "slow-tilted": 7, "fast-tilted": 8, "fast-pushed": 9}
_METRICS = {"E_λ": "force error E_λ, N", "E_P": "position error E_P, mm"}
_FILES = {"E_λ": "force", "E_P": "position"}


def _force_factor(config: PolishingConfig) -> float:
    return float(config.variant.removeprefix("× "))


_SWEPT: Mapping[str, tuple[Callable[[PolishingConfig], float], str, Callable[[str], bool]]] = {
    "horizon": (lambda c: float(c.parameters().model_dump()["horizon"]), "nodes N of 3 ms", lambda v: "over" not in v),
    "force-weight": (_force_factor, "factor of the force weight", lambda v: True),
    "iterations": (
        lambda c: float(c.parameters().model_dump()["max_iterations"]),
        "most SQP iterations per solve",
        lambda v: True,
    ),
}
"""case → what varies, the label of its axis, which variants belong to it"""
_IN_ROWS = (
    "tables-2-3-4",
    "tables-2-3-4-delayed",
    "horizon",
    "stiffness",
    "anchor",
    "ripple",
    "ablation",
    "robustness",
)
"""cases that are drawn with a row per controller and variant"""


def summary_figures(results: Sequence[Result], folder: Path) -> list[Path]:
    """Every figure for which there are runs."""
    by_case: dict[str, list[Result]] = {}
    for result in results:
        by_case.setdefault(result.config.case, []).append(result)
    made: dict[str, Figure] = {}
    for case, runs in by_case.items():
        if case in COMPARED and (figure := _compared(case, runs)) is not None:
            made[case] = figure
        if case in _SWEPT:
            made |= {f"{case}_{_FILES[metric]}": _swept(case, runs, metric) for metric in _METRICS}
        if case in _IN_ROWS:
            made |= {f"{case}_rows_{_FILES[metric]}": _rows(case, runs, metric) for metric in _METRICS}
    return [
        save(figure, folder / f"{name.replace('λ', 'force').replace('P', 'position')}.png")
        for name, figure in made.items()
    ]


def _compared(case: str, results: Sequence[Result]) -> Figure | None:
    """Force and position error of every controller that left a log."""
    logs = {r.config.controller: Log.open(r.log) for r in results if r.log is not None and r.log.exists()}
    if not logs:
        return None
    first = next(iter(logs.values()))
    time = first.time(f"reference/{FRAME}/wrench")
    force = [Curve("reference", time, first[f"reference/{FRAME}/wrench"][:, 2], "reference")]
    error: list[Curve] = []
    for name, log in logs.items():
        label, time = name.removesuffix("-mpc"), log.time(f"truth/{FRAME}/wrench")
        off = log[f"truth/{FRAME}/position"][:, :2] - log[f"reference/{FRAME}/position"][:, :2]
        force.append(Curve(label, time, log[f"truth/{FRAME}/wrench"][:, 2]))
        error.append(Curve(label, time, 1e3 * np.linalg.norm(off, axis=1)))
    panels = [Panel("normal force, N", force), Panel("horizontal error, mm", error)]
    return time_series(panels, title=f"{case}, as [FFMPC] Fig. {_PAPER_FIGURE[case]}", phases=first.phases())


def _swept(case: str, results: Sequence[Result], metric: str) -> Figure:
    """Mean over runs against a parameter, one curve per controller."""
    value, label, belongs = _SWEPT[case]
    found: dict[str, dict[float, list[float]]] = {}
    for result in results:
        config = result.config
        assert isinstance(config, PolishingConfig)
        if belongs(config.variant):
            found.setdefault(config.controller, {}).setdefault(value(config), []).append(_number(result, metric))
    parameter = np.array(sorted({x for curve in found.values() for x in curve}))
    most = max(len(runs) for curve in found.values() for runs in curve.values())
    curves = {
        name.removesuffix("-mpc"): np.array([_padded(curve.get(x, []), most) for x in parameter])
        for name, curve in found.items()
    }
    return sweep(parameter, curves, label, _METRICS[metric], f"polishing, {case}", log_x=case == "force-weight")


def _rows(case: str, results: Sequence[Result], metric: str) -> Figure:
    """A row per controller and variant."""
    rows: dict[str, list[float]] = {}
    targets: dict[str, float] = {}
    single = len({result.config.controller for result in results}) == 1
    ordered = sorted(results, key=lambda r: ALL.index(r.config.controller) if r.config.controller in ALL else len(ALL))
    for result in ordered:
        config = result.config
        assert isinstance(config, PolishingConfig)
        parts = (config.variant,) if single else (config.controller.removesuffix("-mpc"), config.variant)
        label = ", ".join(part for part in parts if part)
        rows.setdefault(label, []).append(_number(result, metric))
        if (bound := targets_of(config).get(metric)) is not None:
            targets[label] = bound
    values: dict[str, Array] = {label: np.array(numbers) for label, numbers in rows.items()}
    return dots(values, _METRICS[metric], f"polishing, {case}", targets)


def _number(result: Result, name: str) -> float:
    """NaN for a run that failed."""
    if result.failure is not None:
        return float("nan")
    return next((metric.value for metric in result.metrics if metric.name == name), float("nan"))


def _padded(runs: Sequence[float], size: int) -> list[float]:
    return [*runs, *[float("nan")] * (size - len(runs))]
