"""A robot without mechanics: it says what a script says, and shows what reaches it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from pliant.interfaces import Plant
from pliant.signals import Command, Measurement
from pliant.simulation.imperfections.config import Imperfections
from pliant.simulation.imperfections.plant import ImperfectPlant


@dataclass
class Scripted(Plant[int]):
    """Its state is the number of steps; the script turns that and the last torque (n,) into what is true."""

    script: Callable[[int, np.ndarray], Measurement]
    n: int
    period: float = 1e-3
    received: list[np.ndarray] = field(default_factory=list)
    """(n,) torques"""

    def init(self) -> tuple[Measurement, int]:
        return self.script(0, np.zeros(self.n)), 0

    def step(self, command: Command, world: int) -> tuple[Measurement, int]:
        self.received.append(command.torque)
        return self.script(world + 1, command.torque), world + 1


def moving(n: int, v: np.ndarray, wrench: np.ndarray | None = None) -> Scripted:
    """A robot that moves with v (n,) whatever happens, feels what acts on it, and a wrench (6,)."""

    def script(tick: int, torque: np.ndarray) -> Measurement:
        felt = {} if wrench is None else {"tool": wrench}
        return Measurement(1e-3 * tick, np.zeros(n), v, torque, torque, felt)

    return Scripted(script, n)


def readings(config: Imperfections, plant: Scripted, torques: list[np.ndarray], seed: int = 0) -> list[Measurement]:
    """The first reading, and one after each torque (n,)."""
    imperfect = ImperfectPlant(plant, config, seed=seed)
    reading, world = imperfect.init()
    log = [reading]
    for torque in torques:
        reading, world = imperfect.step(Command(reading.time, torque, np.zeros(plant.n)), world)
        log.append(reading)
    return log
