"""Requests of the page: values that it changes and that the loop reads between two periods."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from pliant.interfaces import Controller
from pliant.live.link.messages import Aim, Pull, TaskScaling
from pliant.signals import ImpedanceTuning
from pliant.simulation import Imperfections, Push, Scene
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class Requests:
    """All requests to a running loop. Replaced as a whole."""

    tunings: Mapping[str, ImpedanceTuning] = field(default_factory=lambda: MappingProxyType({}))
    """frame → tuning of the task there; the others keep their own"""
    whole: Any = None
    """frozen tuning of the whole controller; None: the controller's own"""
    controller: Controller[Any] | None = None
    """replaces the running controller; None: no replacement"""
    aim: Aim = field(default_factory=Aim)
    scaling: TaskScaling = field(default_factory=TaskScaling)
    scene: Scene | None = None
    """None: the one the plant was built with"""
    imperfections: Imperfections | None = None
    """None: those the plant was built with"""
    pull: Pull | None = None
    pulled_at: float = 0.0
    """s of wall time"""


class SharedState:
    """What the session shares with the wrappers of the loop: the requests, which they read once a period, and what they
    did."""

    def __init__(self) -> None:
        self.requests = Requests()
        self.pushes: list[tuple[str, tuple[float, float, float], float]] = []
        """(frame, force in N, duration in s) that wait for the next period"""
        self.offset: Array = np.zeros(3)
        """(3,) m, present offset of the first task's target"""
        self.clock = -math.inf
        """s, clock of the task: it differs from the clock of the loop where the page has changed the speed of the
        task"""
        self.acting: tuple[Push, ...] = ()
        """pushes that act on the robot at present"""
