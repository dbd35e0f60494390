"""The control loop with stand-in parts: order, state passing, and what ends a run early."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from pliant import loop
from pliant.errors import SignalError
from pliant.guard import Fault
from pliant.interfaces import Controller, Estimator, Plant, ReferenceSource
from pliant.signals import Command, Estimate, Measurement, Reference, Tick


class Integrator(Plant[float]):
    """A single joint whose position is the sum of the torques."""

    period = 0.01

    def __init__(self, spoil_at: int | None = None) -> None:
        self.spoil_at = spoil_at

    def measure(self, tick: int, q: float) -> Measurement:
        value = float("nan") if tick == self.spoil_at else q
        one = np.array([value])
        return Measurement(tick * self.period, one, np.zeros(1), np.zeros(1), np.zeros(1))

    def init(self) -> tuple[Measurement, float]:
        self.tick = 0
        return self.measure(0, 0.0), 0.0

    def step(self, command: Command, world: float) -> tuple[Measurement, float]:
        self.tick += 1
        world += float(command.torque[0])
        return self.measure(self.tick, world), world


class Believe(Estimator[None]):
    def init(self, measurement: Measurement) -> None:
        return None

    def step(self, measurement: Measurement, state: None) -> tuple[Estimate, None]:
        zero = np.zeros(1)
        return Estimate(measurement.time, measurement.q, measurement.v, zero, zero), None


class Count(ReferenceSource[int]):
    def init(self, estimate: Estimate) -> int:
        return 0

    def step(self, estimate: Estimate, state: int) -> tuple[Reference, int]:
        return Reference(estimate.time, posture=np.array([float(state)])), state + 1


class Follow(Controller[int]):
    def __init__(self, law: Callable[[float], float] = lambda posture: posture) -> None:
        self.law = law

    def init(self, estimate: Estimate) -> int:
        return 0

    def step(self, estimate: Estimate, reference: Reference, state: int) -> tuple[Command, int]:
        assert reference.posture is not None
        torque = np.array([self.law(float(reference.posture[0]))])
        return Command(estimate.time, torque, np.zeros(1)), state + 1


def test_the_loop_runs_its_stages_in_order_and_passes_state_on() -> None:
    ticks: list[Tick] = []
    outcome = loop.run(Integrator(), Believe(), Count(), Follow(), range(5), [ticks.append])
    assert (outcome.ticks, outcome.failure) == (5, None)
    assert outcome.time == pytest.approx(0.05)
    assert [float(tick.measurement.q[0]) for tick in ticks] == [0.0, 0.0, 1.0, 3.0, 6.0]
    assert all(tick.command.time == tick.measurement.time for tick in ticks)
    assert set(ticks[0].wall) == {"plan", "control"}


def test_a_measurement_that_is_not_finite_is_passed_over_and_holds_the_last_torque() -> None:
    ticks: list[Tick] = []
    outcome = loop.run(Integrator(spoil_at=3), Believe(), Count(), Follow(), range(10), [ticks.append])
    assert (outcome.ticks, outcome.failure) == (10, None)
    assert [tick.guard for tick in ticks] == [0, 0, 0, int(Fault.NOT_FINITE), 0, 0, 0, 0, 0, 0]
    assert ticks[3].command.torque[0] == ticks[2].command.torque[0]
    assert all(np.isfinite(tick.command.torque).all() for tick in ticks)


def test_a_first_measurement_that_is_not_finite_ends_the_run_before_it_begins() -> None:
    outcome = loop.run(Integrator(spoil_at=0), Believe(), Count(), Follow(), range(10))
    assert outcome.ticks == 0
    assert outcome.failure is not None
    assert "not finite at t = 0.0000 s" in outcome.failure


def test_a_signal_error_of_a_stage_ends_the_run_with_its_reason() -> None:
    def refuse(posture: float) -> float:
        if posture == 2.0:
            raise SignalError("the reference ran away")
        return posture

    outcome = loop.run(Integrator(), Believe(), Count(), Follow(refuse), range(10))
    assert outcome.ticks == 2
    assert outcome.failure == "the reference ran away at t = 0.0200 s"
