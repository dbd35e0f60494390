"""Numbers side by side: cases or controllers, with the paper's numbers and the targets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from pliant.telemetry.plots import style
from pliant.telemetry.summary import Metric

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


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


def _bar(ax: Axes, at: float, width: float, metric: Metric, colour: str) -> None:
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
