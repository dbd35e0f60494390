"""A force attractor: its profile, its energy, and what it does to a mass (Fig. 3 of [Stack] Tiseo et al. 2020)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from pliant.spatial import Array
from pliant.telemetry.plots import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def attractor(
    error: Array,
    forces: Mapping[str, Array],
    energies: Mapping[str, Array],
    portraits: Mapping[str, Sequence[tuple[Array, Array]]],
    title: str = "",
    unit: str = "m",
) -> Figure:
    """Three panels: force over error, energy over error, velocity over error.

    Args:
        error: x̃ (m,) in the unit below.
        forces: name → (m,) N at these errors; a law of the convergence phase goes beside that of divergence.
        energies: name → (m,) J.
        portraits: name → trajectories, each error (n,) and its rate (n,); drawn with their starts and directions.
        title: above it.
        unit: 'm' or 'rad'.
    """
    made = style.figure(10.4, 3.5, title)
    left, middle, right = made.subplots(1, 3)
    force, energy = ("force, N", "energy, J") if unit == "m" else ("moment, N·m", "energy, J")
    for ax, ylabel, curves in ((left, force, forces), (middle, energy, energies)):
        style.dress(ax, f"error x̃, {unit}", ylabel)
        for index, (name, values) in enumerate(curves.items()):
            ax.plot(error, values, color=style.colour(index), linewidth=style.LINE + 0.3, label=name)
        _cross(ax)
        style.legend(ax)
    style.dress(right, f"error x̃, {unit}", f"rate of the error, {unit}/s")
    for index, (name, trajectories) in enumerate(portraits.items()):
        for number, (position, rate) in enumerate(trajectories):
            _trajectory(right, position, rate, style.colour(index), name if number == 0 else "")
    _cross(right)
    style.legend(right)
    return made


def phase_portrait(trajectories: Sequence[tuple[Array, Array]], title: str = "", unit: str = "m") -> Figure:
    """The portrait alone. Args: trajectories as in `attractor`; title above it; unit 'm' or 'rad'."""
    made = style.figure(4.6, 3.8, title)
    ax = made.add_subplot()
    style.dress(ax, f"error x̃, {unit}", f"rate of the error, {unit}/s")
    for index, (position, rate) in enumerate(trajectories):
        _trajectory(ax, position, rate, style.colour(index), "")
    _cross(ax)
    return made


def _trajectory(ax: Axes, position: Array, rate: Array, colour: str, label: str) -> None:
    ax.plot(position, rate, color=colour, linewidth=1.1, label=label or None)
    ax.plot(position[0], rate[0], "o", color=colour, markersize=3.5)
    at = _arrow_at(position, rate)
    if at is not None:
        ax.annotate(
            "",
            (position[at + 1], rate[at + 1]),
            (position[at], rate[at]),
            arrowprops={"arrowstyle": "-|>", "color": colour, "mutation_scale": 9, "linewidth": 0},
        )


def _arrow_at(position: Array, rate: Array) -> int | None:
    """Sample at which the first tenth of the way is done, where the direction is easy to see."""
    scale = np.array([np.ptp(position), np.ptp(rate)])
    if position.shape[0] < 3 or not np.all(np.isfinite(scale)) or not np.all(scale > 0.0):
        return None
    steps = np.hypot(np.diff(position) / scale[0], np.diff(rate) / scale[1])
    return min(int(np.searchsorted(np.cumsum(steps), 0.1 * float(np.sum(steps)))), position.shape[0] - 2)


def _cross(ax: Axes) -> None:
    ax.axhline(0.0, color=style.MUTED, linewidth=0.6)
    ax.axvline(0.0, color=style.MUTED, linewidth=0.6)
