"""Channels of a log as they stand in its file: pieces of messages, and which of their bytes are the numbers."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pliant.spatial import Array
from pliant.telemetry.mcap.pieces import Piece
from pliant.telemetry.mcap.reader import Contents
from pliant.telemetry.mcap.topics import FIELDS


@dataclass(frozen=True, slots=True)
class StoredChannel:
    """Samples of one channel in the file: pieces of messages, and the bytes at which the numbers start."""

    topic: str
    unit: str
    shape: tuple[int, ...]
    labels: tuple[str, ...]
    pieces: list[tuple[Piece, Sequence[int]]]
    zero: int
    """ns of the file's clock at which that of the run is zero"""

    @property
    def count(self) -> int:
        return sum(piece.count for piece, _ in self.pieces)

    def times(self) -> Array:
        """(n,) s."""
        times, at = np.empty(self.count), 0
        for piece, _ in self.pieces:
            for chunk in piece.chunks:
                found = piece.place.times(chunk.unpacked())
                times[at : at + len(found)] = found - self.zero
                at += len(found)
        times *= 1e-9
        return times

    def ends(self) -> tuple[float, float]:
        """s: times of the first sample and the last."""
        first, last = self.pieces[0][0].ends()[0], self.pieces[-1][0].ends()[1]
        return float(first - self.zero) * 1e-9, float(last - self.zero) * 1e-9

    def values(self, begin: int, end: int) -> Array:
        """(n, …) numbers of the samples from one number to another."""
        values, base = np.empty((max(end - begin, 0), int(np.prod(self.shape)))), -begin
        for piece, offsets in self.pieces:
            first, last = max(-base, 0), min(end - begin - base, piece.count)
            for number, rows in piece.messages(first, last) if first < last else ():
                put(rows, offsets, values[base + number : base + number + len(rows)])
            base += piece.count
        return values.reshape(len(values), *self.shape)


def stored_channels(contents: Contents, begin: int) -> dict[str, StoredChannel]:
    """Args: begin: ns of the file's clock at which that of the run is zero."""
    found: dict[str, StoredChannel] = {}
    for key in sorted(contents.channels):
        channel = contents.channels[key]
        fields = json.loads(channel.metadata.get(FIELDS, "{}"))
        pieces = contents.pieces.get(key, [])
        for name, about in fields.items() if pieces else ():
            shape, offsets = tuple(about["shape"]), tuple(about["offsets"])
            if max(offsets, default=0) + 8 > min(piece.length for piece in pieces):
                raise ValueError(f"messages of {channel.topic} are shorter than {name} needs")
            if name in found and found[name].shape != shape:
                name = f"{name}[{','.join(map(str, shape))}]"  # a channel whose shape changed on the way
            new = StoredChannel(channel.topic, about["unit"], shape, tuple(about["labels"]), [], begin)
            found.setdefault(name, new).pieces.extend((piece, offsets) for piece in pieces)
    return found


def put(messages: npt.NDArray[np.uint8], offsets: Sequence[int], values: Array) -> None:
    """Copies numbers out of messages (n, bytes), from the bytes at which they start, into values (n, k)."""
    k = len(offsets)
    if k and list(offsets) == list(range(offsets[0], offsets[0] + 8 * k, 8)):  # neighbours, in one go
        values[:] = np.ascontiguousarray(messages[:, offsets[0] : offsets[0] + 8 * k]).view("<f8")
        return
    for column, offset in enumerate(offsets):
        values[:, column] = np.ascontiguousarray(messages[:, offset : offset + 8]).view("<f8")[:, 0]
