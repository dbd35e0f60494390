"""Faulty signals at the border of every controller: none beyond a limit, none not finite, in any phase of its task."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pliant import loop
from pliant.experiments.base import Experiment
from pliant.experiments.registry import get_study
from pliant.guard import Fault
from pliant.interfaces import Controller, Estimator, Plant, ReferenceSource
from pliant.signals import Command, Estimate, Measurement, Reference, Tick, Truth

SHARE = 0.12  # of the ticks that have a fault
GENTLE = ("nan q", "inf v", "nan torque", "nan wrench", "nan sent", "size", "back", "stale", "late", "frozen")
GENTLE += ("nan estimate", "nan reference", "nan command", "short command", "no command")
HUGE = ("huge sent", "huge command")
"""these may swing the arm, within its limits, until it stops for its speed"""
KINDS = (*GENTLE, *HUGE)

STACK = ("stack", "stack-paper", "stack-hapfic", "spring", "operational-space")
HAPTIC = ("haptic", "haptic-paper", "haptic-hold")
MPC = ("classical-mpc", "torque-feedback-mpc", "force-feedback-mpc", "offset-free-mpc")
RUNS = [("stack", "figure8-wall", name, 1.2, KINDS) for name in STACK]
RUNS += [("haptic", "floor", name, 1.0, KINDS) for name in HAPTIC]
for mpc in MPC:
    case = "tables-2-3-4-delayed" if mpc == "offset-free-mpc" else "ideal"
    RUNS += [("polishing", case, mpc, 3.3, GENTLE), *(("polishing", case, mpc, 0.4, (kind,)) for kind in HUGE)]

Tally = Counter[tuple[str, str]]


class Faults:
    """Which fault a tick has, drawn before the tick."""

    def __init__(self, seed: int, kinds: Sequence[str] = KINDS) -> None:
        self.rng, self.kinds = np.random.default_rng(seed), kinds
        self.now = ""

    def draw(self) -> str:
        self.now = str(self.rng.choice(self.kinds)) if self.rng.random() < SHARE else ""
        return self.now


class FaultyPlant(Plant[Any]):
    """Spoils readings, and remembers what it was sent."""

    def __init__(self, inner: Plant[Any], faults: Faults) -> None:
        self.inner, self.faults, self.period = inner, faults, inner.period
        self.sent: list[np.ndarray] = []
        self.last: Measurement | None = None

    @property
    def noisy(self) -> frozenset[str]:
        return self.inner.noisy

    @property
    def compensates(self) -> Any:
        return self.inner.compensates

    def init(self) -> tuple[Measurement, Any]:
        return self.inner.init()

    def step(self, command: Command, world: Any) -> tuple[Measurement, Any]:
        self.sent.append(command.torque)
        reading, world = self.inner.step(command, world)
        spoilt = self._spoilt(reading, self.faults.draw())
        self.last = reading
        return spoilt, world

    def truth(self, world: Any) -> Truth | None:
        return self.inner.truth(world)

    def _spoilt(self, m: Measurement, kind: str) -> Measurement:
        one = int(self.faults.rng.integers(len(m.q)))
        if kind == "nan q":
            return replace(m, q=_with(m.q, one, np.nan))
        if kind == "inf v":
            return replace(m, v=_with(m.v, one, -np.inf))
        if kind == "nan torque":
            return replace(m, torque=_with(m.torque, one, np.nan))
        if kind == "nan wrench":
            return replace(m, wrenches={frame: wrench * np.nan for frame, wrench in m.wrenches.items()})
        if kind == "nan sent":
            return replace(m, torque_sent=_with(m.torque_sent, one, np.nan))
        if kind == "huge sent":
            return replace(m, torque_sent=_with(m.torque_sent, one, 1e6))
        if kind == "size":
            return replace(m, q=m.q[:-1])
        steps = {"back": -3.5, "stale": -1.0, "late": 2.5}
        if kind in steps:
            return replace(m, time=m.time + steps[kind] * self.period)
        if kind == "frozen" and self.last is not None:
            return replace(self.last, time=m.time)
        return m


class FaultyEstimator(Estimator[Any]):
    def __init__(self, inner: Estimator[Any], faults: Faults) -> None:
        self.inner, self.faults = inner, faults

    def init(self, measurement: Measurement) -> Any:
        return self.inner.init(measurement)

    def step(self, measurement: Measurement, state: Any) -> tuple[Estimate, Any]:
        estimate, state = self.inner.step(measurement, state)
        return (replace(estimate, v=estimate.v * np.nan) if self.faults.now == "nan estimate" else estimate), state


class FaultySource(ReferenceSource[Any]):
    def __init__(self, inner: ReferenceSource[Any], faults: Faults) -> None:
        self.inner, self.faults = inner, faults

    def init(self, estimate: Estimate) -> Any:
        return self.inner.init(estimate)

    def step(self, estimate: Estimate, state: Any) -> tuple[Reference, Any]:
        reference, state = self.inner.step(estimate, state)
        if self.faults.now != "nan reference":
            return reference, state
        tasks = tuple(replace(task, position=task.position * np.nan) for task in reference.tasks)
        return replace(reference, tasks=tasks), state


class FaultyController(Controller[Any]):
    def __init__(self, inner: Controller[Any], faults: Faults) -> None:
        self.inner, self.faults = inner, faults

    def init(self, estimate: Estimate) -> Any:
        return self.inner.init(estimate)

    def step(self, estimate: Estimate, reference: Reference, state: Any) -> tuple[Command, Any]:
        command, state = self.inner.step(estimate, reference, state)
        assert np.isfinite(command.torque).all(), "a sound law was fed something else"
        spoilt = {
            "nan command": replace(command, torque=command.torque * np.nan),
            "huge command": replace(command, torque=command.torque + 1e6),
            "short command": replace(command, torque=command.torque[:-1]),
            "no command": None,
        }
        return spoilt.get(self.faults.now, command), state  # type: ignore[return-value]


def _with(values: np.ndarray, place: int, value: float) -> np.ndarray:
    changed = np.array(values)
    changed[place] = value
    return changed


def spoilt(
    study: str, case: str, controller: str, duration: float, kinds: Sequence[str], seed: int
) -> tuple[Tally, Experiment, list[Tick]]:
    """How many faults of each kind hit each phase; the wired loop; every tick."""
    config = get_study(study).case(case).model_copy(update={"controller": controller, "duration": duration})
    wired = get_study(study).build(config)
    faults = Faults(seed, kinds)
    plant = FaultyPlant(wired.plant, faults)
    tally: Tally = Counter()
    ticks: list[Tick] = []

    def watch(tick: Tick) -> None:
        ticks.append(tick)
        if faults.now:
            tally[faults.now, tick.reference.phase] += 1

    loop.run(
        plant,
        FaultyEstimator(wired.estimator, faults),
        FaultySource(wired.source, faults),
        FaultyController(wired.controller, faults),
        range(round(duration / plant.period)),
        [watch],
        wired.robot,
    )
    return tally, wired, ticks


def test_no_fault_gets_past_the_guard(capsys: pytest.CaptureFixture[str]) -> None:
    """Two thousand and more seeded faults: no cell of kinds × controllers is empty, nor one of MPC phases."""
    table: dict[str, Tally] = {}
    for number, (study, case, controller, duration, kinds) in enumerate(RUNS):
        tally, wired, ticks = spoilt(study, case, controller, duration, kinds, seed=number)
        limit = wired.robot.torque_limit * (1.0 + 1e-9)
        for tick in ticks:
            assert np.isfinite(tick.command.torque).all()
            assert (np.abs(tick.command.torque) <= limit).all()
            assert np.isfinite(tick.command.clamped).all()
            for name, value in tick.command.diagnostics.items():
                if "energy" in name:
                    assert np.isfinite(value).all(), name
        table.setdefault(controller, Counter()).update(tally)
    for controller in MPC:
        assert {phase for _, phase in table[controller]} >= {"reach", "track", "ramp", "contact", "circle"}
    rows: dict[str, Counter[str]] = {name: Counter() for name in table}
    for name, tally in table.items():
        for (kind, _), count in tally.items():
            rows[name][kind] += count
    assert all(rows[name][kind] > 0 for name in rows for kind in KINDS), rows
    assert sum(row.total() for row in rows.values()) >= 2000
    with capsys.disabled():
        print(
            f"\n{sum(row.total() for row in rows.values())} faults: { ({n: row.total() for n, row in rows.items()}) }"
        )


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
def test_whatever_a_part_raises_the_run_ends_in_order(part: str) -> None:
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
    chosen.step = broken(chosen.step)
    seen: list[Tick] = []
    outcome = loop.run(
        wired.plant, wired.estimator, wired.source, wired.controller, range(100), [seen.append], wired.robot
    )
    assert outcome.ticks == 20
    assert outcome.failure is not None
    assert "ZeroDivisionError in test_faults.py" in outcome.failure
    assert "somebody's own mistake at t = 0.0200 s" in outcome.failure
