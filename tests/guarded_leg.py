"""A leg that stands still, and what its guard is told."""

from __future__ import annotations

import numpy as np

from pliant.guard import Fault, Guard, Watched
from pliant.interfaces import Plant
from pliant.robot import Robot
from pliant.signals import Command, Measurement

PERIOD = 1e-3  # s


class Still(Plant[None]):
    period = PERIOD

    def __init__(self, noisy: frozenset[str] = frozenset()) -> None:
        self._noisy = noisy

    @property
    def noisy(self) -> frozenset[str]:
        return self._noisy

    def init(self) -> tuple[Measurement, None]:
        return reading(0.0), None

    def step(self, command: Command, world: None) -> tuple[Measurement, None]:
        return reading(0.0), None


def reading(time: float, q: float = 0.1) -> Measurement:
    return Measurement(time, np.full(3, q), np.zeros(3), np.zeros(3), np.zeros(3), {"foot": np.zeros(6)})


def started(noisy: frozenset[str] = frozenset()) -> tuple[Guard, Watched]:
    guard = Guard(Still(noisy), Robot.load("leg3"))
    watched = guard.init(reading(0.0))
    assert guard.measurement(reading(0.0), watched) is Fault.NONE
    return guard, watched


def command(torque: float = 1.0) -> Command:
    return Command(0.0, np.full(3, torque), np.zeros(3))
