"""Frames and shapes as ROS 2 messages that the 3-D views of Foxglove and RViz draw: TFMessage and MarkerArray."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
import numpy.typing as npt

from pliant.spatial import Array
from pliant.telemetry.mcap.cdr import CdrBuffer
from pliant.telemetry.mcap.messages import define

TRANSFORMS = "tf2_msgs/msg/TFMessage"
MARKERS = "visualization_msgs/msg/MarkerArray"

_TIME = {"builtin_interfaces/Time": "int32 sec\nuint32 nanosec"}
_HEADER = {"std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id"}
_GEOMETRY = {
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
}
_MARKER = """std_msgs/Header header
string ns
int32 id
int32 type
int32 action
geometry_msgs/Pose pose
geometry_msgs/Vector3 scale
std_msgs/ColorRGBA color
builtin_interfaces/Duration lifetime
bool frame_locked
geometry_msgs/Point[] points
std_msgs/ColorRGBA[] colors
string texture_resource
sensor_msgs/CompressedImage texture
visualization_msgs/UVCoordinate[] uv_coordinates
string text
string mesh_resource
visualization_msgs/MeshFile mesh_file
bool mesh_use_embedded_materials"""

SCENE_DEFINITIONS: Mapping[str, str] = {
    TRANSFORMS: define(
        "geometry_msgs/TransformStamped[] transforms",
        {
            "geometry_msgs/TransformStamped": "std_msgs/Header header\nstring child_frame_id\n"
            "geometry_msgs/Transform transform",
            "geometry_msgs/Transform": "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation",
        },
        _HEADER,
        _TIME,
        _GEOMETRY,
    ),
    MARKERS: define(
        "visualization_msgs/Marker[] markers",
        {
            "visualization_msgs/Marker": _MARKER,
            "visualization_msgs/MeshFile": "string filename\nuint8[] data",
            "visualization_msgs/UVCoordinate": "float32 u\nfloat32 v",
            "sensor_msgs/CompressedImage": "std_msgs/Header header\nstring format\nuint8[] data",
            "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation",
            "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z",
            "std_msgs/ColorRGBA": "float32 r\nfloat32 g\nfloat32 b\nfloat32 a",
            "builtin_interfaces/Duration": "int32 sec\nuint32 nanosec",
        },
        _HEADER,
        _TIME,
        _GEOMETRY,
    ),
}
"""ROS 2 type → its definition with those that it needs"""

Array64 = npt.NDArray[np.int64]
MarkerKind = Literal["arrow", "cube", "sphere", "cylinder", "line", "triangles"]
_KINDS: Mapping[MarkerKind, int] = {"arrow": 0, "cube": 1, "sphere": 2, "cylinder": 3, "line": 4, "triangles": 11}
_ADD, _DELETE = 0, 2
_STAMP = 8  # bytes
_NO_POINTS = np.empty((0, 3))


@dataclass(frozen=True, slots=True)
class Marker:
    """One shape. It moves with its frame."""

    frame: str
    group: str
    number: int
    """tells the markers of a group apart"""
    kind: MarkerKind
    scale: tuple[float, float, float]
    """m: full edges or diameters; of a line its width; of an arrow the diameters of shaft and head; of triangles 1"""
    rgba: tuple[float, float, float, float]
    position: Sequence[float] | Array = (0.0, 0.0, 0.0)
    """m, in the frame's axes"""
    quaternion: Sequence[float] | Array = (1.0, 0.0, 0.0, 0.0)
    """w, x, y, z"""
    points: Array | None = None
    """(n, 3) m: corners of a line, three for each triangle, or start and end of an arrow"""
    shown: bool = True
    """False: takes the marker of that group and number away"""


def transforms(times: Array64, frames: Sequence[str], poses: Array) -> list[bytes]:
    """TFMessages of the same frames.

    Args:
        times: (k,) ns.
        frames: f names.
        poses: (k, f, 7) positions in m and quaternions (w, x, y, z) in the world.
    """
    shape = _transforms_of(tuple(frames))
    return shape.filled(times, [poses[:, frame, [0, 1, 2, 4, 5, 6, 3]] for frame in range(len(frames))])


def moving_markers(times: Array64, markers: Sequence[Marker], shown: Array, points: Array) -> list[bytes]:
    """MarkerArrays of markers that differ in their points alone, and in whether they are shown.

    Args:
        times: (k,) ns.
        markers: m, as at one of the times.
        shown: (k, m) whether.
        points: (k, m, p, 3) m, as many as the markers have.
    """
    buffer, stamps = CdrBuffer(), list[int]()
    buffer.put("I", len(markers))
    actions, corners = list[int](), list[int]()
    for marker in markers:
        places = _put_marker(buffer, 0, marker)
        for found, place in zip((stamps, actions, corners), places, strict=True):
            found.append(place)
    shape = _Shape(buffer.finished(), tuple(stamps), tuple(corners))
    action = np.where(shown, _ADD, _DELETE).astype("<i4")
    more = [(at, action[:, number]) for number, at in enumerate(actions)]
    return shape.filled(times, [points[:, number].reshape(len(times), -1) for number in range(len(markers))], more)


@dataclass(frozen=True, slots=True)
class _Shape:
    """A message whose stamps and numbers change."""

    template: bytes
    stamps: tuple[int, ...]
    """bytes at which stamps begin"""
    numbers: tuple[int, ...]
    """bytes at which groups of float64 begin"""

    def filled(
        self,
        times: Array64,
        groups: Sequence[Array],
        more: Sequence[tuple[int, npt.NDArray[np.int32]]] = (),
    ) -> list[bytes]:
        """Messages at times (k,) ns. Args: groups: (k, numbers) of each group; more: byte and integers (k,)."""
        rows = np.tile(np.frombuffer(self.template, dtype=np.uint8), (len(times), 1))
        stamp = np.stack(np.divmod(times, 1_000_000_000), axis=1).astype("<u4")
        fields = [*((at, stamp) for at in self.stamps), *((at, values[:, None]) for at, values in more)]
        for at, values in (*fields, *zip(self.numbers, groups, strict=True)):
            data = np.ascontiguousarray(values).view(np.uint8)
            rows[:, at : at + data.shape[1]] = data
        return [row.tobytes() for row in rows]


@lru_cache(maxsize=16)
def _transforms_of(frames: tuple[str, ...]) -> _Shape:
    buffer, stamps, numbers = CdrBuffer(), list[int](), list[int]()
    buffer.put("I", len(frames))
    for frame in frames:
        buffer.stamp(0)
        stamps.append(buffer.size - _STAMP)
        buffer.text("world")
        buffer.text(frame)
        buffer.doubles(np.zeros(7))
        numbers.append(buffer.size - 7 * 8)
    return _Shape(buffer.finished(), tuple(stamps), tuple(numbers))


def marker_array(time: int, markers: Sequence[Marker]) -> bytes:
    """A MarkerArray. Args: time: ns; markers: any, each with its frame."""
    buffer = CdrBuffer()
    buffer.put("I", len(markers))
    for marker in markers:
        _put_marker(buffer, time, marker)
    return buffer.finished()


def _put_marker(buffer: CdrBuffer, time: int, marker: Marker) -> tuple[int, int, int]:
    """Returns at which bytes its stamp, what is done with it, and its points begin."""
    w, x, y, z = marker.quaternion
    buffer.stamp(time)
    stamp = buffer.size - _STAMP
    buffer.text(marker.frame)
    buffer.text(marker.group)
    buffer.put("i", marker.number, _KINDS[marker.kind], _ADD if marker.shown else _DELETE)
    action = buffer.size - 4
    buffer.doubles([*marker.position, x, y, z, w, *marker.scale])
    buffer.put("f", *marker.rgba)
    buffer.stamp(0)  # stays
    buffer.put("?", True)  # moves with its frame
    points = _NO_POINTS if marker.points is None else marker.points
    buffer.points(points)
    corners = buffer.size - 8 * points.size
    buffer.put("I", 0)  # colours of the points
    buffer.text("")  # texture: file, header, format, bytes
    buffer.stamp(0)
    buffer.text("")
    buffer.text("")
    buffer.put("I", 0)
    buffer.put("I", 0)  # places on the texture
    buffer.text("")  # text
    buffer.text("")  # mesh: file, name, bytes
    buffer.text("")
    buffer.put("I", 0)
    buffer.put("?", False)
    return stamp, action, corners
