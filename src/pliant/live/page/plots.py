"""The curves on the page: the last seconds of forces, errors, energies, torques and computation times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser

from pliant.live.page.curves import AXES
from pliant.live.page.narrow_windows import NarrowWindows
from pliant.spatial import Array

WINDOW = 10.0  # s
_CAPACITY = 1200  # samples kept
_INK, _GRID_COLOUR = "#4a525c", "#e7eaee"
_PALETTE = ("#0b6fb8", "#d95f0e", "#148f6b", "#b2489a", "#e0a100", "#3fb0e0", "#6b4fb3", "#7a6a53")
_FORCES = {"contact": "#c22f2f", "commanded": "#0b6fb8", "desired": "#8a929c", "push": "#b2489a"}
_PANEL_WIDTH = 350  # px
_HEIGHT = 150  # px of a plot


@dataclass(slots=True)
class Plot:
    """One plot, and the columns that it shows."""

    handle: viser.GuiUplotHandle
    columns: tuple[str, ...]
    known: tuple[bool, ...]
    """of each curve: whether it is shown, since each of its values is a number"""


class Plots:
    """A panel of curves, docked at the left.

    Args:
        server: the page.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        self._gui = server.gui
        self._panel = server.gui.add_panel()
        self._panel.dock_left()
        self._panel.set_width(_PANEL_WIDTH)
        NarrowWindows(server, self._panel)
        self._contact = self._panel.add_tab("Contact", viser.Icon.CHART_LINE)
        self._effort = self._panel.add_tab("Effort", viser.Icon.GAUGE)
        with self._contact:
            self._axis = self._gui.add_dropdown(
                "force shown", ("magnitude", *AXES), hint="Which part of the forces the first plot shows."
            )
        self._axis.on_update(lambda _: self.draw())
        self._plots: list[Plot] = []
        self._names: tuple[str, ...] = ()
        self._rows: Array = np.empty((0, 0))
        self._run = 0

    @property
    def names(self) -> tuple[str, ...]:
        """Columns of the samples."""
        return self._names

    @property
    def rows(self) -> Array:
        """(k, columns) samples that are kept."""
        return self._rows

    def begin(self, columns: tuple[str, ...], period: float) -> None:
        """Empties the curves, for samples with these columns. Args: period: s, the deadline of a control step."""
        self._rows = np.empty((0, len(columns)))
        if columns == self._names:
            return
        for plot in self._plots:
            plot.handle.remove()
        self._names = columns
        energies = [name for name in columns if name.startswith("energy.")]
        torques = [name for name in columns if name.startswith("torque.")]
        with self._contact:
            forces = tuple(name for name in _FORCES if f"{name}.x" in columns)
            self._plots = [self._add("force, N", forces, [_FORCES[name] for name in forces])]
            self._plots.append(self._add("position error, mm", tuple(f"error.{axis}" for axis in AXES)))
            if energies:
                self._plots.append(self._add("energy, J", tuple(energies)))
        with self._effort:
            self._plots.append(self._add("torque, N·m", tuple(torques)))
            if "control" in columns:
                title = f"control step, ms (deadline {1e3 * period:g} ms)"
                self._plots.append(self._add(title, ("control",)))

    def extend(self, run: int, rows: Array) -> None:
        """Adds samples; a new run clears the old ones."""
        if rows.shape[1] != len(self._names):
            return
        if run != self._run or (len(self._rows) and rows[0, 0] < self._rows[-1, 0]):
            self._run, self._rows = run, rows[:0]
        self._rows = np.vstack([self._rows, rows])[-_CAPACITY:]

    def show(self, rows: Array) -> None:
        """Shows these samples and no others."""
        self._rows = rows
        self.draw()

    def draw(self) -> None:
        """Sends the last seconds to the browsers."""
        if len(self._rows) < 2:
            return
        recent = self._rows[self._rows[:, 0] >= self._rows[-1, 0] - WINDOW]
        time = np.round(recent[:, 0], 3)
        for plot in self._plots:
            curves = [np.round(self._curve(recent, name), 4) for name in plot.columns]
            known = tuple(bool(np.isfinite(curve).all()) for curve in curves)
            if known != plot.known:
                plot.known = known
                plot.handle.series = (plot.handle.series[0], *map(_seen, plot.handle.series[1:], known))
            plot.handle.data = (time, *map(np.nan_to_num, curves))

    def latest(self, name: str) -> float:
        """The last value of a column, or of the magnitude of a vector; NaN before there is one."""
        return float(self._curve(self._rows[-1:], name, "magnitude")[0]) if len(self._rows) else float("nan")

    def _curve(self, rows: Array, name: str, axis: str | None = None) -> Array:
        if name in self._names:
            found: Array = rows[:, self._names.index(name)]
            return found
        shown = axis or self._axis.value
        parts = [rows[:, self._names.index(f"{name}.{a}")] for a in (AXES if shown == "magnitude" else (shown,))]
        return np.sqrt(np.sum(np.square(parts), axis=0)) if shown == "magnitude" else parts[0]

    def _add(self, title: str, columns: tuple[str, ...], colours: Sequence[str] = _PALETTE) -> Plot:
        time = np.array([0.0, 1.0])
        nothing = np.full(2, np.nan)
        series: list[Any] = [{"label": "t"}]
        for index, name in enumerate(columns):
            look: dict[str, Any] = {"label": name.split(".")[-1], "stroke": colours[index % len(colours)], "width": 1.6}
            if name == "desired":
                look["dash"] = (5.0, 4.0)
            series.append(look | {"points": {"show": False}})
        handle = self._gui.add_uplot(
            (time, *(nothing for _ in columns)),
            tuple(series),
            title=title,
            scales={"x": {"time": False}},
            axes=(_axis("time, s", 46), _axis("", 46)),
            legend={"show": True, "live": True},
            cursor={"drag": {"x": True, "y": False}},
            height=_HEIGHT,
            padding=(6, 10, 0, 0),
        )
        return Plot(handle, columns, tuple(True for _ in columns))


def _seen(series: Any, known: bool) -> Any:
    """The look of a curve. Args: known: whether each of its values is a number; browsers draw no gaps."""
    return {**series, "show": known}


def _axis(label: str, size: int) -> Any:
    axis: dict[str, Any] = {
        "stroke": _INK,
        "grid": {"stroke": _GRID_COLOUR, "width": 1.0},
        "ticks": {"stroke": _GRID_COLOUR, "width": 1.0, "size": 4.0},
        "font": "11px system-ui, sans-serif",
        "size": size if not label else 24,
    }
    if not label:
        axis["space"] = 18.0  # px between ticks, because the plots are low
    if label:
        axis |= {"label": label, "labelSize": 16.0, "labelFont": "11px system-ui, sans-serif", "labelGap": 0.0}
    return axis
