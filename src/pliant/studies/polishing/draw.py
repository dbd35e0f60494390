"""Figures of the polishing study."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pliant.studies.base import Experiment, Result
from pliant.studies.polishing.config import FRAME, PolishingConfig
from pliant.studies.runner import file_stem
from pliant.telemetry.log import Log
from pliant.telemetry.plots.series import Curve, Panel, time_series
from pliant.telemetry.plots.style import save

DRAWN = ("ideal", "tables-2-3-4", "tables-2-3-4-delayed", "square", "slow", "slow-tilted", "fast-tilted", "fast-pushed")
"""cases of which the first run of each row is drawn"""


def run_figures(config: PolishingConfig, experiment: Experiment, log: Log, folder: Path) -> list[Path]:
    """Force, position error and solver over time."""
    time = log.time(f"truth/{FRAME}/wrench")
    force, wanted = log[f"truth/{FRAME}/wrench"][:, 2], log[f"reference/{FRAME}/wrench"][:, 2]
    error = 1e3 * (log[f"truth/{FRAME}/position"] - log[f"reference/{FRAME}/position"])
    panels = [
        Panel("normal force, N", [Curve("true", time, force), Curve("reference", time, wanted, "reference")]),
        Panel("position error, mm", [Curve("xy"[axis], time, error[:, axis]) for axis in range(2)]),
        Panel("SQP iterations", [Curve("", log.time("mpc/iterations"), log["mpc/iterations"])]),
    ]
    made = time_series(panels, title=f"{config.case}, {config.controller}", phases=log.phases())
    return [save(made, folder / f"{file_stem(config)}.png")]


def summary_figures(results: Sequence[Result], folder: Path) -> list[Path]:
    """What only several runs together show."""
    return []
