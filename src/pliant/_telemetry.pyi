"""Typed face of the rows of a log (cpp/telemetry): a tick as numbers, a block of ticks as bytes of messages.

A path leads from a tick to a value: the name of an attribute, the number of an item, a tuple of the key of a mapping.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from pliant.spatial import Array

class Row:
    """Which numbers of a tick stand where in a row, and what a tick must be like to have that row."""

    def __init__(self, flat: type) -> None:
        """A row without numbers, of any tick. Args: flat: the class of mappings whose numbers lie in one array."""

    def mapping(self, path: tuple[Any, ...], keys: tuple[str, ...]) -> None:
        """A mapping that has these keys in this order. Before what stands at its keys."""

    def items(self, path: tuple[Any, ...], count: int) -> None:
        """A tuple of so many items. Before what stands in them."""

    def none(self, path: tuple[Any, ...]) -> None:
        """A place that is None."""

    def text(self, path: tuple[Any, ...], said: str) -> None:
        """A place with this text."""

    def array(self, path: tuple[Any, ...], offset: int, size: int) -> None:
        """An array of `size` numbers, from entry `offset` of the row on."""

    def number(self, path: tuple[Any, ...], offset: int) -> None:
        """A number."""

    @property
    def width(self) -> int:
        """Numbers in a row."""

    def fill(self, tick: Any, rows: Array, index: int) -> int:
        """Copies a tick into a row.

        Args:
            tick: a `pliant.signals.Tick`.
            rows: (k, width).
            index: of the row.

        Returns:
            -1; or, where the tick has another row, the offset of the numbers that do not fit, `width` if it is
            something else, and the row is undefined.

        Raises:
            ValueError: there is no such row.
        """

def pack(
    template: bytes,
    records: Sequence[tuple[int, int, int]],
    columns: Sequence[tuple[Array, Sequence[int]]],
    times: npt.NDArray[np.int64],
    out: npt.NDArray[np.uint8],
) -> None:
    """Writes the message records of a block of ticks, a row of bytes per tick.

    Args:
        template: a row (width,) without its numbers.
        records: of each message where it begins in a row, the number of the first one, where its stamp begins (-1: it
            has none).
        columns: (n, k) numbers of a channel, and the byte of a row at which each of them goes.
        times: (n,) ns.
        out: (n, width).

    Raises:
        ValueError: sizes that do not fit, or a place beyond a row.
    """
