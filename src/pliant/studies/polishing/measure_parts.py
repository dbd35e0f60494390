"""Metrics of a polishing run's parts: single circles, as [FFMPC] Tables V to VII have them, and steps of the force."""

from __future__ import annotations

import math

import numpy as np

from pliant.spatial import Array
from pliant.studies.polishing.config import PolishingConfig
from pliant.telemetry import contact_metrics
from pliant.telemetry import metrics as of

_MOST = 10
"""circles, as many as the paper takes"""

Found = dict[str, tuple[float, str]]
"""name → value and unit"""


def of_circles(config: PolishingConfig, time: Array, force_error: Array, position_error: Array) -> Found:
    """MAE over each whole circle after the first one's start: mean and deviation (n − 1) over at most ten of them.

    Args:
        config: of the run.
        time: (n,) s.
        force_error: (n,) N.
        position_error: (n, 2) mm.

    Returns:
        Nothing where fewer than two circles were drawn.
    """
    task, length = config.task, 2.0 * math.pi / config.task.speed
    begin = task.circle + task.ease
    end = min(config.duration if task.stop is None else task.stop, float(time[-1]) + config.period)
    count = min(math.floor((end - begin) / length + 1e-9), _MOST)
    if task.pattern != "circle" or count < 2:
        return {}
    windows = [of.between(time, begin + turn * length, begin + (turn + 1) * length) for turn in range(count)]
    found: Found = {"circles": (float(count), "1")}
    for name, error, unit in (("E_λ", force_error, "N"), ("E_P", position_error, "mm")):
        each = [float(np.mean(np.abs(error[window]))) for window in windows]
        found[f"{name} of a circle"] = (float(np.mean(each)), unit)
        found[f"{name} from circle to circle"] = (float(np.std(each, ddof=1)), unit)
    return found


def of_steps(config: PolishingConfig, time: Array, force: Array, wanted: Array) -> Found:
    """How far the force passes its step, up and down, N: the worst of them. Args: force, wanted: (n,) N."""
    task = config.task
    if task.pattern != "square":
        return {}
    begins = np.flatnonzero(np.diff(wanted) != 0.0) + 1
    begins = begins[time[begins] >= task.circle - 1e-9]
    worst: dict[str, float] = {}
    for place, begin in enumerate(begins):
        end = begins[place + 1] if place + 1 < len(begins) else len(time)
        way = "up" if wanted[begin] > wanted[begin - 1] else "down"
        past = contact_metrics.overshoot(force[begin:end], float(wanted[begin]), float(wanted[begin - 1]))
        worst[way] = max(worst.get(way, 0.0), past)
    return {f"overshoot {way}": (value, "N") for way, value in worst.items()}
