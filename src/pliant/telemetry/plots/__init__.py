"""Figures: matplotlib without a display and without its global state, in one style. Each function returns a
`Figure`."""

from pliant.telemetry.plots.bars import compare
from pliant.telemetry.plots.energy import energy_ledger
from pliant.telemetry.plots.joints import joint_torques, posture_difference
from pliant.telemetry.plots.log import plot_log
from pliant.telemetry.plots.parameter import sweep
from pliant.telemetry.plots.path import Path2D, task_path
from pliant.telemetry.plots.portrait import attractor, phase_portrait
from pliant.telemetry.plots.rows import dots
from pliant.telemetry.plots.series import Curve, Panel, time_series
from pliant.telemetry.plots.style import save
from pliant.telemetry.plots.trials import trials

__all__ = [
    "Curve",
    "Panel",
    "Path2D",
    "attractor",
    "compare",
    "dots",
    "energy_ledger",
    "joint_torques",
    "phase_portrait",
    "plot_log",
    "posture_difference",
    "save",
    "sweep",
    "task_path",
    "time_series",
    "trials",
]
