"""The state of a simulated world."""

from __future__ import annotations

from dataclasses import dataclass, field

import mujoco

from pliant.simulation.contact.explicit import ContactState
from pliant.simulation.disturbances import Push
from pliant.spatial import Array


@dataclass(slots=True)
class World:
    """State of the simulated world. Consumed by `step`."""

    data: mujoco.MjData
    ticks: int
    """control periods since the start"""
    wrenches: dict[str, Array]
    """frame → (6,) contact wrench of the last physics step, world axes"""
    touching: frozenset[str]
    """frames and robot parts in contact in the last physics step"""
    torque: Array
    """(n,) held over the last period, N·m; at the start what keeps the robot at rest"""
    contacts: ContactState | None = None
    """of the explicit contact law"""
    pushes: list[Push] = field(default_factory=list[Push])
    """more disturbances than the plant was built with; may be changed between two steps"""
