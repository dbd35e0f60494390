"""Where a task in phases is."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pliant.references.landing import Height
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class PhaseState:
    """Which phase the task is in."""

    index: int
    start: float
    """s at which it began"""
    begin: Array
    """(3,) m reference position at that time"""
    touch: Array
    """(3,) m where the frame was when contact began"""
    height: Height = field(default_factory=Height)
    """of the surface that was touched above the believed one"""
    next_look: float = -np.inf
    """s at which a preview is due"""
