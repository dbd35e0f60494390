"""Channels and groups: names, units, shapes and labels of the numbers in a log."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from pliant.signals import Tick


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


@dataclass(frozen=True, slots=True)
class ChannelGroup:
    """Channels that are extracted from a tick in one call."""

    pick: Callable[[Tick], Sequence[Any]]
    channels: tuple[Channel, ...]


@dataclass(frozen=True, slots=True)
class Groups:
    """All channels of ticks of one structure."""

    signals: tuple[ChannelGroup, ...]
    """arrays of the signals: float64 by their types"""
    arrays: tuple[ChannelGroup, ...]
    """array diagnostics: of any numeric type"""
    scalars: tuple[ChannelGroup, ...]
