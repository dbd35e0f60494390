"""Pushes on any frame of the robot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.errors import ConfigError
from pliant.spatial import Array


@dataclass(frozen=True)
class Push:
    """A constant force on a frame's origin for a while."""

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


def random_pushes(
    rng: np.random.Generator,
    frame: str,
    until: float,
    *,
    start: float = 0.0,
    force: tuple[float, float] = (10.0, 30.0),
    duration: tuple[float, float] = (0.2, 0.6),
    gap: tuple[float, float] = (0.1, 0.4),
) -> tuple[Push, ...]:
    """Pushes in random directions, one after the other.

    Args:
        rng: source of the draws.
        frame: that is pushed.
        until: s, no push starts later.
        start: s of the first gap.
        force: N, least and most.
        duration: s, shortest and longest.
        gap: s between two pushes, shortest and longest.

    Raises:
        ConfigError: a range is reversed or negative.
    """
    for name, (low, high) in {"force": force, "duration": duration, "gap": gap}.items():
        if not 0.0 <= low <= high:
            raise ConfigError(f"push {name} must be a range from low to high, not negative, got ({low}, {high})")
    pushes: list[Push] = []
    time = start + float(rng.uniform(*gap))
    while time < until:
        direction: Array = rng.standard_normal(3)
        vector = direction / np.linalg.norm(direction) * rng.uniform(*force)
        lasts = float(rng.uniform(*duration))
        pushes.append(Push(frame, (float(vector[0]), float(vector[1]), float(vector[2])), time, lasts))
        time += lasts + float(rng.uniform(*gap))
    return tuple(pushes)
