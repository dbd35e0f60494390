"""A path on a surface, timed and oriented: what a tool follows while it presses."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from pliant.errors import ConfigError
from pliant.references.toolpaths.corners import rounded
from pliant.references.toolpaths.orientation import task_rotations, tool_rotations
from pliant.references.toolpaths.pace import pace
from pliant.references.toolpaths.patterns import STEP
from pliant.references.toolpaths.rows import PathRows
from pliant.references.trajectories.rotation import QuaternionSpline
from pliant.references.trajectories.spline import Spline
from pliant.references.trajectories.waypoints import Waypoints
from pliant.spatial import Array, quaternions, unit_rows
from pliant.surfaces import SurfaceGeometry

_KNOT = 0.01  # s between two knots of the splines


@dataclass(frozen=True)
class PathMotion:
    """Speed, acceleration and tool orientation along a path."""

    speed: float = 0.05
    """m/s on the surface, where the file gives none"""
    acceleration: float = 0.5
    """m/s², of starts, stops and bends: corners are rounded by arcs of radius speed²/acceleration at least"""
    tilt: float = 0.0
    """rad, of the tool from the normal in the direction of travel"""
    lean: float = 0.0
    """rad, of the tool from the normal, to the left"""
    lift: float = 0.0
    """m from the surface to the controlled point, along the normal: the radius of a tool ball"""

    def __post_init__(self) -> None:
        for name in ("speed", "acceleration"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ConfigError(f"the {name} of a path must be above zero, got {value}")
        for name in ("tilt", "lean"):
            value = getattr(self, name)
            if not abs(value) <= 0.25 * math.pi:
                raise ConfigError(f"the {name} of a tool must be within ± 45 degrees, got {math.degrees(value):g}")


@dataclass(frozen=True)
class Toolpath:
    """A path on a surface over time, from rest to rest. Before its start and after its end the ends are held."""

    times: Array
    """(k,) s of the knots"""
    places: Array
    """(k, 3) m, on the surface"""
    normals: Array
    """(k, 3) outward"""
    position: Spline
    """(3,) m of the controlled point"""
    rotation: QuaternionSpline
    """R_world_tool"""
    task: QuaternionSpline
    """R_world_task: third axis along the normal"""
    share: Spline
    """(1,) completed share of the path length, 0…1"""
    force: Waypoints | None = None
    """(1,) N along the normal, where the file has a column for it"""
    rows: PathRows | None = None
    """of the file that it comes from; None: a pattern"""

    @property
    def duration(self) -> float:
        """s."""
        return float(self.times[-1])

    @property
    def length(self) -> float:
        """m, on the surface."""
        return float(np.linalg.norm(np.diff(self.places, axis=0), axis=1).sum())

    def told_of(self, place: Array) -> str:
        """The line of its file from which a place (3,) m comes, to be put behind what is said of that place; empty for
        a pattern."""
        return "" if self.rows is None else self.rows.told_of(place)


def on_chart(
    surface: SurfaceGeometry, place: Array, along: Array, uv: Array, motion: PathMotion, heading: Array
) -> Toolpath:
    """A pattern drawn in lengths on the surface.

    Args:
        surface: on which.
        place: (3,) m near the place of the pattern's origin.
        along: (3,) direction of u, laid into the surface.
        uv: (k, 2) m, corners and points of curves.
        motion: how it is run.
        heading: (3,) direction that the tool's x axis follows as far as it can.

    Raises:
        ConfigError: a path without length.
    """
    start = surface.near(place).point
    smooth = rounded(uv, _corner_radius(motion), STEP)
    places, normals = surface.chart(start, surface.tangent(start, along), smooth)
    return timed(places, normals, np.full(len(places), motion.speed), motion, heading)


def through(
    surface: SurfaceGeometry,
    points: Array,
    speed: Array | None,
    force: Array | None,
    motion: PathMotion,
    heading: Array,
) -> Toolpath:
    """Points near the surface, joined and laid on it.

    Args:
        surface: on which.
        points: (k, 3) m.
        speed: (k,) m/s; None: that of the motion.
        force: (k,) N; None for none.
        motion: how it is run.
        heading: (3,) as in `on_chart`.
    """
    smooth = rounded(points, _corner_radius(motion), 5.0 * STEP)
    found = [surface.near(point) for point in smooth]
    places, normals = np.array([near.point for near in found]), np.array([near.normal for near in found])
    given = _way(points) / max(_way(points)[-1], 1e-12)
    here = _way(smooth) / max(_way(smooth)[-1], 1e-12)
    pace_of = np.full(len(places), motion.speed) if speed is None else np.interp(here, given, speed)
    path = timed(places, normals, pace_of, motion, heading)
    if force is None:
        return path
    shares = [float(path.share.at(time).value[0]) for time in path.times.tolist()]
    lines = Waypoints(path.times, np.interp(shares, given, force)[:, None], "ramp")  # a spline would swing below zero
    return replace(path, force=lines)


def resting(place: Array, normal: Array, time: float, motion: PathMotion, heading: Array) -> Toolpath:
    """A path that stays at a point (3,) m of a surface with normal (3,) for a time in s."""
    times = np.linspace(0.0, time, 5)
    places, normals = np.tile(place, (5, 1)), np.tile(normal, (5, 1))
    task = quaternions(task_rotations(normals, heading))
    tool = quaternions(tool_rotations(places, normals, heading))
    return Toolpath(
        times,
        places,
        normals,
        Spline(times, places + motion.lift * normals),
        QuaternionSpline(times, tool),
        QuaternionSpline(times, task),
        Spline(times, (times / time)[:, None]),
    )


def timed(places: Array, normals: Array, speed: Array, motion: PathMotion, heading: Array) -> Toolpath:
    """A toolpath through places (k, 3) m of a surface with normals (k, 3), run at speeds (k,) m/s or less."""
    moved = np.concatenate([[True], np.linalg.norm(np.diff(places, axis=0), axis=1) > 1e-9])
    places, normals, speed = places[moved], normals[moved], speed[moved]
    if len(places) < 3:
        raise ConfigError("a path needs a length: all its points are the same")
    run = pace(places, speed, motion.acceleration)
    times = np.linspace(0.0, run.times[-1], max(math.ceil(run.times[-1] / _KNOT), 4) + 1)
    done = run.way_at(times)

    def at(values: Array) -> Array:
        return np.column_stack([np.interp(done, run.way, column) for column in values.T])

    knots, upright = at(places), at(normals)
    upright = unit_rows(upright)
    rotations = tool_rotations(knots, upright, heading, motion.tilt, motion.lean)
    return Toolpath(
        times,
        knots,
        upright,
        Spline(times, knots + motion.lift * upright, rests=True),
        QuaternionSpline(times, quaternions(rotations), rests=True),
        QuaternionSpline(times, quaternions(task_rotations(upright, heading)), rests=True),
        Spline(times, done[:, None] / run.way[-1], rests=True),
    )


def _corner_radius(motion: PathMotion) -> float:
    return motion.speed**2 / motion.acceleration


def _way(points: Array) -> Array:
    """(k,) m, path length to each point."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
