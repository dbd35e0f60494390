"""Figures of many runs of a case, from the values of its rows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from pliant.experiments.base import CaseConfig
from pliant.experiments.case import Case
from pliant.experiments.result import Result
from pliant.experiments.runner import file_stem
from pliant.simulation.snapshot import Camera, Snapshot, render
from pliant.spatial import Array
from pliant.telemetry.plots import dots, save, sweep

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Later = Callable[[], "Figure | None"]
"""a figure that waits for its pictures"""
CaseFigure = Callable[[Case[Any], Sequence[Result]], Mapping[str, "Figure"]]


@dataclass(frozen=True)
class Drawn:
    """A metric of a figure."""

    name: str
    label: str
    """of its axis"""
    file: str
    """part of the file's name"""


def pictures_later(
    model: mujoco.MjModel,
    snapshots: Sequence[Snapshot],
    camera: Camera,
    size: tuple[int, int],
    draw: Callable[[Sequence[Array]], Figure],
) -> Later:
    """Begins to render pictures in a child process, which needs some seconds, while other figures are drawn.

    Args:
        model, snapshots, camera: as of `render`.
        size: width and height of a picture in pixels.
        draw: makes the figure of the pictures.

    Returns:
        Waits for the pictures and draws the figure; its answer is None if this machine cannot render.
    """
    beside = ThreadPoolExecutor(1)
    begun = beside.submit(render, model, snapshots, camera, width=size[0], height=size[1])
    beside.shutdown(wait=False)

    def drawn() -> Figure | None:
        pictures = begun.result()
        return None if pictures is None else draw(pictures)

    return drawn


def saved_figures(config: CaseConfig, folder: Path, figures: Mapping[str, Figure | Later | None]) -> list[Path]:
    """Files of the figures of one run.

    Args:
        config: of the run.
        folder: where they go.
        figures: end of the file's name → figure, or what waits for it; None: could not be drawn.
    """
    stem, made = file_stem(config), dict[str, Path]()
    for name, one in sorted(figures.items(), key=lambda item: callable(item[1])):  # what is waited for comes last
        drawn = one() if callable(one) else one
        if drawn is not None:
            made[name] = save(drawn, folder / f"{stem}_{name}.png")
    return [made[name] for name in figures if name in made]


def against_value(metrics: Sequence[Drawn], label: str, title: str, log_x: bool = False) -> CaseFigure:
    """The mean over runs against the rows' values, one curve per controller. Args: label: of the rows' values."""

    def figure(case: Case[Any], results: Sequence[Result]) -> Mapping[str, Figure]:
        name = case.config.case
        return {f"{name}_{m.file}": _swept(case, results, m, label, f"{title}, {name}", log_x) for m in metrics}

    return figure


def in_rows(metrics: Sequence[Drawn], title: str) -> CaseFigure:
    """A line per controller and row, a dot per run, with the row's target."""

    def figure(case: Case[Any], results: Sequence[Result]) -> Mapping[str, Figure]:
        name = case.config.case
        return {f"{name}_rows_{m.file}": _rows(results, m, f"{title}, {name}") for m in metrics}

    return figure


def short(controller: str) -> str:
    """A controller's name where all are of one kind."""
    return controller.removesuffix("-mpc")


def _swept(case: Case[Any], results: Sequence[Result], metric: Drawn, label: str, title: str, log_x: bool) -> Figure:
    found: dict[str, dict[float, list[float]]] = {}
    for result in results:
        row = case.row_of(result.config)
        if row is not None and row.value is not None:
            found.setdefault(result.config.controller, {}).setdefault(row.value, []).append(_number(result, metric))
    parameter = np.array(sorted({x for curve in found.values() for x in curve}))
    most = max((len(runs) for curve in found.values() for runs in curve.values()), default=0)
    curves = {
        short(name): np.array([_padded(curve.get(x, []), most) for x in parameter]) for name, curve in found.items()
    }
    return sweep(parameter, curves, label, metric.label, title, log_x=log_x)


def _rows(results: Sequence[Result], metric: Drawn, title: str) -> Figure:
    rows: dict[str, list[float]] = {}
    targets: dict[str, float] = {}
    single = len({result.config.controller for result in results}) == 1
    order = list(dict.fromkeys(result.config.controller for result in results))
    for result in sorted(results, key=lambda result: order.index(result.config.controller)):
        config = result.config
        parts = (config.variant,) if single else (short(config.controller), config.variant)
        label = ", ".join(part for part in parts if part)
        rows.setdefault(label, []).append(_number(result, metric))
        for one in result.metrics:
            if one.name == metric.name and one.target is not None:
                targets[label] = one.target
    values: dict[str, Array] = {label: np.array(numbers) for label, numbers in rows.items()}
    return dots(values, metric.label, title, targets)


def _number(result: Result, metric: Drawn) -> float:
    """NaN for a run that failed."""
    if result.failure is not None:
        return float("nan")
    return next((one.value for one in result.metrics if one.name == metric.name), float("nan"))


def _padded(runs: Sequence[float], size: int) -> list[float]:
    return [*runs, *[float("nan")] * (size - len(runs))]
