"""A metric against a parameter."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from pliant.spatial import Array
from pliant.telemetry.plots import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
