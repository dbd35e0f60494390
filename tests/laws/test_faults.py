"""Faulty signals at the border of every controller: none beyond a limit, none not finite, in any phase of its task."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmarks.faults import KINDS, MPC, Faults, FaultyPlant, cells, every_run, spoilt
from pliant import loop
from pliant.experiments.registry import get_study
from pliant.guard import Fault, Guard
from pliant.signals import Command, Measurement, Tick


def test_no_fault_gets_past_the_guard() -> None:
    """Two thousand and more seeded faults: no cell of kinds × controllers is empty, nor one of an MPC's phases."""
    runs = every_run()
    for name, run in runs.items():
        assert run.wrong.total() == 0, (name, run.wrong)
    count = cells(runs)
    assert count.total() >= 2000
    for controller in dict.fromkeys(controller for controller, _, _ in count):
        phases = {phase for name, phase, _ in count if name == controller}
        assert phases >= ({"reach", "track", "ramp", "contact", "circle"} if controller in MPC else set())
        for kind in KINDS:
            assert any(count[controller, phase, kind] for phase in phases), (controller, kind)


def test_the_count_sees_what_gets_out_without_a_guard(monkeypatch: pytest.MonkeyPatch) -> None:
    """The control: a guard that lets every command pass."""
    monkeypatch.setattr(Guard, "command", lambda guard, command, watched: (command, Fault.NONE))
    kinds = ("nan command", "huge command")
    run = spoilt("stack", "figure8-wall", "stack", 0.1, kinds, seed=1)
    assert run.wrong["not finite"] + run.wrong["beyond a limit"] > 0


def test_the_guard_names_what_it_found_and_holds_then_compensates_gravity() -> None:
    study = get_study("polishing")
    wired = study.build(study.case("tables-2-3-4").model_copy(update={"duration": 0.2}))
    seen: list[Tick] = []

    class Blind(FaultyPlant):
        def step(self, command: Command, world: Any) -> tuple[Measurement, Any]:
            reading, world = self.inner.step(command, world)
            return (replace(reading, q=reading.q * np.nan) if reading.time > 0.0495 else reading), world

    plant = Blind(wired.plant, Faults(0))
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
