"""Numbers side by side: cases or controllers against the paper's, and a metric against a parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from pliant.spatial import Array
from pliant.telemetry.plots import style
from pliant.telemetry.summary import Metric


def compare(groups: Mapping[str, Sequence[Metric]], ylabel: str, title: str = "", log_scale: bool = False) -> Figure:
    """Bars per group, with the paper's numbers as diamonds and the targets as short lines.

    Args:
        groups: label of a group (a case, say) → metrics of one unit; metrics of one name have one colour. A value that
            is not finite is written as a cross at the foot of its place.
        ylabel: quantity and unit.
        title: above it.
        log_scale: of the y axis.
    """
    names = list(dict.fromkeys(metric.name for metrics in groups.values() for metric in metrics))
    width = 0.8 / max(1, len(names))
    made = style.figure(max(4.2, 1.4 + 0.32 * len(names) * len(groups) + 0.5 * len(groups)), 3.6, title)
    ax = made.add_subplot()
    style.dress(ax, "", ylabel)
    ax.grid(False, axis="x")
    if log_scale:
        ax.set_yscale("log")
    for place, metrics in enumerate(groups.values()):
        for metric in metrics:
            index = names.index(metric.name)
            _bar(ax, place + (index - 0.5 * (len(names) - 1)) * width, 0.86 * width, metric, style.colour(index))
    for index, name in enumerate(names):
        ax.bar(0, 0, color=style.colour(index), label=name)
    ax.plot([], [], "D", color=style.INK, markersize=4, markerfacecolor="white", label="paper")
    ax.plot([], [], "-", color=style.ALARM, linewidth=1.6, label="target")
    ax.set_xticks(range(len(groups)), list(groups))
    ax.tick_params(axis="x", length=0)
    style.legend(ax, outside=True)
    return made


def _bar(ax: style.Axes, at: float, width: float, metric: Metric, colour: str) -> None:
    if np.isfinite(metric.value):
        ax.bar(at, metric.value, width, color=colour, alpha=0.9)
        if metric.std is not None and np.isfinite(metric.std):
            ax.errorbar(at, metric.value, metric.std, color=style.INK, linewidth=0.9, capsize=2)
    else:
        ax.plot(at, 0.02, "x", color=style.ALARM, markersize=7, transform=ax.get_xaxis_transform())
    if metric.paper is not None:
        ax.plot(at, metric.paper, "D", color=style.INK, markersize=4, markerfacecolor="white")
    if metric.target is not None:
        ax.plot([at - 0.55 * width, at + 0.55 * width], [metric.target] * 2, color=style.ALARM, linewidth=1.6)


def sweep(
    parameter: Array,
    curves: Mapping[str, Array],
    xlabel: str,
    ylabel: str,
    title: str = "",
    target: float | None = None,
    log_x: bool = False,
) -> Figure:
    """A metric against a parameter, with every run as a dot.

    Args:
        parameter: (m,).
        curves: name → (m,) one run each, or (m, runs); the line is the mean of the runs that gave a number. Runs that
            did not are crosses at the upper edge.
        xlabel: quantity and unit.
        ylabel: quantity and unit.
        title: above it.
        target: a bound, drawn as a line.
        log_x: scale of the x axis.
    """
    made = style.figure(5.6, 3.5, title)
    ax = made.add_subplot()
    style.dress(ax, xlabel, ylabel)
    if log_x:
        ax.set_xscale("log")
    for index, (name, values) in enumerate(curves.items()):
        runs = np.asarray(values, dtype=np.float64).reshape(len(parameter), -1)
        finite = np.isfinite(runs)
        counts = finite.sum(axis=1)
        mean = np.where(counts > 0, np.where(finite, runs, 0.0).sum(axis=1) / np.maximum(counts, 1), np.nan)
        colour = style.colour(index)
        ax.plot(parameter, mean, "-", color=colour, linewidth=style.LINE, label=name)
        where = np.broadcast_to(np.asarray(parameter, dtype=np.float64)[:, None], runs.shape)
        ax.plot(where[finite], runs[finite], "o", color=colour, markersize=3.2, alpha=0.6)
        lost = where[~finite]
        ax.plot(lost, np.full(lost.shape, 0.97), "x", color=colour, markersize=6, transform=ax.get_xaxis_transform())
    if target is not None:
        ax.axhline(target, color=style.ALARM, linewidth=1.0, linestyle=":", label="target")
    style.legend(ax)
    return made
