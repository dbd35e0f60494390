"""Metrics of a polishing run, on the true signals; [FFMPC] section VI defines the first ones."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from pliant.spatial import Array
from pliant.studies.polishing.config import PolishingConfig
from pliant.studies.polishing.measure_parts import of_circles, of_steps
from pliant.studies.polishing.paper_task import FRAME
from pliant.telemetry import contact_metrics
from pliant.telemetry import metrics as of
from pliant.telemetry.log import Log
from pliant.telemetry.summary import Metric

WORST = ("λ_max", "λ_dev", "t_break", "first contact peak")
"""metrics that the worst run decides"""
_LANDING = 0.1  # s after the first contact that still count as landing


def measure(config: PolishingConfig, log: Log) -> tuple[Metric, ...]:
    """Errors from the start of the circle, contact breaks from the end of the ramp, the peak of the first contact.

    E_λ and E_P as the paper takes them (world z, horizontal), then along the table's normal and in its plane, then as
    the authors' program computes E_λ (measured force, moving average of 21 samples).
    """
    task = config.task
    time = log.time(f"truth/{FRAME}/wrench")
    working = of.between(time, task.circle, math.inf if task.stop is None else task.stop)
    force, wanted = log[f"truth/{FRAME}/wrench"][:, :3], log[f"reference/{FRAME}/wrench"][:, 2]
    position = 1e3 * (log[f"truth/{FRAME}/position"] - log[f"reference/{FRAME}/position"])  # mm
    off_normal, off_plane = _in_table_axes(config, force, wanted, position)
    measured = of.moving_average(log[f"estimate/{FRAME}/wrench"][:, 2])
    behind = log["truth/torque"] - log["measurement/torque_sent"]
    zeros = np.zeros_like(off_plane[working])
    found = {
        "E_λ": (of.mae(force[working, 2], wanted[working]), "N"),
        "E_P": (of.mae(position[working, :2], zeros), "mm"),
        "E_τ": (float(np.mean(np.abs(behind[working]))), "N·m"),
        "E_τ averaged over 21 ms": (_slow(behind, working), "N·m"),
        "λ_max": (of.peak(force[working, 2]), "N"),
        "λ_dev": (of.max_error(force[working, 2], wanted[working]), "N"),
        "t_break": (100.0 * contact_metrics.break_share(force[of.between(time, task.pressed), 2]), "%"),
        "first contact peak": (_first_peak(config, time, force[:, 2]), "N"),
        "E_λ along the normal": (float(np.mean(np.abs(off_normal[working]))), "N"),
        "E_P in the table's plane": (of.mae(off_plane[working], zeros), "mm"),
        "E_λ as the authors filter": (of.mae(measured[working], wanted[working]), "N"),
    }
    found |= of_circles(config, time, force[:, 2] - wanted, position[:, :2])
    found |= of_steps(config, time, force[:, 2], wanted)
    if task.stop is not None:
        rest = of.between(time, task.stop + task.ease)
        found["E_λ after the stop"] = (of.mae(force[rest, 2], wanted[rest]), "N")
    if "mpc/status" in log:
        found["KKT reached"] = (100.0 * float(np.mean(log["mpc/status"] == 0.0)), "%")
        found["iterations"] = (float(np.mean(log["mpc/iterations"])), "1")
    return tuple(Metric(name, value, unit) for name, (value, unit) in found.items())


def _slow(error: Array, working: npt.NDArray[np.bool_]) -> float:
    """Mean absolute error (n, joints) of which the chatter was averaged away."""
    return float(np.mean([np.mean(np.abs(of.moving_average(joint)[working])) for joint in error.T]))


def _first_peak(config: PolishingConfig, time: Array, force: Array) -> float:
    """Largest normal force from the descent until shortly after the first contact, N."""
    task = config.task
    touching = np.flatnonzero(force > 0.0)
    first = float(time[touching[0]]) if touching.size else task.touch
    return of.peak(force[of.between(time, task.reach, max(task.touch, first) + _LANDING)])


def _in_table_axes(
    config: PolishingConfig, force: Array, wanted: Array, position: Array
) -> tuple[Array, npt.NDArray[np.float64]]:
    """Normal force minus what is wanted (n,), and position errors in the table's plane (n, 2)."""
    tilt = config.table.tilt
    normal = np.array([0.0, -math.sin(tilt), math.cos(tilt)])
    along = np.array([0.0, math.cos(tilt), math.sin(tilt)])
    return force @ normal - wanted, np.column_stack([position[:, 0], position @ along])
