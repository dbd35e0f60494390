"""What people want at the moment: the values that the page changes and the loop reads between two periods."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from pliant.interfaces import Controller
from pliant.live.link.messages import Aim, Pull, Turned
from pliant.signals import ImpedanceTuning
from pliant.simulation import Imperfections, Push, Scene
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class Wishes:
    """Everything that is asked of a running loop. Swapped whole."""

    tunings: Mapping[str, ImpedanceTuning] = field(default_factory=lambda: MappingProxyType({}))
    """frame → tuning of the task there; the others keep their own"""
    whole: Any = None
    """frozen tuning of the whole controller; None: its own"""
    controller: Controller[Any] | None = None
    """takes over from the one that runs; None: nobody does"""
    aim: Aim = field(default_factory=Aim)
    turned: Turned = field(default_factory=Turned)
    scene: Scene | None = None
    """None: the one the plant was built with"""
    flaws: Imperfections | None = None
    """None: those the plant was built with"""
    pull: Pull | None = None
    pulled_at: float = 0.0
    """s of wall time"""


class Desk:
    """Where the wishes lie. The loop's wrappers read the wishes once a period and leave behind what they did."""

    def __init__(self) -> None:
        self.wishes = Wishes()
        self.pushes: list[tuple[str, tuple[float, float, float], float]] = []
        """(frame, force in N, duration in s) that wait for the next period"""
        self.offset: Array = np.zeros(3)
        """(3,) m by which the first task's target is moved at present"""
        self.clock = -math.inf
        """s of the task: it goes faster or slower than that of the loop where the page turned its speed"""
        self.acting: tuple[Push, ...] = ()
        """pushes that act on the robot at present"""
