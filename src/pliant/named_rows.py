"""Values of one shape that stand one after the other in an array, by name."""

from __future__ import annotations

from collections.abc import Sequence
from math import prod

from pliant._values import NamedViews


class NamedRows:
    """Where they stand.

    Args:
        names: of the values.
        begin: where the first one begins.
        shape: of each.
    """

    __slots__ = ("end", "of")

    def __init__(self, names: Sequence[str], begin: int, *shape: int) -> None:
        size = prod(shape)
        self.of = NamedViews(names, [(begin + i * size, *shape) for i in range(len(names))]).of
        """array → name → view of its numbers"""
        self.end = begin + len(names) * size
        """where the last one ends"""
