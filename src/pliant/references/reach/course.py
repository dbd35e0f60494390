"""Sampled poses of a tool in a task on a surface, believed or true."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pliant.errors import ConfigError
from pliant.references.source import FrameMotion
from pliant.references.toolpaths.pressing import PressingForce
from pliant.references.toolpaths.toolpath import Toolpath
from pliant.references.trajectories.rotation import QuaternionSpline
from pliant.references.trajectories.spline import Spline
from pliant.signals import Reference
from pliant.spatial import Array, quaternions
from pliant.surfaces import SurfaceGeometry

_STEP = 0.1  # s between samples
_FEWEST, _MOST = 40, 300  # samples of the path
_FARTHEST = 0.1  # m along the normal within which a true surface is searched


@dataclass(frozen=True)
class Course:
    """Motion of a tool down to a surface, along a path and away from it."""

    times: Array
    """(k,) s"""
    places: Array
    """(k, 3) m of the controlled point"""
    rotations: Array | None
    """(k, 3, 3) R_world_tool; None: the orientation is free"""
    normals: Array
    """(k, 3) outward, of the believed surface; zero where nothing is pressed and there is no surface"""
    force: Array
    """(k,) N along the normal; 0 where the tool does not touch"""
    on_path: slice
    """which samples are the path's"""

    def motion(self, frame: str) -> FrameMotion:
        """As the motion of a frame."""
        if self.rotations is None:
            return FrameMotion(frame, Spline(self.times, self.places))
        turns = quaternions(self.rotations)
        return FrameMotion(frame, Spline(self.times, self.places), QuaternionSpline(self.times, turns))

    def moved(self, shift: Array) -> Course:
        """The same course, shifted. Args: shift: (3,) m."""
        return replace(self, places=self.places + shift)

    def on(self, surface: SurfaceGeometry, lift: float) -> Course:
        """The course on another true surface: each point is moved along the believed normal until it meets that
        surface.

        Args:
            surface: the true one.
            lift: m from it to the controlled point.

        Raises:
            ConfigError: the path leaves that surface.
        """
        rows = range(*self.on_path.indices(len(self.times)))
        heights = np.array([_height(surface, self.places[i], self.normals[i], lift) for i in rows])
        before, after = self.on_path.start, len(self.times) - self.on_path.stop
        lifted = np.concatenate([np.full(before, heights[0]), heights, np.full(after, heights[-1])])
        return replace(self, places=self.places + lifted[:, None] * self.normals)


def course_of(path: Toolpath, force: PressingForce, stand_off: float, approach_speed: float, leave: float) -> Course:
    """The course of a task on the believed surface.

    Args:
        path: on it.
        force: along it; a force of the path's own counts instead.
        stand_off: m over the first and the last place, where the course begins and ends.
        approach_speed: m/s.
        leave: s of the way up.
    """
    along = instants_of(path.duration)
    pressing = path.force if path.force is not None else force.along(path)
    places = np.array([path.position.at(t).value for t in along.tolist()])
    rotations = np.array([path.rotation.at(t).rotation for t in along.tolist()])
    normals = np.array([path.task.at(t).rotation[:, 2] for t in along.tolist()])
    forces = np.array([float(pressing.at(t).value[0]) for t in along.tolist()])
    down, up = np.linspace(1.0, 0.0, 6)[:-1], np.linspace(0.0, 1.0, 6)[1:]
    above, gone = (places[i] + stand_off * np.outer(share, normals[i]) for i, share in ((0, down), (-1, up)))
    landing = stand_off / approach_speed
    return Course(
        np.concatenate([landing * (1.0 - down), landing + along, landing + path.duration + leave * up]),
        np.vstack([above, places, gone]),
        np.concatenate([np.tile(rotations[0], (5, 1, 1)), rotations, np.tile(rotations[-1], (5, 1, 1))]),
        np.vstack([np.tile(normals[0], (5, 1)), normals, np.tile(normals[-1], (5, 1))]),
        np.concatenate([np.zeros(5), forces, np.zeros(5)]),
        slice(5, 5 + len(along)),
    )


def course_through(references: Sequence[Reference]) -> Course:
    """The course of the first task of references at increasing times; forces count, moments do not."""
    tasks = [reference.tasks[0] for reference in references]
    pushes = np.array([task.wrench[:3] for task in tasks])
    sizes = np.linalg.norm(pushes, axis=1)
    turns = [task.rotation for task in tasks if task.rotation is not None]
    times = np.array([reference.time for reference in references])
    return Course(
        times - times[0],
        np.array([task.position for task in tasks]),
        np.array(turns) if len(turns) == len(tasks) else None,
        pushes / np.maximum(sizes, 1e-12)[:, None],
        sizes,
        slice(0, len(tasks)),
    )


def instants_of(seconds: float) -> Array:
    """(k,) s, at which a motion of so many seconds is looked at."""
    return np.linspace(0.0, seconds, min(max(math.ceil(seconds / _STEP), _FEWEST), _MOST) + 1)


def _height(surface: SurfaceGeometry, place: Array, normal: Array, lift: float) -> float:
    """m along a normal from a place to where a surface is `lift` away (Newton)."""
    height = 0.0
    for _ in range(20):
        near = surface.near(place + height * normal)
        slope = float(normal @ near.normal)
        if slope < 0.2 or abs(height) > _FARTHEST:
            break
        step = (lift - near.distance) / slope
        height += step
        if abs(step) < 1e-9:
            return height
    x, y, z = place
    raise ConfigError(f"the path leaves the surface near ({x:.3f}, {y:.3f}, {z:.3f}) m")
