"""The limits of a task: what asks for more is refused, what passes them ends a run."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from pliant.errors import ConfigError
from pliant.simulation.limited_plant import RunLimits
from pliant.spatial import Array
from pliant.tasks.limits import Limits


def run_limits(limits: Limits, frame: str) -> RunLimits | None:
    """As a run is watched; None where there are none."""
    if limits == Limits():
        return None
    force, speed, torque = (math.inf if one is None else one for one in (limits.force, limits.speed, limits.torque))
    if limits.workspace is None:
        return RunLimits(frame, force, speed, torque)
    return RunLimits(frame, force, speed, torque, limits.workspace.lower, limits.workspace.upper)


def refuse_beyond(limits: Limits, forces: Iterable[tuple[str, float]], speeds: Iterable[tuple[str, float]]) -> None:
    """Raises ConfigError where a task asks for more force (N) or speed (m/s) than its own limits allow.

    Args: forces, speeds: key of the task that asks, and how much.
    """
    for kind, unit, bound, asked in (("force", "N", limits.force, forces), ("speed", "m/s", limits.speed, speeds)):
        for key, value in asked:
            if bound is not None and value > bound:
                raise ConfigError(
                    f"{key} asks for {value:g} {unit}, and limits.{kind} allows {bound:g}: lower {key} or raise"
                    f" limits.{kind}"
                )


def refuse_outside(limits: Limits, key: str, places: Array) -> None:
    """Raises ConfigError where a task goes out of its own workspace. Args: key: what does; places: (k, 3) m."""
    if limits.workspace is None:
        return
    out = (places < limits.workspace.lower).any(axis=1) | (places > limits.workspace.upper).any(axis=1)
    if out.any():
        x, y, z = places[int(np.argmax(out))]
        raise ConfigError(f"{key} leaves limits.workspace at ({x:.3f}, {y:.3f}, {z:.3f}) m: move it or widen the limit")
