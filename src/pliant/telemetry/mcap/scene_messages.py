"""Frames and shapes as ROS 2 messages that the 3-D views of Foxglove and RViz draw: TFMessage and MarkerArray."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

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

MarkerKind = Literal["arrow", "cube", "sphere", "cylinder", "line", "triangles"]
_KINDS: Mapping[MarkerKind, int] = {"arrow": 0, "cube": 1, "sphere": 2, "cylinder": 3, "line": 4, "triangles": 11}
_ADD, _DELETE = 0, 2
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


def transforms(time: int, poses: Mapping[str, tuple[Array, Array]]) -> bytes:
    """A TFMessage. Args: time: ns; poses: frame → position (3,) in m and quaternion (w, x, y, z) in the world."""
    buffer = CdrBuffer()
    buffer.put("I", len(poses))
    for frame, (position, (w, x, y, z)) in poses.items():
        buffer.stamp(time)
        buffer.text("world")
        buffer.text(frame)
        buffer.doubles([*position, x, y, z, w])
    return buffer.finished()


def marker_array(time: int, markers: Sequence[Marker]) -> bytes:
    """A MarkerArray. Args: time: ns; markers: any, each with its frame."""
    buffer = CdrBuffer()
    buffer.put("I", len(markers))
    for marker in markers:
        _put_marker(buffer, time, marker)
    return buffer.finished()


def _put_marker(buffer: CdrBuffer, time: int, marker: Marker) -> None:
    w, x, y, z = marker.quaternion
    buffer.stamp(time)
    buffer.text(marker.frame)
    buffer.text(marker.group)
    buffer.put("i", marker.number, _KINDS[marker.kind], _ADD if marker.shown else _DELETE)
    buffer.doubles([*marker.position, x, y, z, w, *marker.scale])
    buffer.put("f", *marker.rgba)
    buffer.stamp(0)  # stays
    buffer.put("?", True)  # moves with its frame
    buffer.points(_NO_POINTS if marker.points is None else marker.points)
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
