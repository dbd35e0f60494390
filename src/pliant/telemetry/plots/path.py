"""Path of a frame in a plane of the task space: reference and actual."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pliant.errors import ShapeError
from pliant.spatial import Array
from pliant.telemetry.plots import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MM = 1e3  # mm per m
_PAPER = "#d9dde2"  # background on which white is visible
_ERRORS = ("#0b6fb8", "#3fb0e0", "#e0a100", "#c22f2f")


@dataclass(frozen=True, slots=True)
class Path2D:
    """One path."""

    label: str
    position: Array
    """(n, 3) m"""


def task_path(
    paths: Sequence[Path2D],
    reference: Array,
    axes: tuple[int, int] = (0, 2),
    title: str = "",
    wall: float | None = None,
    by_error: bool = False,
) -> Figure:
    """Paths in a plane, to scale, with their reference.

    Args:
        paths: of one or more runs.
        reference: (n, 3) m.
        axes: the two world axes of the plane, horizontal first.
        title: above it.
        wall: position of a wall along the horizontal axis, m; the side behind it is shaded.
        by_error: colour each point by its distance from the reference at the same instant; for a single path.

    Raises:
        ShapeError: `by_error` with several paths, or with one of another length than the reference.
    """
    if by_error and (len(paths) != 1 or paths[0].position.shape != reference.shape):
        raise ShapeError("a path can be coloured by its error if it is the only one and as long as its reference")
    h, v = axes
    made = style.figure(*_size([reference[:, axes], *(path.position[:, axes] for path in paths)]), title)
    ax = made.add_subplot()
    style.dress(ax, f"{'xyz'[h]}, m", f"{'xyz'[v]}, m")
    ax.plot(reference[:, h], reference[:, v], color=style.REFERENCE, linewidth=4.0, alpha=0.55, label="reference")
    if by_error:
        _draw_by_error(made, ax, paths[0], reference, axes)
    else:
        for index, path in enumerate(paths):
            ax.plot(
                path.position[:, h],
                path.position[:, v],
                color=style.colour(index),
                linestyle=style.dash(index),
                linewidth=style.LINE,
                label=path.label,
            )
    start = paths[0].position[0]
    ax.plot(start[h], start[v], "o", color=style.INK, markersize=4.5, label="start", zorder=5)
    ax.set_aspect("equal", adjustable="datalim")
    if wall is not None:
        _draw_wall(ax, wall)
    ax.locator_params(nbins=6)
    style.legend(ax, outside=not by_error)
    return made


def _size(points: Sequence[Array]) -> tuple[float, float]:
    """Inches that suit the proportions of the paths."""
    stacked = np.concatenate([p[np.isfinite(p).all(axis=1)] for p in points])
    if not stacked.size:
        return 6.4, 5.0
    width, height = np.ptp(stacked, axis=0)
    ratio = float(np.clip((height + 1e-3) / (width + 1e-3), 0.45, 2.0))
    if ratio > 1.0:
        return 5.2 / ratio + 2.2, 6.0
    return 6.8, 4.6 * ratio + 1.1


def _draw_by_error(made: Figure, ax: Axes, path: Path2D, reference: Array, axes: tuple[int, int]) -> None:
    from matplotlib.collections import LineCollection
    from matplotlib.colors import LinearSegmentedColormap

    colours = LinearSegmentedColormap.from_list("error", _ERRORS)
    error = np.linalg.norm(path.position - reference, axis=1) * _MM
    points = path.position[:, axes]
    segments = np.stack((points[:-1], points[1:]), axis=1)
    lines = LineCollection(list(segments), cmap=colours, linewidths=1.8, capstyle="round")
    lines.set_array(error[1:])
    lines.set_clim(0.0, float(np.nanmax(error)) or 1.0)
    ax.add_collection(lines)
    bar = made.colorbar(lines, ax=ax, pad=0.02, aspect=30)
    bar.set_label("distance to reference, mm", fontsize=style.NORMAL, color=style.INK)
    bar.ax.tick_params(labelsize=style.SMALL, colors=style.MUTED, labelcolor=style.INK)
    bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue]


def _draw_wall(ax: Axes, wall: float) -> None:
    low, high = ax.get_xlim()
    ax.axvspan(wall, max(high, wall + 0.05 * (high - low)), color=style.MUTED, alpha=0.15, linewidth=0, label="wall")
    ax.axvline(wall, color=style.MUTED, linewidth=1.2)


def coloured_path(place: Array, value: Array, label: str, title: str = "") -> Figure:
    """A path on a flat surface, to scale, with a signed value as colour: white is zero.

    Args:
        place: (k, 2) m; the axes begin at its first row.
        value: (k,).
        label: of the value, with its unit.
        title: above it.
    """
    made = style.figure(*_size([place]), title)
    ax = made.add_subplot()
    style.dress(ax, "along, mm", "across, mm")
    ax.set_facecolor(_PAPER)
    most = float(np.nanpercentile(np.abs(value), 99.0)) or 1.0  # one peak must not make all other values pale
    dots = ax.scatter(_MM * place[:, 0], _MM * place[:, 1], c=value, s=9.0, cmap="RdBu_r", vmin=-most, vmax=most)
    ax.plot(*(_MM * place[0]), marker="o", markersize=7.0, markerfacecolor="none", color=style.INK, linestyle="none")
    ax.annotate("start", _MM * place[0], (6.0, 6.0), textcoords="offset points", fontsize=style.SMALL, color=style.INK)
    ax.set_aspect("equal", adjustable="datalim")
    bar = made.colorbar(dots, ax=ax, extend="both", fraction=0.05)
    bar.set_label(label, fontsize=style.NORMAL, color=style.INK)
    bar.ax.tick_params(labelsize=style.SMALL)
    return made
