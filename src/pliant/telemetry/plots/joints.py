"""Joint space: torques, and the difference between the reference posture and the actual one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pliant.spatial import Array
from pliant.telemetry.plots import style
from pliant.telemetry.plots.series import Curve, Panel, mark_phases, thin, time_series

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DEGREES = 180.0 / np.pi


def posture_difference(
    time: Array, actual: Array, reference: Array, names: Sequence[str] = (), title: str = ""
) -> Figure:
    """How far each joint is from its reference posture.

    Args:
        time: (n,) s.
        actual: (n, k) rad.
        reference: (n, k) rad.
        names: (k,) of the joints.
        title: above it.
    """
    difference = (np.asarray(reference) - np.asarray(actual)) * _DEGREES
    labels = _labels(names, difference.shape[1])
    curves = [Curve(label, time, difference[:, joint]) for joint, label in enumerate(labels)]
    return time_series([Panel("posture: reference − actual, °", curves, least_height=0.2)], title)


def joint_torques(
    time: Array,
    torque: Array,
    limits: Array | None = None,
    names: Sequence[str] = (),
    title: str = "",
    phases: Sequence[tuple[float, str]] = (),
) -> Figure:
    """Torque of each joint in a panel of its own, on a scale of its own.

    Args:
        time: (n,) s.
        torque: (n, k) N·m.
        limits: (k,) N·m; drawn where the torque comes near them, and named in every panel.
        names: (k,) of the joints.
        title: above it.
        phases: begin (s) and name of phases.
    """
    torque = np.asarray(torque)
    labels = _labels(names, torque.shape[1])
    columns = 2 if len(labels) > 3 else 1
    rows = -(-len(labels) // columns)
    made = style.figure(3.7 * columns, 0.8 + 1.25 * rows, title)
    grid = made.subplots(rows, columns, sharex=True, squeeze=False)
    for joint, ax in enumerate(grid.flat):
        if joint >= len(labels):
            ax.set_visible(False)
            continue
        last = joint + columns >= len(labels)
        style.dress(ax, "", "torque, N·m" if joint % columns == 0 else "", labels[joint])
        ax.plot(*thin(time, torque[:, joint]), color=style.colour(0), linewidth=1.1)
        ax.margins(x=0.0)
        ax.tick_params(labelbottom=last)
        style.pad_range(ax, 1.0)
        if limits is not None:
            _draw_limit(ax, float(limits[joint]))
        mark_phases(ax, phases, named=joint < columns)
    made.supxlabel("time, s", fontsize=style.NORMAL, color=style.INK)
    return made


def _draw_limit(ax: Axes, limit: float) -> None:
    low, high = ax.get_ylim()
    for bound in (-limit, limit):
        if low - 0.2 * (high - low) <= bound <= high + 0.2 * (high - low):
            ax.axhline(bound, color=style.ALARM, linewidth=1.0, linestyle=":")
    ax.set_title(f"limit ±{limit:g}", loc="right", fontsize=style.SMALL, color=style.MUTED)


def _labels(names: Sequence[str], size: int) -> list[str]:
    return list(names) if len(names) == size else [f"joint {joint + 1}" for joint in range(size)]
