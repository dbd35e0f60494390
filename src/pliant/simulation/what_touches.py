"""Where contacts count, and which sensors feel them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pliant.simulation.force_sensor import ForceSensor


@dataclass(frozen=True)
class WhatTouches:
    """Where contacts count and who feels them."""

    frames: Mapping[int, str]
    """geom → the frame at which its contact counts"""
    sites: Mapping[str, int]
    """frame → its site"""
    sensors: tuple[ForceSensor, ...]
    felt: Mapping[ForceSensor, Sequence[str]]
    """sensor → frames whose contacts it feels"""
