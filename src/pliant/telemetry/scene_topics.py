"""Frames, shapes, paths and forces of a run as topics of its log, for the 3-D views of Foxglove and RViz."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import mujoco
import numpy as np
import numpy.typing as npt

from pliant.spatial import Array, quaternions
from pliant.telemetry.mcap.scene_messages import MARKERS, TRANSFORMS, marker_array, moving_markers, transforms
from pliant.telemetry.mcap.topics import PREFIX
from pliant.telemetry.mcap.writer import McapFile
from pliant.telemetry.scene_markers import arrow, arrow_points, line, markers_of
from pliant.visual_shapes import Poser, looks_of

RATE = 30.0  # Hz
_LEAST_STEP = 1e-3  # m between two points of a path
_NO_TURN = np.array([1.0, 0.0, 0.0, 0.0])
_COLOURS = {"reference": (0.16, 0.42, 0.78, 1.0), "truth": (0.92, 0.49, 0.13, 1.0)}


@dataclass(frozen=True)
class DrawnScene:
    """The scene to draw: a compiled model, the robot's joints first."""

    model: mujoco.MjModel
    joints: int
    """number of its joints that belong to the robot"""


@dataclass
class _Path:
    """Places that a frame passed, none closer than a millimetre to the one before."""

    points: list[list[float]] = field(default_factory=list)

    def add(self, place: list[float]) -> None:
        if all(map(math.isfinite, place)) and (not self.points or math.dist(place, self.points[-1]) >= _LEAST_STEP):
            self.points.append(place)


class SceneTopics:
    """Writes `/tf`, `/pliant/scene`, `/pliant/force` as blocks come, and `/pliant/path` at the end.

    A 3-D view shows the newest message of a topic: each of them says all of its topic. The path carries the time of
    the first sample, so that the whole of it is there from the start.

    Args:
        scene: robot and surroundings.
        file: the log.
    """

    def __init__(self, scene: DrawnScene, file: McapFile) -> None:
        self._scene, self._file = scene, file
        self._poser = Poser(scene.model, scene.joints)
        self._names = [scene.model.body(body).name or f"body{body}" for body in range(scene.model.nbody)]
        self._moving = [body for body in range(1, scene.model.nbody) if _moves(scene.model, body)]
        self._last = -1
        """number of the 30 Hz frame that was written last"""
        self._first: int | None = None
        """ns of the first sample"""
        self._paths: dict[tuple[str, str], _Path] = {}

    def add(self, times: npt.NDArray[np.int64], columns: Mapping[str, Array]) -> None:
        """Takes a block. Args: times: (n,) ns; columns: channel → (n, …) values, as logged."""
        joints = next((columns[name] for name in ("truth/q", "measurement/q") if name in columns), None)
        if joints is None or not len(times) or joints.shape[1] != self._scene.joints:
            return
        if self._first is None:
            self._first = int(times[0])
            markers = markers_of(looks_of(self._scene.model, self._scene.joints), self._frame_of)
            self._file.add_messages(f"{PREFIX}/scene", MARKERS, [(self._first, marker_array(self._first, markers))])
        rows = self._chosen(times)
        if not len(rows):
            return
        names = _Names.of(columns)
        placed = self._placed(joints[rows], {name: columns[channel][rows] for channel, name in names.objects}, names)
        frames = self._poses(placed)
        self._send(
            "/tf", TRANSFORMS, times[rows], transforms(times[rows], list(frames), np.stack([*frames.values()], 1))
        )
        self._send(f"{PREFIX}/force", MARKERS, times[rows], self._arrows(times[rows], rows, placed, columns, names))
        for name, key in names.places:
            path = self._paths.setdefault(key, _Path())
            for place in columns[name][rows].tolist():
                path.add(place)

    def finish(self) -> None:
        """Writes the paths."""
        if self._first is None:
            return
        markers = [
            line(f"{signal} path of {frame}", _COLOURS[signal], np.array(path.points), number)
            for number, ((signal, frame), path) in enumerate(self._paths.items())
            if len(path.points) > 1 and ("reference", frame) in self._paths
        ]
        if markers:
            self._file.add_messages(f"{PREFIX}/path", MARKERS, [(self._first, marker_array(self._first, markers))])

    def _chosen(self, times: npt.NDArray[np.int64]) -> npt.NDArray[np.intp]:
        """Rows that come first in their 30th of a second."""
        numbers = np.floor(times * (RATE * 1e-9) + 1e-6).astype(np.int64)
        before = np.concatenate(([self._last], numbers[:-1]))
        self._last = int(numbers[-1])
        return np.flatnonzero(numbers != before)

    def _frame_of(self, body: int) -> str:
        """World for what cannot move: it needs no transform."""
        return self._names[body] if body in self._moving else "world"

    def _send(self, topic: str, kind: str, times: npt.NDArray[np.int64], messages: Sequence[bytes]) -> None:
        self._file.add_messages(topic, kind, [*zip(times.tolist(), messages, strict=False)])

    def _placed(self, q: Array, objects: Mapping[str, Array], names: _Names) -> _Placed:
        """Where everything is. Args: q: (k, n) rad; objects: thing → (k, 7) position and quaternion."""
        known = [(frame, site) for frame in names.frames if (site := self._poser.site(frame)) >= 0]
        sites = [site for _, site in known]
        k = len(q)
        bodies, places = np.empty((k, len(self._moving), 7)), np.empty((k, len(sites), 3))
        rotations = np.empty((k, len(sites), 3, 3))
        for row in range(k):
            positions, turns = self._poser.bodies(q[row], {name: pose[row] for name, pose in objects.items()})
            bodies[row, :, :3], bodies[row, :, 3:] = positions[self._moving], turns[self._moving]
            places[row], rotations[row] = self._poser.sites(sites)
        attitudes = quaternions(rotations).reshape(k, -1, 4)
        return _Placed(bodies, [frame for frame, _ in known], np.concatenate([places, attitudes], axis=2))

    def _poses(self, placed: _Placed) -> dict[str, Array]:
        """Frame → (k, 7) position and quaternion."""
        found = {self._names[body]: placed.bodies[:, number] for number, body in enumerate(self._moving)}
        for number, frame in enumerate(placed.frames):
            pose = placed.poses[:, number]
            found.setdefault(frame, pose)
            aligned = found[f"{frame}_world_aligned"] = pose.copy()
            aligned[:, 3:] = _NO_TURN
        return found

    def _arrows(
        self,
        times: npt.NDArray[np.int64],
        rows: npt.NDArray[np.intp],
        placed: _Placed,
        columns: Mapping[str, Array],
        names: _Names,
    ) -> list[bytes]:
        drawn = [(name, placed.frames.index(frame)) for name, frame in names.forces if frame in placed.frames]
        if not drawn:
            return []
        seen = [arrow_points(placed.poses[:, at, :3], columns[name][rows, :3]) for name, at in drawn]
        markers = [arrow(placed.frames[at], number) for number, (_, at) in enumerate(drawn)]
        shown, points = (np.stack(part, axis=1) for part in zip(*seen, strict=True))
        return moving_markers(times, markers, shown, points)


@dataclass(frozen=True)
class _Placed:
    """Where bodies and frames are, at k times."""

    bodies: Array
    """(k, moving bodies, 7) position in m and quaternion (w, x, y, z)"""
    frames: list[str]
    poses: Array
    """(k, frames, 7)"""


@dataclass(frozen=True)
class _Names:
    """Channels of a block, by their meaning."""

    frames: list[str]
    """of which a wrench or a place is given"""
    forces: list[tuple[str, str]]
    """channel and frame of each true wrench"""
    places: list[tuple[str, tuple[str, str]]]
    """channel, signal and frame of each place, wanted or true"""
    objects: list[tuple[str, str]]
    """channel and name of each thing that can move"""

    @classmethod
    def of(cls, columns: Mapping[str, Array]) -> _Names:
        parts = {name: name.split("/") for name in columns}
        given = {name: part for name, part in parts.items() if len(part) == 3}
        return cls(
            sorted({part[1] for part in given.values() if part[2] in ("wrench", "position")}),
            [(name, part[1]) for name, part in given.items() if part[0] == "truth" and part[2] == "wrench"],
            [
                (name, (part[0], part[1]))
                for name, part in given.items()
                if part[0] in _COLOURS and part[2] == "position" and columns[name].shape[1:] == (3,)
            ],
            [(name, part[2]) for name, part in parts.items() if part[:2] == ["truth", "objects"]],
        )


def _moves(model: mujoco.MjModel, body: int) -> bool:
    """Whether a body or one that it is fixed to has a joint."""
    while body > 0:
        if int(model.body_dofnum[body]) > 0:
            return True
        body = int(model.body_parentid[body])
    return False
