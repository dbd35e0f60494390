"""Frames, shapes, paths and forces of a run as topics of its log, for the 3-D views of Foxglove and RViz."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import mujoco
import numpy as np
import numpy.typing as npt

from pliant.spatial import Array
from pliant.telemetry.mcap.scene_messages import MARKERS, TRANSFORMS, Marker, marker_array, transforms
from pliant.telemetry.mcap.topics import PREFIX
from pliant.telemetry.mcap.writer import McapFile
from pliant.telemetry.scene_markers import arrow, line, markers_of
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

    points: list[Array] = field(default_factory=list)

    def add(self, place: Array) -> None:
        if np.isfinite(place).all() and (
            not self.points or float(np.linalg.norm(place - self.points[-1])) >= _LEAST_STEP
        ):
            self.points.append(np.array(place))


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
        names = _Names.of(columns)
        frames: list[tuple[int, bytes]] = []
        forces: list[tuple[int, bytes]] = []
        for row in self._chosen(times):
            time = int(times[row])
            poses = self._poses(joints[row], row, columns, names)
            frames.append((time, transforms(time, poses)))
            if arrows := self._arrows(row, columns, names):
                forces.append((time, marker_array(time, arrows)))
            for name, key in names.places:
                self._paths.setdefault(key, _Path()).add(columns[name][row])
        self._file.add_messages("/tf", TRANSFORMS, frames)
        self._file.add_messages(f"{PREFIX}/force", MARKERS, forces)

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

    def _poses(self, q: Array, row: int, columns: Mapping[str, Array], names: _Names) -> dict[str, tuple[Array, Array]]:
        objects = {name: columns[channel][row] for channel, name in names.objects}
        positions, quaternions = self._poser.bodies(q, objects)
        found = {self._names[body]: (positions[body], quaternions[body]) for body in self._moving}
        for frame in names.frames:
            if (place := self._poser.placement(frame)) is not None:
                found.setdefault(frame, place)
                found[f"{frame}_world_aligned"] = place[0], _NO_TURN
        return found

    def _arrows(self, row: int, columns: Mapping[str, Array], names: _Names) -> list[Marker]:
        found: list[Marker] = []
        for name, frame in names.forces:
            if (place := self._poser.placement(frame)) is not None:
                found.append(arrow(frame, place[0], columns[name][row][:3], len(found)))
        return found


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
