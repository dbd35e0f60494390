"""The scene on the page: robot, things, ghost of the reference, forces, traces, prediction."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import Any

import numpy as np
import viser

from pliant.live.link.messages import Picture
from pliant.live.page.shapes import add_look, cone
from pliant.simulation import Part, Plane, Scene
from pliant.spatial import Array, frame_with_z_along, quaternion
from pliant.visual_shapes import Look

MEASURED, ASKED, PUSH = (194, 47, 47), (11, 111, 184), (178, 73, 162)
_TOOL, _REFERENCE, _PREDICTED = (217, 95, 14), (11, 111, 184), (20, 143, 107)
_METRES_PER_NEWTON = 4e-3
_LONGEST = 0.6  # m of an arrow
_SHORTEST = 0.01  # m; below it nothing is drawn
_TRACE = 120  # points, 4 s at 30 Hz
_TRACES_EVERY = 3  # pictures; lines are expensive for software renderers
_CONE_HEIGHT = 0.10  # m
_FORCES_SHOWN = 6  # of a prediction
_NOWHERE = np.zeros((1, 2, 3))


class SceneView:
    """Draws the scene. Each change is sent to all browsers, and the latest one counts.

    Args:
        server: the page.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        self._server, self._scene = server, server.scene
        self._bodies: list[viser.FrameHandle] = []
        self._ghosts: list[viser.FrameHandle] = []
        self._faces: tuple[Plane | Part, ...] = ()
        self._tool_trace: deque[Array] = deque(maxlen=_TRACE)
        self._target_trace: deque[Array] = deque(maxlen=_TRACE)
        self._shown: dict[str, bool] = {}
        self._drawn_at = -math.inf
        self._count = 0
        self._cone: Any = None
        self._cone_friction = -1.0
        self._scene.set_up_direction("+z")
        self._scene.world_axes.visible = False
        self._scene.configure_default_lights(cast_shadow=False)  # a shadow would triple the rendering
        self._scene.add_grid("/grid", 4.0, 4.0, cell_size=0.1, section_size=0.5, **_GRID)
        self._arrows = {
            name: self._scene.add_arrows(f"/{name}", _NOWHERE, colour, **_ARROW, visible=False)
            for name, colour in (
                ("measured", MEASURED),
                ("asked", ASKED),
                ("pushed", PUSH),
                ("predicted_force", _PREDICTED),
            )
        }
        self._lines = {
            name: self._scene.add_line_segments(f"/{name}", _NOWHERE, colour, thickness=width, visible=False)
            for name, colour, width in (
                ("tool_trace", _TOOL, 0.006),
                ("target_trace", _REFERENCE, 0.004),
                ("predicted_path", _PREDICTED, 0.006),
            )
        }
        self._target = self._scene.add_icosphere("/target_point", 0.012, color=_REFERENCE, opacity=0.8, visible=False)

    def frame_camera(self, tool: Array) -> None:
        """Places the camera on the side of the robot where there is no wall. Args: tool: (3,) m."""
        reach = np.array([tool[0], tool[1], 0.0])
        length = float(np.linalg.norm(reach))
        reach = reach / length if length > 0.05 else np.array([1.0, 0.0, 0.0])
        side = np.array([-reach[1], reach[0], 0.0])
        normals = [face.geometry.normal(tool) for face in self._faces]
        walls = [normal for normal in normals if abs(normal[2]) < 0.7]
        if sum(float(np.dot(side, normal)) for normal in walls) < 0.0 or (not walls and side[1] > 0.0):
            side = -side
        middle = 0.5 * reach * max(length, 0.2) + np.array([0.0, 0.0, 0.5 * max(float(tool[2]), 0.5)])
        eye = middle + 1.35 * side + 0.75 * reach + np.array([0.0, 0.0, 0.55])
        self._server.initial_camera.position, self._server.initial_camera.look_at = eye, middle
        for client in self._server.get_clients().values():
            client.camera.position, client.camera.look_at = eye, middle

    @property
    def faces(self) -> tuple[Plane | Part, ...]:
        """Surfaces of the scene that cannot move."""
        return self._faces

    def stage(self, looks: Sequence[Look], bodies: int, scene: Scene | None) -> None:
        """Shows the robot and the things; removes what was shown before."""
        with self._server.atomic():
            for handle in (*self._bodies, *self._ghosts):
                handle.remove()
            self._bodies = [self._scene.add_frame(f"/bodies/{i}", show_axes=False) for i in range(bodies)]
            self._ghosts = [self._scene.add_frame(f"/ghost/{i}", show_axes=False) for i in range(bodies)]
            for look in looks:
                add_look(self._scene, f"/bodies/{look.body}/{look.name}", look)
                if look.robot and look.body:
                    add_look(self._scene, f"/ghost/{look.body}/{look.name}", look, ghost=True)
        self._faces = () if scene is None else scene.faces
        self.forget()

    def forget(self) -> None:
        """Clears the traces."""
        self._tool_trace.clear()
        self._target_trace.clear()

    def draw(self, picture: Picture) -> None:
        """Shows one instant."""
        if picture.time < self._drawn_at:
            self.forget()
        self._drawn_at = picture.time
        with self._server.atomic():
            _place(self._bodies, picture.positions, picture.quaternions)
            for frame in self._ghosts:
                frame.visible = picture.ghost is not None
            if picture.ghost is not None:
                _place(self._ghosts, *picture.ghost)
            self._forces(picture)
            self._traces(picture)
            self._contact_cone(picture)

    def _forces(self, picture: Picture) -> None:
        self._point("measured", list(picture.contacts.values()))
        self._point("asked", [(picture.tool, picture.asked)])
        self._point("pushed", list(picture.pushes.values()), into=True)
        path, forces = picture.predicted_path, picture.predicted_force
        shown: list[tuple[Array, Array]] = []
        if path is not None and forces is not None:
            count = min(len(path), len(forces))
            shown = [(path[i], forces[i]) for i in range(0, count, max(1, count // _FORCES_SHOWN))]
        self._point("predicted_force", shown)

    def _point(self, name: str, forces: list[tuple[Array, Array]], into: bool = False) -> None:
        """Arrows that start at points, or end there (`into`)."""
        segments: list[Array] = []
        for at, force in forces:
            length = _METRES_PER_NEWTON * float(np.linalg.norm(force))
            if not math.isfinite(length) or length < _SHORTEST:
                continue
            arrow = force * _METRES_PER_NEWTON * min(1.0, _LONGEST / length)
            segments.append(np.array([at - arrow, at] if into else [at, at + arrow]))
        handle = self._arrows[name]
        handle.visible = bool(segments)
        if segments:
            handle.points = np.array(segments, dtype=np.float32)

    def _traces(self, picture: Picture) -> None:
        self._target.visible = picture.target is not None
        self._tool_trace.append(picture.tool)
        if picture.target is not None:
            self._target.position = picture.target
            self._target_trace.append(picture.target)
        self._count += 1
        if self._count % _TRACES_EVERY == 0:
            self._line("tool_trace", self._tool_trace)
            self._line("target_trace", self._target_trace)
        self._line("predicted_path", () if picture.predicted_path is None else picture.predicted_path)

    def _line(self, name: str, points: Sequence[Array] | Array | deque[Array]) -> None:
        handle = self._lines[name]
        handle.visible = len(points) > 1
        if len(points) > 1:
            corners = np.asarray(points, dtype=np.float32)
            handle.points = np.stack([corners[:-1], corners[1:]], axis=1)

    def _contact_cone(self, picture: Picture) -> None:
        """Friction cone where the first frame in contact touches the nearest surface."""
        touching = [at for at, force in picture.contacts.values() if np.linalg.norm(force) > 0.1]
        if not touching or not self._faces:
            if self._cone is not None:
                self._cone.visible = False
            return
        at = touching[0]
        face = min(self._faces, key=lambda each: abs(each.geometry.near(at).distance))
        if self._cone is None or self._cone_friction != face.surface.friction:
            vertices, faces = cone(_CONE_HEIGHT, _CONE_HEIGHT * face.surface.friction)
            self._cone = self._scene.add_mesh_simple(
                "/cone", vertices, faces, color=(224, 161, 0), opacity=0.35, side="double", **_NO_SHADOW
            )
            self._cone_friction = face.surface.friction
        self._cone.visible = True
        self._cone.position = at
        self._cone.wxyz = quaternion(frame_with_z_along(face.geometry.normal(at)))


_GRID: dict[str, Any] = {
    "cell_color": (228, 231, 235), "section_color": (206, 211, 217), "cell_thickness": 0.6, "section_thickness": 1.0,
    "shadow_opacity": 0.0, "position": (0.0, 0.0, -0.002), "fade_distance": 8.0, "fade_strength": 2.0,
}  # fmt: skip
_ARROW: dict[str, Any] = {"shaft_radius": 0.008, "head_radius": 0.020, "head_length": 0.045}
_NO_SHADOW: dict[str, Any] = {"cast_shadow": False, "receive_shadow": False}


def _place(frames: Sequence[viser.FrameHandle], positions: Array, quaternions: Array) -> None:
    for frame, position, wxyz in zip(frames[1:], positions[1:], quaternions[1:], strict=True):
        frame.position, frame.wxyz = position, wxyz
