"""Channels: names, units, shapes and labels of the numbers in a log, and where each one stands in a tick."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple


@dataclass(frozen=True, slots=True)
class Channel:
    """One quantity of a log. In a table of units the name may be a pattern (`*/energy_*`) and the shape is not looked
    at."""

    name: str
    unit: str = ""
    """SI; where linear and angular parts share a vector: both, with a comma. Empty: not registered"""
    shape: tuple[int, ...] = ()
    """of one sample; () for a scalar"""
    labels: tuple[str, ...] = ()
    """names of the entries of a vector"""

    @property
    def size(self) -> int:
        """Numbers per sample."""
        return math.prod(self.shape)


class Key(NamedTuple):
    """A step to the value of a mapping."""

    name: str


Path = tuple[str | int | Key, ...]
"""steps from a tick to a value: the name of an attribute, the number of an item, the key of a mapping"""


@dataclass(frozen=True, slots=True)
class PlacedChannel:
    """A channel and where it stands in a tick."""

    path: Path
    channel: Channel
