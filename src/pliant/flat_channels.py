"""Channels of a tick whose numbers lie in one array, one after the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from pliant.errors import ShapeError
from pliant.spatial import Array


class FlatLayout:
    """Which numbers of an array are which channel's. A log copies the whole array where it has seen this layout before:
    make it once, not in every tick.

    Args:
        places: channel → its numbers, or the one number of a scalar, in the order of the array.

    Raises:
        ShapeError: they are in another order.
    """

    __slots__ = ("places", "size")

    def __init__(self, places: Mapping[str, int | slice]) -> None:
        self.places = dict(places)
        self.size = 0
        """numbers in the array"""
        for name, place in self.places.items():
            begin, end = (place, place + 1) if isinstance(place, int) else (int(place.start), int(place.stop))
            if begin < self.size:
                raise ShapeError(f"channel {name!r} begins at {begin}, within or before the channel that precedes it")
            self.size = end

    def followed_by(self, scalars: Sequence[str]) -> FlatLayout:
        """This layout with more scalars at the end."""
        return FlatLayout({**self.places, **{name: self.size + i for i, name in enumerate(scalars)}})


class FlatChannels(Mapping[str, "float | Array"]):
    """Channels of one tick, read from an array on access; to create it costs no more than a pointer.

    Args:
        layout: of the numbers.
        numbers: (size,).
    """

    __slots__ = ("layout", "numbers")

    def __init__(self, layout: FlatLayout, numbers: Array) -> None:
        self.layout = layout
        self.numbers = numbers

    def __getitem__(self, name: str) -> float | Array:
        place = self.layout.places[name]
        return self.numbers.item(place) if isinstance(place, int) else self.numbers[place]

    def __iter__(self) -> Iterator[str]:
        return iter(self.layout.places)

    def __len__(self) -> int:
        return len(self.layout.places)
