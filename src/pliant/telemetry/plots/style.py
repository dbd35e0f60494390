"""The look that all figures share: colours that colour-blind readers can tell apart, few lines, units on every axis."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.errors import OutputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK = "#20262e"
MUTED = "#6b7480"
GRID = "#e7eaee"
REFERENCE = "#9aa3ae"
"""colour of references"""
ALARM = "#c22f2f"
PALETTE = ("#0b6fb8", "#d95f0e", "#148f6b", "#b2489a", "#e0a100", "#3fb0e0", "#6b4fb3", "#7a6a53")
"""the order is such that neighbours differ in lightness as well as in hue"""

SMALL, NORMAL, LARGE = 8.0, 9.0, 11.0  # points
LINE = 1.4  # points
_DPI = 160


def figure(width: float, height: float, title: str = "") -> Figure:
    """An empty figure. Args: width, height in inches; title above everything, aligned left."""
    # imported here, so that commands without figures do not load matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    made = Figure(figsize=(width, height), dpi=_DPI, layout="constrained", facecolor="white")
    FigureCanvasAgg(made)
    if title:
        made.suptitle(title, x=0.01, ha="left", fontsize=LARGE, fontweight="bold", color=INK)
    return made


def dress(ax: Axes, xlabel: str = "", ylabel: str = "", title: str = "") -> None:
    """Gives axes the common look and their labels."""
    ax.set_facecolor("white")
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        ax.spines[side].set_color(MUTED)
        ax.spines[side].set_linewidth(0.7)
    ax.tick_params(colors=MUTED, labelcolor=INK, labelsize=SMALL, width=0.7, length=3)
    ax.grid(True, color=GRID, linewidth=0.8)
    ax.set_axisbelow(True)
    ax.set_xlabel(xlabel, fontsize=NORMAL, color=INK)
    ax.set_ylabel(ylabel, fontsize=NORMAL, color=INK)
    if title:
        ax.set_title(title, loc="left", fontsize=NORMAL, fontweight="bold", color=INK)


def legend(ax: Axes, outside: bool = False, columns: int = 1, least: int = 2) -> None:
    """A frameless legend, inside where there is room or right of the axes; none for fewer than `least` entries."""
    handles, labels = ax.get_legend_handles_labels()
    if len(labels) < least:
        return
    look: dict[str, Any] = {"frameon": not outside, "fontsize": SMALL, "ncols": columns, "handlelength": 1.6}
    if outside:
        look |= {"loc": "upper left", "bbox_to_anchor": (1.01, 1.02)}
    made = ax.legend(handles, labels, **look)
    made.get_frame().set(facecolor="white", edgecolor="none", alpha=0.85)
    for text in made.get_texts():
        text.set_color(INK)


def colour(index: int) -> str:
    """Colour of the index-th curve."""
    return PALETTE[index % len(PALETTE)]


def dash(index: int) -> str | tuple[int, Sequence[float]]:
    """Line style of the index-th curve: changes when the colours repeat."""
    return ("-", (0, (4, 1.5)), (0, (1, 1)))[(index // len(PALETTE)) % 3]


def pad_range(ax: Axes, least: float) -> None:
    """Widens the y axis to a least height, so that noise around a constant does not fill the panel. Args: least, in
    data units."""
    low, high = ax.get_ylim()
    if high - low < least:
        middle = 0.5 * (low + high)
        ax.set_ylim(middle - 0.5 * least, middle + 0.5 * least)


def save(made: Figure, path: Path) -> Path:
    """Writes a figure as PNG. The same figure gives the same bytes.

    Returns:
        The file.

    Raises:
        OutputError: it cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    canvas = FigureCanvasAgg(made)
    canvas.draw()  # once; `savefig` draws twice
    picture = np.ascontiguousarray(np.asarray(canvas.buffer_rgba())[:, :, :3])  # figures are opaque
    try:
        Image.fromarray(picture).save(path, format="PNG", compress_level=1, dpi=(made.dpi, made.dpi))
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror or error}") from error
    return path
