"""The energy ledger: what is stored, what came in, what went out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from pliant.spatial import Array
from pliant.telemetry.plots import style
from pliant.telemetry.plots.series import Curve, Panel, time_series

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def energy_ledger(
    time: Array,
    entries: Mapping[str, Array],
    margin: Array | None = None,
    title: str = "",
    phases: Sequence[tuple[float, str]] = (),
) -> Figure:
    """Energies over time.

    Args:
        time: (n,) s.
        entries: name → (n,) J, such as stored, supplied by the reference, dissipated, taken by the torque limits.
        margin: (n,) J, supplied minus gained: below zero the port has made energy; drawn below, with that side shaded.
        title: above it.
        phases: begin (s) and name of phases.
    """
    panels = [Panel("energy, J", [Curve(name, time, value) for name, value in entries.items()], least_height=0.01)]
    if margin is not None:
        panels.append(Panel("storage margin, J", [Curve("supplied − gained", time, margin)], least_height=0.01))
    made = time_series(panels, title, phases)
    if margin is not None:
        ax = made.axes[1]
        low, _ = ax.get_ylim()
        bottom = min(low, float(np.nanmin(margin, initial=0.0)), -0.1 * abs(low) - 1e-6)
        ax.axhspan(bottom, 0.0, color=style.ALARM, alpha=0.08, linewidth=0)
        ax.axhline(0.0, color=style.ALARM, linewidth=0.9)
        ax.set_ylim(bottom=bottom)
    return made
