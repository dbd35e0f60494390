"""Pushes on any frame of the robot."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Push:
    """A constant force on a frame's origin for a limited time."""

    frame: str
    force: tuple[float, float, float]
    """N, world axes"""
    start: float
    """s"""
    duration: float
    """s"""

    def at(self, time: float) -> bool:
        """Whether it acts at a time in s."""
        return self.start <= time < self.start + self.duration
