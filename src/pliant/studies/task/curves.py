"""The curves that a task file can name, as trajectories."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pliant.axis_modes import AXIS_NAMES
from pliant.errors import ConfigError
from pliant.references.placed_phases import PlacedPhase
from pliant.references.planners.curves import PhaseCurve
from pliant.references.trajectories.shapes import circle, lemniscate, sine_line
from pliant.references.trajectories.trajectory import Trajectory
from pliant.spatial import Array
from pliant.studies.task.config import TaskCase
from pliant.studies.task.phase_axes import axes_of_phases
from pliant.tasks.timed import CurveConfig


def curve_of(shape: str, about: CurveConfig, begin: Array, across: Array, up: Array) -> Trajectory:
    """A curve (3,) m at its full speed, from the place where it begins.

    Args:
        shape: lemniscate, line or circle.
        about: its sizes and times.
        begin: (3,) m, where it is at time zero.
        across, up: (3,) directions, of a circle from its beginning to its middle, and where it sets out.

    Raises:
        ConfigError: directions of a circle that are not perpendicular, or a size that is not above zero.
    """
    if shape == "lemniscate":
        return lemniscate(about.period, begin, *about.size, across, up)
    if shape == "line":
        return sine_line(about.size[0], about.peak_speed, begin, across)
    return circle(begin, about.size[0], 2.0 * np.pi / about.period, across, up)


def phase_curves(case: TaskCase, all_placed: Sequence[PlacedPhase]) -> dict[int, PhaseCurve]:
    """Number of a phase of a list that goes by its targets → the curve beside its target.

    Raises:
        ConfigError: a curve along an axis on which no motion is asked for, or that would begin or end with a jump.
    """
    found: dict[int, PhaseCurve] = {}
    for index, (phase, placed, axes) in enumerate(zip(case.phase, all_placed, axes_of_phases(case), strict=True)):
        about, R = phase.motion, axes.rotation
        if about is None or about.shape == "hold":
            continue
        if about.ramp == 0.0:
            raise ConfigError(f"phase {placed.name!r}: motion.ramp is above 0 s: the curve starts from rest within it")
        across = R[:, 0] if about.across is None else R @ np.array(about.across)
        up = R[:, 1] if about.up is None else R @ np.array(about.up)
        _refuse_pressed(placed, (across,) if about.shape == "line" else (across, up))
        way = curve_of(about.shape, about, np.zeros(3), across, up).eased(about.ramp)
        found[index] = PhaseCurve(way, about.ramp)
    return found


def _refuse_pressed(placed: PlacedPhase, directions: Sequence[Array]) -> None:
    modes = placed.task.modes
    if modes is None:
        return
    parts = np.abs(modes.rotation.T @ np.stack(directions, axis=1)).max(axis=1)
    odd = [AXIS_NAMES[axis] for axis in range(3) if parts[axis] > 1e-6 and modes.modes[axis] != "motion"]
    if odd:
        raise ConfigError(
            f"phase {placed.name!r}: its motion goes along {', '.join(odd)}, whose mode is not motion: turn it by"
            " motion.across and motion.up"
        )
