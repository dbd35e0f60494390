"""A search over parameters: how it went, and where it looked."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING

import numpy as np

from pliant.spatial import Array
from pliant.telemetry.plots import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLUMNS = 3


def trials(
    objective: Array, parameters: Mapping[str, Array], log: Collection[str] = (), title: str = "Search"
) -> Figure:
    """The objective over the trials, and one panel per parameter. The first trial is the start.

    Args:
        objective: (n,), lower is better; NaN for a trial whose runs failed, drawn as a cross at the upper edge.
        parameters: name → (n,) values that were tried.
        log: names of parameters with a logarithmic axis.
        title: above it.
    """
    rows = -(-len(parameters) // _COLUMNS)
    made = style.figure(7.2, 2.6 + 2.1 * rows, title)
    grid = made.add_gridspec(1 + rows, _COLUMNS)
    number = np.arange(len(objective), dtype=np.float64)
    over = made.add_subplot(grid[0, :])
    style.dress(over, "trial", "objective")
    _dots(over, number, objective)
    best = np.fmin.accumulate(objective)
    over.step(number, best, where="post", color=style.colour(0), linewidth=style.LINE, label="best so far")
    style.legend(over)
    for index, (name, values) in enumerate(parameters.items()):
        ax = made.add_subplot(grid[1 + index // _COLUMNS, index % _COLUMNS])
        style.dress(ax, name, "objective" if index % _COLUMNS == 0 else "")
        if name in log:
            ax.set_xscale("log")
        _dots(ax, values, objective)
    return made


def _dots(ax: Axes, x: Array, objective: Array) -> None:
    finite = np.isfinite(objective)
    if finite.any() and (objective[finite] > 0.0).all():
        ax.set_yscale("log")
    ax.plot(x[finite], objective[finite], "o", color=style.MUTED, markersize=3.0, alpha=0.6, label="trial")
    failed = x[~finite]
    ax.plot(
        failed, np.full(failed.shape, 0.97), "x", color=style.ALARM, markersize=4, transform=ax.get_xaxis_transform()
    )
    for label, index, colour in (("start", 0, style.colour(1)), ("best", _best(objective), style.colour(0))):
        if finite[index]:
            ax.plot(x[index], objective[index], "o", color=colour, markersize=6, label=label)


def _best(objective: Array) -> int:
    return int(np.argmin(np.where(np.isfinite(objective), objective, np.inf)))
