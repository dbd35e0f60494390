"""Values of one size that stand one after the other in an array, by name."""

from __future__ import annotations

from collections.abc import Sequence

from pliant.spatial import Array


class NamedRows:
    """Where they stand. A slice for each, made once, takes a third of the time of an iteration over the array's rows.

    Args:
        names: of the values.
        begin: where the first one begins.
        size: numbers of each.
    """

    __slots__ = ("_places", "end")

    def __init__(self, names: Sequence[str], begin: int, size: int) -> None:
        starts = [begin + i * size for i in range(len(names))]
        self._places = tuple([(name, slice(at, at + size)) for name, at in zip(names, starts, strict=True)])
        self.end = begin + len(names) * size
        """where the last one ends"""

    def of(self, numbers: Array) -> dict[str, Array]:
        """Name → its numbers (size,), a view."""
        return {name: numbers[place] for name, place in self._places}

    def matrices(self, numbers: Array) -> dict[str, Array]:
        """Name → its nine numbers as a matrix (3, 3), a view."""
        return {name: numbers[place].reshape(3, 3) for name, place in self._places}
