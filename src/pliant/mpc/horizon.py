"""References at each node of a horizon, for nodes in Python.

The controllers' own step does the same in the compiled core (`cpp/mpc/step/horizon.cpp`).
"""

from __future__ import annotations

from dataclasses import dataclass

from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class HorizonReference:
    """References at the N + 1 nodes, world axes."""

    position: Array
    """(N+1, 3) m"""
    rotation: Array | None
    """(N+1, 3, 3) R_world_tool; None leaves the orientation free"""
    velocity: Array
    """(N+1, 6) m/s, rad/s"""
    wrench: Array
    """(N+1, 6) desired reaction of the environment, N, N·m"""
    posture: Array | None
    """(N+1, n) rad"""
    phase: tuple[str, ...]
    """(N+1,) name of the phase of each node's own time"""
    task_rotation: Array | None = None
    """(N+1, 3, 3) R_world_task; None: the world's axes"""
