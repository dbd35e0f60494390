"""How the channels of a log become ROS 2 topics, and in which byte of which message each number sits."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pliant.spatial import Array, quaternions
from pliant.telemetry.channels import Channel
from pliant.telemetry.mcap.messages import Template, template

PREFIX = "/pliant"
FIELDS = "pliant_fields"
"""key of an MCAP channel's metadata: JSON, pliant channel → unit, shape, labels, byte offsets"""

_JOINT_FIELDS = {"q": 0, "posture": 0, "v": 1, "torque": 2}
_STAMPED = {
    "wrench": "WrenchStamped",
    "velocity": "TwistStamped",
    "acceleration": "AccelStamped",
    "position": "PointStamped",
}
_ROS_QUATERNION = (1, 2, 3, 0)  # (w, x, y, z) as pliant has it → (x, y, z, w) as ROS has it


@dataclass(frozen=True, slots=True)
class Topic:
    """One topic: its type, a message with markers, and which entries of which channels its numbers are."""

    name: str
    datatype: str
    template: Template
    parts: tuple[tuple[Channel, tuple[int, ...]], ...]
    """channel, and the entries of it in the order in which the message has them; one part after the other"""

    def metadata(self) -> dict[str, str]:
        """Text for the MCAP channel record: units for people, offsets for `Log`."""
        fields: dict[str, object] = {}
        start = 0
        for channel, order in self.parts:
            offsets = [0] * channel.size
            for slot, entry in enumerate(order):
                offsets[entry] = self.template.offsets[start + slot]
            start += len(order)
            fields[channel.name] = {
                "unit": channel.unit,
                "shape": list(channel.shape),
                "labels": list(channel.labels),
                "offsets": offsets,
            }
        units = "; ".join(f"{channel.name}: {channel.unit or 'not registered'}" for channel, _ in self.parts)
        return {"units": units, FIELDS: json.dumps(fields, ensure_ascii=False)}


def logged(channels: Iterable[Channel]) -> list[Channel]:
    """The channels as a log holds them: rotation matrices become quaternions (w, x, y, z)."""
    found: list[Channel] = []
    for channel in channels:
        if is_rotation(channel):
            name = channel.name.removesuffix("rotation") + "quaternion"
            channel = Channel(name, "1", (4,), ("w", "x", "y", "z"))
        found.append(channel)
    return found


def is_rotation(channel: Channel) -> bool:
    """Whether a channel is a rotation matrix."""
    return channel.shape == (3, 3) and channel.name.endswith("/rotation")


def topics(channels: Sequence[Channel]) -> list[Topic]:
    """The topics of a set of logged channels, in a fixed order."""
    left = {channel.name: channel for channel in channels}
    found: list[Topic] = []
    for signal in ("measurement", "estimate", "reference", "command", "truth"):
        found += _joint_states(signal, left)
    for name in [name for name in left if name.endswith(("/position", "/pose"))]:
        found += _pose(name, left)
    for channel in left.values():
        found.append(_single(channel))
    return found


def topic_name(channel: str) -> str:
    """A channel's name as ROS 2 allows it: letters, digits and underscores between slashes, no part starts with a
    digit."""
    parts = [re.sub(r"[^A-Za-z0-9_]", "_", part) or "_" for part in channel.strip("/").split("/")]
    return "/".join([PREFIX, *(f"_{part}" if part[0].isdigit() else part for part in parts)])


def _joint_states(signal: str, left: dict[str, Channel]) -> list[Topic]:
    chosen: list[Channel | None] = [None, None, None]
    for field, slot in _JOINT_FIELDS.items():
        if f"{signal}/{field}" in left:
            chosen[slot] = left.pop(f"{signal}/{field}")
    given = [channel for channel in chosen if channel is not None]
    if not given:
        return []
    sizes = tuple(0 if channel is None else channel.size for channel in chosen)
    datatype = "sensor_msgs/msg/JointState"
    made = template(datatype, sizes, names=given[0].labels)
    return [Topic(f"{PREFIX}/{signal}/joint_states", datatype, made, tuple((c, _in_order(c)) for c in given))]


def _pose(name: str, left: dict[str, Channel]) -> list[Topic]:
    base, _, kind = name.rpartition("/")
    datatype = "geometry_msgs/msg/PoseStamped"
    if kind == "pose" and left[name].shape == (7,):
        order = (0, 1, 2, *(3 + entry for entry in _ROS_QUATERNION))
        parts: tuple[tuple[Channel, tuple[int, ...]], ...] = ((left.pop(name), order),)
    elif kind == "position" and f"{base}/quaternion" in left and left[name].shape == (3,):
        parts = ((left.pop(name), (0, 1, 2)), (left.pop(f"{base}/quaternion"), _ROS_QUATERNION))
    else:
        return []
    return [Topic(topic_name(f"{base}/pose"), datatype, template(datatype, (), "world"), parts)]


def _single(channel: Channel) -> Topic:
    kind = channel.name.rsplit("/", 1)[-1]
    size = {"position": 3}.get(kind, 6)
    if not channel.shape:
        datatype, made = "std_msgs/msg/Float64", template("std_msgs/msg/Float64", ())
    elif kind in _STAMPED and channel.shape == (size,):
        datatype = f"geometry_msgs/msg/{_STAMPED[kind]}"
        made = template(datatype, (), _frame_id(channel.name))
    else:
        datatype = "std_msgs/msg/Float64MultiArray"
        made = template(datatype, channel.shape, names=channel.labels)
    return Topic(topic_name(channel.name), datatype, made, ((channel, _in_order(channel)),))


def _frame_id(channel: str) -> str:
    """A sensor's wrench is in its frame's own axes; every other one is taken at the frame's origin in world axes."""
    parts = channel.split("/")
    if parts[-1] == "position" or len(parts) < 2:
        return "world"
    return parts[-2] if parts[0] == "measurement" else f"{parts[-2]}_world_aligned"


def _in_order(channel: Channel) -> tuple[int, ...]:
    return tuple(range(channel.size))


def upper_quaternions(rotations: Array) -> Array:
    """Unit quaternions of rotation matrices.

    Args:
        rotations: (n, 3, 3).

    Returns:
        (n, 4) as (w, x, y, z) with w ≥ 0.
    """
    q = quaternions(rotations)
    return q * np.where(q[:, :1] < 0.0, -1.0, 1.0)


def units_of(found: Sequence[Topic]) -> Mapping[str, str]:
    """Topic → units of its channels, as text."""
    return {topic.name: topic.metadata()["units"] for topic in found}
