"""The ROS 2 message types of a log, and templates of their binary form (CDR).

The numbers of one topic sit at the same bytes in every message. So mcap-ros2-support encodes one message with markers
in it, and a whole block of messages is made by writing columns of numbers where the markers are.
"""

from __future__ import annotations

import io
import itertools
import math
import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import mcap.reader
from mcap_ros2.writer import Writer

_HEADER = "std_msgs/Header header\n"
_HEADER_PARTS = {
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
}
_VECTOR = {"geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z"}
_POINT = {"geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z"}
_LINEAR_ANGULAR = "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular"


def define(main: str, *parts: Mapping[str, str]) -> str:
    """A definition with those that it needs, as MCAP files carry it. Args: parts: type → its fields."""
    text = main
    for part in parts:
        for name, body in part.items():
            text += f"\n{'=' * 80}\nMSG: {name}\n{body}"
    return text


DEFINITIONS: Mapping[str, str] = {
    "std_msgs/msg/Float64": "float64 data",
    "std_msgs/msg/String": "string data",
    "std_msgs/msg/Float64MultiArray": define(
        "std_msgs/MultiArrayLayout layout\nfloat64[] data",
        {
            "std_msgs/MultiArrayLayout": "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset",
            "std_msgs/MultiArrayDimension": "string label\nuint32 size\nuint32 stride",
        },
    ),
    "sensor_msgs/msg/JointState": define(
        _HEADER + "string[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort", _HEADER_PARTS
    ),
    "geometry_msgs/msg/PointStamped": define(_HEADER + "geometry_msgs/Point point", _HEADER_PARTS, _POINT),
    "geometry_msgs/msg/PoseStamped": define(
        _HEADER + "geometry_msgs/Pose pose",
        _HEADER_PARTS,
        {
            "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation",
            "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
        },
        _POINT,
    ),
    "geometry_msgs/msg/TwistStamped": define(
        _HEADER + "geometry_msgs/Twist twist", _HEADER_PARTS, {"geometry_msgs/Twist": _LINEAR_ANGULAR}, _VECTOR
    ),
    "geometry_msgs/msg/AccelStamped": define(
        _HEADER + "geometry_msgs/Accel accel", _HEADER_PARTS, {"geometry_msgs/Accel": _LINEAR_ANGULAR}, _VECTOR
    ),
    "geometry_msgs/msg/WrenchStamped": define(
        _HEADER + "geometry_msgs/Wrench wrench",
        _HEADER_PARTS,
        {"geometry_msgs/Wrench": "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque"},
        _VECTOR,
    ),
}
"""ROS 2 type → its definition with the definitions that it needs, in the concatenated form that MCAP files carry"""

_SECONDS, _NANOSECONDS = 0x5EC0FFEE, 0x7A0BEEF5
_MARK = 0x7B5A3C1E_00000000  # bits of a finite double; the low half counts the numbers of a message


@dataclass(frozen=True, slots=True)
class Template:
    """One encoded message and where its numbers are."""

    data: bytes
    offsets: tuple[int, ...]
    """byte at which each number (float64, little endian) starts, in the order of the message's numbers"""
    stamp: int | None
    """byte at which the stamp (int32 s, uint32 ns) starts; None for a type without a header"""


def encode(datatype: str, message: Mapping[str, Any]) -> bytes:
    """One message in CDR, by mcap-ros2-support."""
    buffer = io.BytesIO()
    writer = Writer(buffer)
    schema = writer.register_msgdef(datatype, DEFINITIONS[datatype])
    writer.write_message("/t", schema, message, log_time=0)
    writer.finish()
    for _, _, found in mcap.reader.make_reader(io.BytesIO(buffer.getvalue())).iter_messages():
        return found.data
    raise AssertionError("an MCAP file with one message gave none back")


@lru_cache(maxsize=1024)  # the library takes half a millisecond per topic; runs of one study have the same ones
def template(datatype: str, sizes: tuple[int, ...], frame_id: str = "", names: tuple[str, ...] = ()) -> Template:
    """The template of a topic.

    Args:
        datatype: key of `DEFINITIONS`.
        sizes: what a message holds. JointState: entries of position, velocity, effort (0 for none); Float64MultiArray:
            its shape; not used for types of a fixed size.
        frame_id: of the header.
        names: of the joints of a JointState, of the entries of an array.
    """
    marked = message(datatype, _marks(), sizes, frame_id, names, (_SECONDS, _NANOSECONDS))
    data = encode(datatype, marked)
    offsets: list[int] = []
    while (at := data.find(struct.pack("<Q", _MARK + len(offsets)), offsets[-1] + 8 if offsets else 0)) >= 0:
        offsets.append(at)
    stamp = data.find(struct.pack("<iI", _SECONDS, _NANOSECONDS))
    return Template(data, tuple(offsets), stamp if stamp >= 0 else None)


def _marks() -> Iterator[float]:
    return (struct.unpack("<d", struct.pack("<Q", _MARK + k))[0] for k in itertools.count())


def message(
    datatype: str,
    numbers: Iterable[float],
    sizes: Sequence[int] = (),
    frame_id: str = "",
    names: Sequence[str] = (),
    stamp: tuple[int, int] = (0, 0),
) -> dict[str, Any]:
    """A message of one of the types here as nested dictionaries, filled with numbers in the order of its fields."""
    header = {"stamp": {"sec": stamp[0], "nanosec": stamp[1]}, "frame_id": frame_id}
    it = iter(numbers)

    def take(*fields: str) -> dict[str, float]:
        return {name: next(it) for name in fields}

    match datatype.rsplit("/", 1)[-1]:
        case "Float64":
            return take("data")
        case "Float64MultiArray":
            return {"layout": _layout(sizes, names), "data": [next(it) for _ in range(math.prod(sizes))]}
        case "JointState":
            position, velocity, effort = ([next(it) for _ in range(size)] for size in sizes)
            return {"header": header, "name": list(names), "position": position, "velocity": velocity, "effort": effort}
        case "PointStamped":
            return {"header": header, "point": take("x", "y", "z")}
        case "PoseStamped":
            pose = {"position": take("x", "y", "z"), "orientation": take("x", "y", "z", "w")}
            return {"header": header, "pose": pose}
        case "TwistStamped" | "AccelStamped" as kind:
            spatial = {"linear": take("x", "y", "z"), "angular": take("x", "y", "z")}
            return {"header": header, kind.removesuffix("Stamped").lower(): spatial}
        case "WrenchStamped":
            return {"header": header, "wrench": {"force": take("x", "y", "z"), "torque": take("x", "y", "z")}}
        case other:
            raise AssertionError(f"no message of type {other}")


def _layout(shape: Sequence[int], names: Sequence[str]) -> dict[str, Any]:
    dims: list[dict[str, Any]] = []
    for axis, size in enumerate(shape):
        label = ",".join(names) if len(shape) == 1 else f"axis{axis}"
        dims.append({"label": label, "size": size, "stride": math.prod(shape[axis:])})
    return {"dim": dims, "data_offset": 0}
