"""Metrics of contact and of steps of a force: breaks, settling, overshoot."""

from __future__ import annotations

import math

import numpy as np

from pliant.spatial import Array
from pliant.telemetry.metrics import between, error_of, some_values

BREAK_FORCE = 1e-3  # N; [FFMPC] eq. 35 counts a sample at or below γ as a break of contact, its value is ours


# ---------------------------------------------------------------------- contact


def break_share(force: Array, threshold: float = BREAK_FORCE) -> float:
    """t_break: share of the samples in which the normal force is at or below a threshold ([FFMPC] eq. 35).

    Args:
        force: (n,) N, the reaction along the surface's normal, positive when pressed.
        threshold: γ, N.

    Returns:
        A fraction: 0.33 is 33 %.

    Raises:
        ShapeError: there is no sample.
    """
    force = some_values(force)
    return float(np.mean(force <= threshold)) if np.isfinite(force).all() else math.nan


def contact_breaks(force: Array, threshold: float = BREAK_FORCE) -> float:
    """How often the contact is lost: falls of the normal force (n,) N from above a threshold to it or below.

    Raises:
        ShapeError: there is no sample.
    """
    force = some_values(force)
    if not np.isfinite(force).all():
        return math.nan
    touching = force > threshold
    return float(np.count_nonzero(touching[:-1] & ~touching[1:]))


# ---------------------------------------------------------------------- steps


def settling_time(
    time: Array, value: Array, target: float, start: float, command_time: float, band: float = 0.05
) -> float:
    """Time from the command of a step until the value is within a share of the step of its target, and stays there.

    Args:
        time: (n,) s, up to the next command.
        value: (n,).
        target: of the step, in the unit of the value.
        start: what was asked for before the step.
        command_time: s.
        band: share of `|target − start|`.

    Returns:
        s; infinite if the last sample is outside, 0 if none is.

    Raises:
        ShapeError: the shapes differ, or there is no sample after the command.
    """
    after = between(time, command_time)
    error = np.abs(error_of(value, np.full_like(value, target))[after])
    time = some_values(time[after])
    outside = np.flatnonzero(~(error <= band * abs(target - start)))  # NaN is outside
    if not outside.size:
        return 0.0
    if outside[-1] == len(time) - 1:
        return math.inf
    return float(time[outside[-1] + 1]) - command_time


def overshoot(value: Array, target: float, start: float) -> float:
    """How far a step response passes its target: the largest excess in the direction of the step, at least 0.

    Args:
        value: (n,) from the command to the next one.
        target: of the step.
        start: what was asked for before it.

    Returns:
        In the unit of the value.

    Raises:
        ShapeError: there is no sample.
    """
    direction = math.copysign(1.0, target - start)
    worst = float(np.max(direction * (some_values(value) - target)))
    return worst if math.isnan(worst) else max(0.0, worst)
