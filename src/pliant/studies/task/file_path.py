"""The path of a task that comes from a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from pliant.errors import ConfigError
from pliant.references.toolpaths.files import PathPoints, read_path
from pliant.references.toolpaths.rows import PathRows
from pliant.references.toolpaths.toolpath import PathMotion, Toolpath, through
from pliant.spatial import Array
from pliant.surfaces import SurfaceGeometry
from pliant.tasks.task import TaskParts

_MILLIMETRES = 5.0  # m; a path as long as that was written in another unit
_SLOWEST = 1e-3  # m/s, by the times of a file
_BETWEEN = 8  # places between two rows at which is looked whether the path runs round the surface


def path_from_file(
    task: TaskParts,
    surface: SurfaceGeometry,
    origin: Array,
    axes: tuple[Array, Array, Array],
    motion: PathMotion,
    heading: Array,
) -> Toolpath:
    """A file's path on the believed surface.

    Args:
        task: with the path's file, and the limits that it must keep.
        surface: the believed one.
        origin: (3,) m, of the file's axes.
        axes: the file's x, y and z in the world: u and v on the surface and the normal at the origin.
        motion: how it is run where the file does not say.
        heading: (3,) direction that the tool's x axis follows as far as it can.

    Raises:
        ConfigError: a file that cannot be read, that leaves the surface or runs round it, that asks for more than the
            task's limits allow, or whose points are all the same; with the line.
    """
    path = task.path
    assert path.file is not None
    file = Path(path.file)
    found = read_path(file, path.unit)
    size = float(np.ptp(found.points, axis=0).max())
    if size > _MILLIMETRES:
        raise ConfigError(f"path file {file} is {size:.4g} m long: is it in millimetres? then set path.unit = 'mm'")
    if size < 1e-9:
        raise ConfigError(
            f"path file {file}, lines {found.lines[0]} to {found.lines[-1]}: all points are the same, and a path needs"
            " a length: for a tool that stays at a place say path.pattern = 'hold'"
        )
    world = origin + found.points @ np.stack(axes)
    if found.flat:
        _refuse_round(file, found, surface, origin, axes)
        world, _ = surface.chart(origin, axes[0], found.points[:, :2])
    _refuse_off(file, found, world, surface, path.off_surface)
    timed = found.speed is None and found.time is not None
    speed = _speed_by_times(world, found.time) if timed and found.time is not None else found.speed
    _refuse_rows(file, found, "force", "N", found.force, task.limits.force)
    _refuse_rows(file, found, "time" if timed else "speed", "m/s", speed, task.limits.speed)
    rows = PathRows(file, found.lines, world)
    if timed and found.time is not None:
        rows = replace(rows, paced_by="time", seconds=float(found.time[-1] - found.time[0]))
    elif found.speed is not None:
        rows = replace(rows, paced_by="speed")
    return replace(through(surface, world, speed, found.force, motion, heading), rows=rows)


def pace_of_file(task: TaskParts, path: Toolpath) -> str:
    """Which of the file and `path.speed` says how fast a path is run, and by how much acceleration slows it, in a
    sentence; empty where the file says nothing."""
    rows = path.rows
    if rows is None or not rows.paced_by:
        return ""
    told = f"the {rows.paced_by}s in {rows.file.name} say how fast, not path.speed"
    if rows.seconds is None:
        return told
    return (
        f"{told}: they ask for {rows.seconds:.3g} s, and the path takes {path.duration:.3g} s, since it begins and ends"
        f" at rest and keeps path.acceleration = {task.path.acceleration:g} m/s²"
    )


def slowed(task: TaskParts, path: Toolpath) -> tuple[str, ...]:
    """A warning where a path takes more than a fifth longer than the times of its file ask for."""
    asked = None if path.rows is None else path.rows.seconds
    return () if asked is None or path.duration <= 1.2 * asked else (pace_of_file(task, path),)


def _speed_by_times(world: Array, times: Array) -> Array:
    """(k,) m/s, of the stretch that leads to each point; of the first point that of the second."""
    way = np.linalg.norm(np.diff(world, axis=0), axis=1) / np.diff(times)
    return np.maximum(np.concatenate([way[:1], way]), _SLOWEST)


def _refuse_off(file: Path, found: PathPoints, world: Array, surface: SurfaceGeometry, most: float) -> None:
    for point, line in zip(world, found.lines, strict=True):
        off = abs(surface.near(point).distance)
        if off > most:
            raise ConfigError(
                f"path file {file}, line {line}: the point is {1e3 * off:.1f} mm off the believed surface, more than"
                f" path.off_surface = {1e3 * most:g} mm: mend the file, path.at or surface.pose"
            )


def _refuse_round(
    file: Path, found: PathPoints, surface: SurfaceGeometry, origin: Array, axes: tuple[Array, Array, Array]
) -> None:
    """Raises ConfigError where lengths along the surface lead to where it faces away from the origin's normal."""
    uv, k = found.points[:, :2], len(found.points)
    dense = np.linspace(0.0, k - 1.0, _BETWEEN * (k - 1) + 1)
    between = np.column_stack([np.interp(dense, np.arange(k), column) for column in uv.T])
    _, normals = surface.chart(origin, axes[0], between)
    away = np.flatnonzero(normals @ axes[2] < 0.0)
    if away.size:
        row = int(np.ceil(dense[away[0]]))
        raise ConfigError(
            f"path file {file}, line {found.lines[row]}: the path runs round the surface, to where it faces away from"
            f" the middle of the path: keep x and y shorter (this point lies {np.linalg.norm(uv[row]):.3g} m along the"
            " surface), or choose another path.at"
        )


def _refuse_rows(
    file: Path, found: PathPoints, column: str, unit: str, asked: npt.NDArray[np.float64] | None, bound: float | None
) -> None:
    """Raises ConfigError where a row asks for more than a limit of the task."""
    if asked is None or bound is None:
        return
    over = np.flatnonzero(asked > bound)
    if over.size:
        kind, row = "force" if column == "force" else "speed", int(over[0])
        raise ConfigError(
            f"path file {file}, line {found.lines[row]}, column {column!r} asks for {asked[row]:g} {unit}, and"
            f" limits.{kind} allows {bound:g}: mend that row or raise limits.{kind}"
        )
