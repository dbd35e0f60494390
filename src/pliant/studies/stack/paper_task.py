"""The task files that the paths and the defaults of the study are made from."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.spatial import Array, unit
from pliant.tasks import Task, load_task
from pliant.tasks.draws import LogUniform, Uniform
from pliant.tasks.phase import Track


def track_of(task: Task) -> tuple[str, Track]:
    """The tool's frame and its motion."""
    frame, track = next(iter(task.phase[0].tracks.items()))
    assert isinstance(track, Track)
    return frame, track


PLAIN: Task = load_task("figure8-plain")
"""[Stack] sec. III: a figure-8 by an arm that nothing compensates"""
FIGURE8: Track = track_of(PLAIN)[1]
LINE: Track = track_of(load_task("line-hardware"))[1]
STRETCH: Track = track_of(load_task("singular"))[1]


def _place(track: Track) -> Array:
    assert track.at is not None
    return np.array(track.at)


def _nominal(track: Track) -> Array:
    assert track.nominal is not None
    return np.array(track.nominal) * np.pi / 180.0  # in this order the file's degrees give its radians to the last bit


def _z_axis(track: Track) -> tuple[float, float, float]:
    assert track.z_axis is not None
    return track.z_axis


CENTRE = _place(FIGURE8)
"""(3,) m, of the figure-8 and of the line"""
STRAIGHT = _place(STRETCH)
"""(3,) m, where the arm is nearly straight"""
NOMINAL = _nominal(FIGURE8)
"""(7,) rad, where the posture drifts to"""
Z_AXIS = _z_axis(FIGURE8)
"""world axes, where the tool points"""


def wall_of(task: Task) -> dict[str, float]:
    """Where the wall stops the tool, m from the path's middle, and what it is made of."""
    wall, (_, track) = task.scene["wall"], track_of(task)
    assert track.across is not None
    away = float((np.array(wall.pose.xyz) - _place(track)) @ unit(track.across, "across"))
    return {
        "x": away - task.tool.radius,
        "stiffness": wall.stiffness,
        "damping": wall.damping,
        "friction": wall.friction,
    }


def pushes_of_task(task: Task) -> dict[str, Any]:
    """Frame, and the ranges of force (N), duration and gap (s) of its pushes, and their end (s)."""
    (pushes,) = task.disturbance
    ranges = {"force": pushes.push, "duration": pushes.duration, "gap": pushes.gap}
    return {
        "frame": pushes.frame,
        **{name: of.uniform for name, of in ranges.items() if isinstance(of, Uniform)},
        "end": pushes.end,
    }


def retuning_of(task: Task) -> dict[str, Any]:
    """Changes a second, and the range of the factor on stiffness and force bound alike."""
    (event,) = task.event
    factors = [factor for factor in event.factor.values() if isinstance(factor, LogUniform)]
    assert event.every is not None
    assert set(event.factor) == {"stiffness", "force_max"}
    assert factors[0] == factors[1]
    return {"rate": 1.0 / event.every, "factor": factors[0].log_uniform}


WALL = load_task("figure8-plain", "figure8-wall")
TOUCH_RADIUS: float = WALL.tool.radius
"""m, of the sphere with which the tool touches the wall"""
PUSHED = pushes_of_task(load_task("figure8-hardware", "figure8-pushed"))
RETUNED = retuning_of(load_task("figure8-plain", "calibration"))
