"""Faulty signals at the border of every controller: none beyond a limit, none not finite, in any phase of its task."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmarks.fault_ledgers import Books
from benchmarks.fault_parts import FREE_OR_NOT, Faults, FaultyPlant
from benchmarks.faults import LAYERS, RUNS, Count, Spoiled, every_run, spoil
from pliant import loop
from pliant.configuration import merged
from pliant.experiments.registry import get_study
from pliant.guard import Fault, Guard
from pliant.signals import Command, Measurement, Tick
from pliant.wiring.registry import controllers


def test_no_fault_gets_past_the_guard() -> None:
    """Two thousand and more seeded faults: no cell of kinds × controllers × phases is empty, and every ledger stays
    what it is when it is kept a second time."""
    count = every_run()
    assert dict(count.wrong) == {"not finite": 0, "beyond a limit": 0, "ledger": 0}
    assert count.cells.total() >= 2000
    assert {of.controller for of in RUNS} == set(controllers())
    for of in RUNS:
        for phase in of.phases:
            assert count.empty(of, phase) == [], (of.controller, phase)
    kept = {ledger: {name for name, book in count.books if book == ledger} for _, ledger in count.books}
    assert kept["stack"] == {name for name, entry in controllers().items() if entry.family in ("stack", "haptic")}
    layered = {of.controller for of in RUNS if of.changes}
    assert kept["joint limits"] == layered
    assert kept["torque step"] >= layered  # every study has that bound; a ledger is kept where it held back


def test_the_count_sees_what_gets_out_without_a_guard(monkeypatch: pytest.MonkeyPatch) -> None:
    """The control: a guard that lets every command pass."""
    monkeypatch.setattr(Guard, "command", lambda guard, command, watched: (command, Fault.NONE))
    count = Count()
    spoil(Spoiled("stack", "figure8-wall", "stack", 0.1, FREE_OR_NOT), count, 1, ("nan command", "huge command"))
    assert count.wrong["not finite"] + count.wrong["beyond a limit"] > 0


@pytest.mark.parametrize("controller", ["stack", "operational-space"])
def test_the_books_see_a_reading_that_a_law_was_fed_alone(controller: str) -> None:
    """The control: every tenth estimate that the law gets is not the one that the books get."""
    study = get_study("stack")
    changes = {"controller": controller, "duration": 0.1, **LAYERS}
    wired = study.build(merged(study.case("figure8-wall"), changes))
    for spoil_every in (0, 10):
        books, state = Books(), None
        reading, world = wired.plant.init()
        est = wired.estimator.init(reading)
        ref = None
        for tick in range(60):
            estimate, est = wired.estimator.step(reading, est)
            ref = ref or wired.source.init(estimate)
            wish, ref = wired.source.step(estimate, ref)
            state = state or wired.controller.init(estimate)
            odd = replace(estimate, q=estimate.q + 1e-2) if spoil_every and tick % spoil_every == 9 else estimate
            command, state = wired.controller.step(odd, wish, state)
            books(estimate, command, state)
            reading, world = wired.plant.step(command, world)
        assert bool(books.wrong) == bool(spoil_every)


def test_the_guard_names_what_it_found_and_holds_then_compensates_gravity() -> None:
    study = get_study("polishing")
    wired = study.build(study.case("tables-2-3-4").model_copy(update={"duration": 0.2}))
    seen: list[Tick] = []

    class Blind(FaultyPlant):
        def step(self, command: Command, world: Any) -> tuple[Measurement, Any]:
            reading, world = self.inner.step(command, world)
            return (replace(reading, q=reading.q * np.nan) if reading.time > 0.0495 else reading), world

    plant = Blind(wired.plant, Faults(0, FREE_OR_NOT))
    outcome = loop.run(plant, wired.estimator, wired.source, wired.controller, range(200), [seen.append], wired.robot)
    faulty = [tick for tick in seen if tick.guard]
    assert {tick.guard for tick in faulty} == {int(Fault.NOT_FINITE)}
    assert len(faulty) == 50  # 50 ms, then the run ends
    assert outcome.failure is not None
    assert "a measurement was not finite; no sound signal came for 50 ms" in outcome.failure
    last_sound = next(tick for tick in reversed(seen) if not tick.guard)
    np.testing.assert_array_equal(faulty[0].command.torque, last_sound.command.torque)
    import pinocchio as pin

    m = last_sound.measurement
    gravity = pin.computeGeneralizedGravity(wired.robot.model, wired.robot.model.createData(), m.q)
    np.testing.assert_allclose(faulty[1].command.torque, gravity - 5.0 * m.v)


@pytest.mark.parametrize("part", ["estimator", "source", "controller", "plant"])
def test_whatever_a_part_raises_the_run_ends_in_order(part: str, monkeypatch: pytest.MonkeyPatch) -> None:
    study = get_study("stack")
    wired = study.build(study.case("figure8-plain").model_copy(update={"duration": 0.1}))

    def broken(step: Any) -> Any:
        count = 0

        def raising(*arguments: Any) -> Any:
            nonlocal count
            count += 1
            if count > 20:
                raise ZeroDivisionError("somebody's own mistake")
            return step(*arguments)

        return raising

    chosen = getattr(wired, part)
    monkeypatch.setattr(chosen, "step", broken(chosen.step))  # parts may be shared between runs
    seen: list[Tick] = []
    outcome = loop.run(
        wired.plant, wired.estimator, wired.source, wired.controller, range(100), [seen.append], wired.robot
    )
    assert outcome.ticks == 20
    assert outcome.failure is not None
    assert "ZeroDivisionError in test_faults.py" in outcome.failure
    assert "somebody's own mistake at t = 0.0200 s" in outcome.failure
