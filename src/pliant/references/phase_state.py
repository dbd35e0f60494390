"""Where a task in phases is."""

from __future__ import annotations

from dataclasses import field

import numpy as np

from pliant.frozen import quick
from pliant.references.landing import SETTLE, Height
from pliant.references.task_phase import TaskPhase
from pliant.spatial import Array


@quick
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

    def same_phase(self, other: PhaseState) -> bool:
        """Whether another state is of the same phase, with the same begin."""
        return (
            self.index == other.index
            and self.start == other.start
            and self.begin is other.begin
            and self.touch is other.touch
            and self.height is other.height
        )


def moved(phase: TaskPhase, state: PhaseState, time: float) -> tuple[Array | None, tuple[float, ...]]:
    """Displacement (3,) m by a phase's anchor, and the height, its rate and acceleration along the normal."""
    anchor = phase.anchor
    if anchor == "world":
        return None, ()
    if anchor == "surface":
        return None, state.height.at(time)
    return state.begin if anchor == "begin" else state.touch, ()


def moved_ahead(
    phase: TaskPhase, state: PhaseState, time: float, nodes: Array
) -> tuple[Array | None, tuple[float, ...]]:
    """The same at nodes (m,) s after a time; the heights once, where they do not change, or one after the other."""
    if phase.anchor != "surface":
        return moved(phase, state, time)
    if time + float(nodes[0]) - state.height.start >= SETTLE:
        return None, state.height.at(time + float(nodes[0]))
    return None, tuple([part for node in nodes.tolist() for part in state.height.at(time + node)])
