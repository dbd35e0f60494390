"""Message records of a block of ticks, packed by compiled code, against the same with NumPy and struct."""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pytest

from pliant._telemetry import pack
from pliant.spatial import Array
from pliant.telemetry.channels import Channel
from pliant.telemetry.mcap.messages import template
from pliant.telemetry.mcap.rows import INDEX, MESSAGE, RowPlan, index_records
from pliant.telemetry.mcap.topics import Topic, topics

TICKS = 5
CHANNELS = [
    Channel("measurement/q", "rad", (2,), ("a", "b")),
    Channel("truth/tool/position", "m", (3,), ("x", "y", "z")),
    Channel("truth/tool/quaternion", "1", (4,), ("w", "x", "y", "z")),
    Channel("some/number", "1", (), ()),
    Channel("some/table", "1", (2, 3), ()),
]


def in_python(
    topics: Sequence[Topic], ids: Sequence[int], firsts: Sequence[int], times: npt.NDArray[np.int64], columns: dict
) -> bytes:
    """Record by record, number by number."""
    data = bytearray()
    for tick, time in enumerate(times.tolist()):
        for topic, channel, first in zip(topics, ids, firsts, strict=True):
            body = bytearray(topic.template.data)
            if topic.template.stamp is not None:
                struct.pack_into("<iI", body, topic.template.stamp, *divmod(time, 1_000_000_000))
            numbers = [columns[part.name][tick].ravel()[entry] for part, order in topic.parts for entry in order]
            for offset, number in zip(topic.template.offsets, numbers, strict=True):
                struct.pack_into("<d", body, offset, number)
            data += MESSAGE.pack(5, 22 + len(body), channel, first + tick, time, time) + body
    return bytes(data)


@pytest.fixture
def columns() -> dict[str, Array]:
    """Numbers of the channels: parts of wide rows, as a recorder has them."""
    rows = np.random.default_rng(5).normal(size=(TICKS, 40))
    found, at = {}, 0
    for channel in CHANNELS:
        found[channel.name] = rows[:, at : at + channel.size].reshape(TICKS, *channel.shape)
        at += channel.size + 1
    return found


def test_rows_are_the_twins(columns: dict[str, Array]) -> None:
    made = topics(CHANNELS)
    ids, firsts = list(range(3, 3 + len(made))), [7 * i for i in range(len(made))]
    times = np.array([-1_500_000_000, -1, 0, 999_999_999, 3_000_000_001])
    data = RowPlan.of(made, ids).packed(b"head", np.abs(times), firsts, columns)
    assert data == b"head" + in_python(made, ids, firsts, np.abs(times), columns)
    other = {**columns, "some/number": columns["some/number"] + 1.0}
    assert data != b"head" + in_python(made, ids, firsts, np.abs(times), other)


def test_places_are_where_the_messages_stand(columns: dict[str, Array]) -> None:
    made, times = topics(CHANNELS), np.arange(TICKS)
    ids = list(range(len(made)))
    plan = RowPlan.of(made, ids)
    data = bytes(plan.packed(b"head", times, ids, columns))
    index, begins = index_records(ids, plan.begins, times, len(plan.template), 4)
    places = plan.places(ids, TICKS, 4)
    for (channel, place), topic, begin in zip(places, made, begins, strict=True):
        assert place.times(data).tolist() == times.tolist()
        assert [place.time(data, number) for number in (0, 2, -1)] == times[[0, 2, -1]].tolist()
        assert place.length == len(topic.template.data) == place.messages(data).shape[1]
        opcode, length, stated, size = INDEX.unpack_from(index, begin)
        assert (opcode, length, stated, size) == (7, 4 + 2 + 16 * TICKS, channel, 16 * TICKS)
        entries = np.frombuffer(index, "<u8", 2 * TICKS, begin + INDEX.size).reshape(TICKS, 2)
        assert entries[:, 0].tolist() == times.tolist()
        for tick, at in enumerate(entries[:, 1].tolist()):
            assert MESSAGE.unpack_from(data, at)[:5] == (5, 22 + place.length, channel, channel + tick, tick)


def test_a_stamp_before_zero_counts_up_to_its_second() -> None:
    made = template("geometry_msgs/msg/PointStamped", (), "world")
    row = MESSAGE.pack(5, 22 + len(made.data), 1, 0, 0, 0) + made.data
    out = np.empty((1, len(row)), dtype=np.uint8)
    assert made.stamp is not None
    pack(row, [(0, 0, MESSAGE.size + made.stamp)], [], np.array([-1_500_000_000]), out)
    assert struct.unpack_from("<iI", out.tobytes(), MESSAGE.size + made.stamp) == (-2, 500_000_000)


@pytest.mark.parametrize(
    ("records", "places"),
    [([(10, 0, -1)], [0]), ([(-1, 0, -1)], [0]), ([(0, 0, 33)], [0]), ([(0, 0, -1)], [33]), ([(0, 0, -1)], [-8])],
)
def test_what_lies_beyond_a_row_is_refused(records: list[tuple[int, int, int]], places: list[int]) -> None:
    out, times = np.empty((2, 40), dtype=np.uint8), np.arange(2)
    pack(bytes(40), [(0, 0, 32)], [(np.zeros((2, 1)), [32])], times, out)
    with pytest.raises(ValueError, match="beyond the row"):
        pack(bytes(40), records, [(np.zeros((2, 1)), places)], times, out)
    for other in (np.empty((1, 40), dtype=np.uint8), np.empty((2, 41), dtype=np.uint8)):
        with pytest.raises(ValueError, match="a row of the template's width"):
            pack(bytes(40), [], [], times, other)
