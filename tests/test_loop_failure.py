"""A plant that fails ends the run with its reason, and everything observed until then stays."""

from __future__ import annotations

import numpy as np

from pliant.errors import RunFailedError
from pliant.interfaces import Controller, Estimator, Plant, ReferenceSource
from pliant.loop import run
from pliant.signals import Command, Estimate, Measurement, Reference, Tick

PERIOD = 1e-3  # s


class Breaks(Plant[int]):
    period = PERIOD

    def __init__(self, at: int) -> None:
        self.at = at

    def init(self) -> tuple[Measurement, int]:
        return self._measure(0), 0

    def step(self, command: Command, world: int) -> tuple[Measurement, int]:
        if world == self.at:
            raise RunFailedError("the simulation of contacts diverged")
        return self._measure(world + 1), world + 1

    def _measure(self, tick: int) -> Measurement:
        return Measurement(tick * PERIOD, np.zeros(1), np.zeros(1), np.zeros(1), np.zeros(1))


class Ideal(Estimator[None]):
    def init(self, measurement: Measurement) -> None:
        return None

    def step(self, measurement: Measurement, state: None) -> tuple[Estimate, None]:
        m = measurement
        return Estimate(m.time, m.q, m.v, m.torque, m.torque_sent), None


class Nothing(ReferenceSource[None]):
    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, state: None) -> tuple[Reference, None]:
        return Reference(estimate.time), None


class Limp(Controller[None]):
    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, reference: Reference, state: None) -> tuple[Command, None]:
        return Command(estimate.time, np.zeros(1), np.zeros(1)), None


def test_the_reason_and_the_time_are_reported_and_observers_saw_every_tick_until_then() -> None:
    seen: list[Tick] = []
    outcome = run(Breaks(at=3), Ideal(), Nothing(), Limp(), range(10), [seen.append])
    assert outcome.failure == "the simulation of contacts diverged at t = 0.0030 s"
    assert outcome.ticks == 3
    assert [tick.measurement.time for tick in seen] == [0.0, 1e-3, 2e-3, 3e-3]


def test_a_plant_that_holds_runs_to_the_end() -> None:
    outcome = run(Breaks(at=99), Ideal(), Nothing(), Limp(), range(10))
    assert outcome.failure is None
    assert outcome.ticks == 10
