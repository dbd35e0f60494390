"""The curves that a task file can name, as trajectories."""

from __future__ import annotations

import numpy as np

from pliant.references.trajectories.shapes import circle, lemniscate, sine_line
from pliant.references.trajectories.trajectory import Trajectory
from pliant.spatial import Array
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
