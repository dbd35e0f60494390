"""Runs of many variants, one row each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from pliant.spatial import Array
from pliant.telemetry.plots import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def dots(rows: Mapping[str, Array], xlabel: str, title: str = "", targets: Mapping[str, float] | None = None) -> Figure:
    """A dot per run, a bar at their mean, the number of failed runs at the right edge.

    Args:
        rows: label → (runs,) values above zero; NaN for a run that failed.
        xlabel: quantity and unit; the axis is logarithmic.
        title: above it.
        targets: label → upper bound, drawn into its row.
    """
    from matplotlib.ticker import LogFormatter

    made = style.figure(7.4, 0.9 + 0.24 * len(rows) + (0.3 if title else 0.0), title)
    ax = made.add_subplot()
    style.dress(ax, xlabel)
    ax.set_xscale("log")
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter(LogFormatter(labelOnlyBase=False, minor_thresholds=(1.5, 0.5)))
    ax.tick_params(axis="x", which="both", labelsize=style.SMALL)
    for place, (label, values) in enumerate(rows.items()):
        finite = values[np.isfinite(values)]
        ax.plot(finite, np.full(len(finite), place), "o", color=style.colour(0), markersize=3.4, alpha=0.55)
        if len(finite):
            ax.plot([finite.mean()] * 2, [place - 0.32, place + 0.32], color=style.INK, linewidth=1.6)
        bound = (targets or {}).get(label)
        if bound is not None:
            ax.plot([bound] * 2, [place - 0.4, place + 0.4], color=style.ALARM, linewidth=1.6)
        if len(finite) < len(values):
            lost = f"{len(values) - len(finite)} of {len(values)} failed"
            ax.annotate(
                lost,
                (1.0, place),
                (4, 0),
                xycoords=("axes fraction", "data"),
                textcoords="offset points",
                va="center",
                fontsize=style.SMALL,
                color=style.ALARM,
            )
    ax.plot([], [], "o", color=style.colour(0), markersize=3.4, label="run")
    ax.plot([], [], "-", color=style.INK, linewidth=1.6, label="mean")
    if targets:
        ax.plot([], [], "-", color=style.ALARM, linewidth=1.6, label="target")
    ax.set_yticks(range(len(rows)), list(rows))
    ax.set_ylim(len(rows) - 0.5, -0.5)
    style.legend(ax)
    return made
