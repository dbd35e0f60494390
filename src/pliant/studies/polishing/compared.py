"""Controllers drawn over each other, as [FFMPC] Figs. 4 and 6 to 9 show its robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.experiments.case import Case
from pliant.experiments.result import Result
from pliant.studies.figures import CaseFigure, short
from pliant.studies.polishing.paper_task import FRAME
from pliant.telemetry.log import Log
from pliant.telemetry.plots import Curve, Panel, time_series

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def compared(paper_figure: int) -> CaseFigure:
    """Force and position error of every controller that left a log. Args: paper_figure: its number in [FFMPC]."""

    def figure(case: Case[Any], results: Sequence[Result]) -> Mapping[str, Figure]:
        name = case.config.case
        logs = {r.config.controller: Log.open(r.log) for r in results if r.log is not None and r.log.exists()}
        return {name: _over_each_other(f"{name}, as [FFMPC] Fig. {paper_figure}", logs)} if logs else {}

    return figure


def _over_each_other(title: str, logs: Mapping[str, Log]) -> Figure:
    first = next(iter(logs.values()))
    time = first.time(f"reference/{FRAME}/wrench")
    force = [Curve("reference", time, first[f"reference/{FRAME}/wrench"][:, 2], "reference")]
    error: list[Curve] = []
    for name, log in logs.items():
        time = log.time(f"truth/{FRAME}/wrench")
        off = log[f"truth/{FRAME}/position"][:, :2] - log[f"reference/{FRAME}/position"][:, :2]
        force.append(Curve(short(name), time, log[f"truth/{FRAME}/wrench"][:, 2]))
        error.append(Curve(short(name), time, 1e3 * np.linalg.norm(off, axis=1)))
    panels = [Panel("normal force, N", force), Panel("horizontal error, mm", error)]
    return time_series(panels, title=title, phases=first.phases())
