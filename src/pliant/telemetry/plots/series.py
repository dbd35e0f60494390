"""Quantities over time, one panel above the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pliant.spatial import Array
from pliant.telemetry.plots import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MOST_POINTS = 4000  # more than the pixels of a panel's width; beyond, minimum and maximum of each stretch are drawn
_CROWDED = 0.08  # share of the width within which two names would touch


@dataclass(frozen=True, slots=True)
class Curve:
    """One line of a panel."""

    label: str
    time: Array
    """(n,) s"""
    value: Array
    """(n,) in the panel's unit"""
    kind: str = "actual"
    """'actual', 'reference' (grey, behind the others, stepwise), 'limit' (dotted) or 'faint' (thin, behind the actual
    ones)"""


@dataclass(frozen=True, slots=True)
class Panel:
    """One set of axes."""

    ylabel: str
    """quantity and unit: `force, N`"""
    curves: Sequence[Curve]
    title: str = ""
    band: tuple[float, float] | None = None
    """range to be shaded: a target, in the panel's unit"""
    least_height: float = 0.0
    """the y axis spans at least this much"""


def time_series(
    panels: Sequence[Panel], title: str = "", phases: Sequence[tuple[float, str]] = (), width: float = 7.2
) -> Figure:
    """Panels over one time axis.

    Args:
        panels: from top to bottom.
        title: above them.
        phases: begin (s) and name of phases, marked by thin lines.
        width: inches.
    """
    made = style.figure(width, 0.7 + 1.75 * len(panels) + (0.3 if title else 0.0), title)
    grid = made.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for row, (ax, panel) in enumerate(zip(grid, panels, strict=True)):
        style.dress(ax, "time, s" if row == len(panels) - 1 else "", panel.ylabel, panel.title)
        draw(ax, panel)
        mark_phases(ax, phases, named=row == 0)
        style.legend(ax, outside=True)
    made.align_ylabels()
    return made


def draw(ax: Axes, panel: Panel) -> None:
    """Draws the curves of a panel into axes."""
    if panel.band is not None:
        ax.axhspan(*panel.band, color=style.PALETTE[2], alpha=0.12, linewidth=0)
    index = 0
    for curve in panel.curves:
        time, value = thin(curve.time, curve.value)
        if curve.kind == "reference":
            ax.plot(
                time, value, color=style.REFERENCE, linewidth=2.6, solid_capstyle="butt", label=curve.label, zorder=1.5
            )
        elif curve.kind == "limit":
            ax.plot(time, value, color=style.ALARM, linewidth=1.0, linestyle=":", label=curve.label)
        else:
            ax.plot(
                time,
                value,
                color=style.colour(index),
                linestyle=style.dash(index),
                linewidth=0.8 if curve.kind == "faint" else style.LINE,
                alpha=0.6 if curve.kind == "faint" else 1.0,
                zorder=1.8 if curve.kind == "faint" else 2.0,
                label=curve.label,
            )
            index += 1
    ax.margins(x=0.0)
    style.pad_range(ax, panel.least_height)


def mark_phases(ax: Axes, phases: Sequence[tuple[float, str]], named: bool) -> None:
    """Thin lines where phases begin, with their names above the axes; the name of one that begins soon after another
    stands higher."""
    low, high = ax.get_xlim()
    before, level = -np.inf, 0
    for time, name in phases:
        if not name or not low <= time <= high:
            continue
        ax.axvline(time, color=style.MUTED, linewidth=0.7, linestyle=(0, (3, 3)))
        level = 1 - level if time - before < _CROWDED * (high - low) else 0
        before = time
        if named:
            under_title = bool(ax.get_title(loc="left"))
            ax.annotate(
                name,
                (time, 1.0),
                (3, (-2 if under_title else 2) + level * (style.SMALL + 1.0)),
                xycoords=("data", "axes fraction"),
                textcoords="offset points",
                va="top" if under_title else "bottom",
                fontsize=style.SMALL,
                color=style.MUTED,
            )


def thin(time: Array, value: Array) -> tuple[Array, Array]:
    """Fewer points that look the same: minimum and maximum of each stretch, so that no spike is lost.

    Args:
        time: (n,).
        value: (n,).

    Returns:
        Both with at most 4000 points, in order of time.
    """
    n = time.shape[0]
    if n <= _MOST_POINTS:
        return time, value
    stretch = -(-n // (_MOST_POINTS // 2))
    whole = n // stretch * stretch
    blocks = value[:whole].reshape(-1, stretch)
    start = np.arange(0, whole, stretch)
    first = np.where(np.isnan(blocks).all(axis=1), 0, np.argmin(np.where(np.isnan(blocks), np.inf, blocks), axis=1))
    last = np.argmax(np.where(np.isnan(blocks), -np.inf, blocks), axis=1)
    keep = np.unique(np.concatenate((start + first, start + last, np.arange(whole, n))))
    return time[keep], value[keep]
