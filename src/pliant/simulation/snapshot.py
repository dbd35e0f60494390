"""Pictures of a scene, without a display.

MuJoCo chooses its OpenGL platform once, when it is imported. A child process that is told to use EGL (or OSMesa)
renders whatever the parent chose, so a picture never depends on how a program was started.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from pliant.spatial import Array

_CHILD = Path(__file__).with_name("_render_child.py")
_FLAT = 0.06  # widths of a line that its picture may be off: far less than a pixel, and a tenth of the segments
_PATIENCE = 120.0  # s for one platform; a driver that does not respond counts as missing


@dataclass(frozen=True)
class Camera:
    """Where the picture is taken from."""

    look_at: tuple[float, float, float] = (0.0, 0.0, 0.4)
    """m"""
    distance: float = 2.0
    """m"""
    azimuth: float = 120.0
    """degrees"""
    elevation: float = -20.0
    """degrees"""


@dataclass(frozen=True)
class Path3:
    """A line drawn into the picture."""

    points: Array
    """(k, 3) m"""
    rgba: tuple[float, float, float, float]
    width: float = 0.004
    """m"""


@dataclass(frozen=True)
class Arrow:
    """An arrow drawn into the picture, for a force or a direction."""

    start: Array
    """(3,) m"""
    vector: Array
    """(3,) m"""
    rgba: tuple[float, float, float, float]


@dataclass(frozen=True)
class Snapshot:
    """One picture: a state and what is drawn over it."""

    qpos: Array
    """(nq,) MuJoCo configuration of robot and free bodies"""
    paths: tuple[Path3, ...] = ()
    arrows: tuple[Arrow, ...] = ()


def render(
    model: mujoco.MjModel, snapshots: Sequence[Snapshot], camera: Camera, *, width: int = 960, height: int = 720
) -> list[Array] | None:
    """Renders pictures.

    Args:
        model: of the plant (`MujocoPlant.model`).
        snapshots: states to draw.
        camera: the point of view, the same for all.
        width, height: pixels.

    Returns:
        One (height, width, 3) array of bytes per snapshot; None if this machine can render with neither EGL nor OSMesa.
    """
    with tempfile.TemporaryDirectory() as folder:
        base = Path(folder)
        mujoco.mj_saveModel(model, str(base / "model.mjb"), None)
        np.savez(base / "job.npz", **_pack(snapshots, camera, width, height))
        for platform in ("egl", "osmesa"):
            environment = os.environ | {"MUJOCO_GL": platform, "PYOPENGL_PLATFORM": platform}
            command = [sys.executable, str(_CHILD), str(base)]
            with suppress(subprocess.TimeoutExpired):
                child = subprocess.run(
                    command, env=environment, cwd=folder, capture_output=True, check=False, timeout=_PATIENCE
                )
                if child.returncode == 0:
                    return list(np.load(base / "pixels.npy"))
    return None


def _pack(snapshots: Sequence[Snapshot], camera: Camera, width: int, height: int) -> dict[str, Any]:
    job: dict[str, Any] = {
        "qpos": np.array([snapshot.qpos for snapshot in snapshots]),
        "camera": np.array([*camera.look_at, camera.distance, camera.azimuth, camera.elevation]),
        "size": np.array([width, height]),
    }
    lines: list[list[float]] = []  # snapshot, kind (0 line, 1 arrow), width, from xyz, to xyz, rgba
    for index, snapshot in enumerate(snapshots):
        for path in snapshot.paths:
            for a, b in pairwise(thinned_path(path.points, _FLAT * path.width)):
                lines.append([index, 0, path.width, *a, *b, *path.rgba])
        for arrow in snapshot.arrows:
            lines.append([index, 1, 0.012, *arrow.start, *(arrow.start + arrow.vector), *arrow.rgba])
    job["lines"] = np.array(lines).reshape(-1, 13)
    return job


def thinned_path(points: Array, tolerance: float) -> Array:
    """Corners of a path between which it is straight (Douglas and Peucker, 1973).

    Args:
        points: (k, 3) m.
        tolerance: m that a left-out point may be off the line between the corners beside it.

    Returns:
        (j, 3) m, j ≤ k: a part of the points, the first and the last among them.
    """
    kept = np.zeros(len(points), bool)
    kept[[0, -1] if len(points) else []] = True
    spans = [(0, len(points) - 1)]
    while spans:
        begin, end = spans.pop()
        if end - begin < 2:
            continue
        between, chord = points[begin + 1 : end] - points[begin], points[end] - points[begin]
        share = np.clip(between @ chord / max(chord @ chord, 1e-300), 0.0, 1.0)
        off = np.linalg.norm(between - share[:, None] * chord, axis=1)
        farthest = int(np.argmax(off))
        if not off[farthest] <= tolerance:  # a point that is no number stays
            middle = begin + 1 + farthest
            kept[middle] = True
            spans += [(begin, middle), (middle, end)]
    return points[kept]
