"""Contact frames, and the sensors that measure their contacts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pliant.simulation.force_sensor import ForceSensor


@dataclass(frozen=True)
class WhatTouches:
    """Contact frames, and the sensors that measure their contacts."""

    frames: Mapping[int, str]
    """geom → the frame at which its contact is reported"""
    sites: Mapping[str, int]
    """frame → its site"""
    sensors: tuple[ForceSensor, ...]
    felt: Mapping[ForceSensor, Sequence[str]]
    """sensor → frames whose contacts it measures"""
