"""The picture of a reach check."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pliant.references.reach import ReachCheck
from pliant.telemetry.plots import Curve, Panel, time_series

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def reach_figure(check: ReachCheck, title: str = "") -> Figure:
    """Every margin along the course, on the believed surface and, thin, on the others, with its bound.

    Where no joint path was found there is nothing to draw; the title says what failed.
    """
    first = check.surfaces[0]
    times = check.course.times
    panels: list[Panel] = []
    for index, margin in enumerate(first.margins):
        others = [found.margins[index].values for found in check.surfaces[1:] if found.margins]
        curves = [Curve("believed", times, margin.values)]
        labels = ["drawn", *["_drawn"] * len(others)]  # legends of matplotlib pass over a leading underscore
        curves += [Curve(label, times, values, "faint") for label, values in zip(labels, others, strict=False)]
        curves.append(Curve("bound", times, np.full(len(times), margin.bound), "limit"))
        panels.append(Panel(f"{margin.name}, {margin.unit}", curves))
    failed = next((found for found in check.surfaces if not found.reachable), None)
    said = title if failed is None else f"{title}\n{failed.label}: {failed.failure}".strip()
    if not panels:
        panels = [Panel("reach", [Curve("not reached", np.array([0.0, times[-1]]), np.zeros(2))])]
    return time_series(panels, said)
