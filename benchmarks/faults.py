"""Seeded faults at the border of every controller, counted per cell: `python benchmarks/faults.py` [`--write PAGE`]."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from pliant import loop
from pliant.experiments.registry import get_study
from pliant.interfaces import Controller, Estimator, Plant, ReferenceSource
from pliant.signals import Command, Environment, Estimate, Measurement, Reference, Tick, Truth

SHARE = 0.12  # of the ticks in which a fault begins
FROZEN_FOR = 4  # ticks
LEDGER_ERROR = 1e-6  # J
READING = ("nan q", "inf v", "nan torque", "nan wrench", "nan sent", "nan time", "size", "short wrench", "complex v")
READING += ("object q", "back", "stale", "late", "frozen")
BELIEF = ("nan estimate", "nan environment", "estimate back", "estimate stale", "complex estimate", "short estimate")
WISH = ("nan reference", "nan reference time", "short reference", "no reference")
ANSWER = ("nan command", "nan command time", "nan clamped", "nan diagnostics", "object command", "short command")
ANSWER += ("no command",)
GENTLE = READING + BELIEF + WISH + ANSWER
HUGE = ("huge sent", "huge command")
"""these may swing the arm, within its limits, until it stops for its speed"""
KINDS = GENTLE + HUGE

STACK = ("stack", "stack-paper", "stack-hapfic", "spring", "operational-space")
HAPTIC = ("haptic", "haptic-paper", "haptic-hold")
MPC = ("classical-mpc", "torque-feedback-mpc", "force-feedback-mpc", "offset-free-mpc")
RUNS = [("stack", "figure8-wall", name, 1.2, KINDS) for name in STACK]
RUNS += [("haptic", "floor", name, 1.0, KINDS) for name in HAPTIC]
for mpc in MPC:
    case = "tables-2-3-4-delayed" if mpc == "offset-free-mpc" else "ideal"
    RUNS += [("polishing", case, mpc, 3.5, GENTLE), ("polishing", case, mpc, 0.4, HUGE)]

Tally = Counter[tuple[str, str]]


class Faults:
    """Which fault a tick has, drawn before the tick: in each phase every kind once, in random order, then again."""

    def __init__(self, seed: int, kinds: Sequence[str] = KINDS) -> None:
        self.rng, self.kinds = np.random.default_rng(seed), kinds
        self.now, self.phase, self.left = "", "", 0
        self.decks: dict[str, list[str]] = {}

    def draw(self) -> str:
        if self.left:
            self.left -= 1
            return self.now
        self.now = self._next() if self.rng.random() < SHARE else ""
        self.left = FROZEN_FOR - 1 if self.now == "frozen" else 0
        return self.now

    def _next(self) -> str:
        deck = self.decks.setdefault(self.phase, [])
        if not deck:
            deck.extend(str(kind) for kind in self.rng.permutation(self.kinds))
        return deck.pop()


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
        steps = {"back": -3.5, "stale": -1.0, "late": 2.5, "nan time": np.nan}
        if kind in steps:
            return replace(m, time=m.time + steps[kind] * self.period)
        if kind == "frozen" and self.last is not None:
            return replace(self.last, time=m.time)
        changes: dict[str, Any] = {
            "nan q": {"q": _with(m.q, one, np.nan)},
            "inf v": {"v": _with(m.v, one, -np.inf)},
            "nan torque": {"torque": _with(m.torque, one, np.nan)},
            "nan wrench": {"wrenches": {frame: wrench * np.nan for frame, wrench in m.wrenches.items()}},
            "short wrench": {"wrenches": {frame: wrench[:3] for frame, wrench in m.wrenches.items()}},
            "nan sent": {"torque_sent": _with(m.torque_sent, one, np.nan)},
            "huge sent": {"torque_sent": _with(m.torque_sent, one, 1e6)},
            "size": {"q": m.q[:-1]},
            "complex v": {"v": m.v + 1j},
            "object q": {"q": m.q.astype(object)},
        }
        return replace(m, **changes.get(kind, {}))


class FaultyEstimator(Estimator[Any]):
    def __init__(self, inner: Estimator[Any], faults: Faults) -> None:
        self.inner, self.faults, self.last = inner, faults, 0.0

    def init(self, measurement: Measurement) -> Any:
        return self.inner.init(measurement)

    def step(self, measurement: Measurement, state: Any) -> tuple[Estimate, Any]:
        estimate, state = self.inner.step(measurement, state)
        changes: dict[str, Any] = {
            "nan estimate": {"v": estimate.v * np.nan},
            "nan environment": {"environments": {"tool": Environment(np.nan, 1.0, 1.0, 1.0)}},
            "estimate back": {"time": estimate.time - 0.1},
            "estimate stale": {"time": self.last},
            "complex estimate": {"q": estimate.q + 1j},
            "short estimate": {"q": estimate.q[:-1]},
        }
        kind = self.faults.now
        self.last = estimate.time if kind not in changes else self.last
        return replace(estimate, **changes.get(kind, {})), state


class FaultySource(ReferenceSource[Any]):
    def __init__(self, inner: ReferenceSource[Any], faults: Faults) -> None:
        self.inner, self.faults = inner, faults

    def init(self, estimate: Estimate) -> Any:
        return self.inner.init(estimate)

    def step(self, estimate: Estimate, state: Any) -> tuple[Reference, Any]:
        reference, state = self.inner.step(estimate, state)
        self.faults.phase = reference.phase
        if self.faults.now == "nan reference time":
            return replace(reference, time=np.nan), state
        if self.faults.now == "no reference":
            return None, state  # type: ignore[return-value]
        spoil = {"nan reference": lambda x: x * np.nan, "short reference": lambda x: x[:2]}.get(self.faults.now)
        if spoil is None:
            return reference, state
        tasks = tuple(replace(task, position=spoil(task.position)) for task in reference.tasks)
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
            "nan command time": replace(command, time=np.nan),
            "nan clamped": replace(command, clamped=command.clamped * np.nan),
            "nan diagnostics": replace(command, diagnostics=dict.fromkeys(command.diagnostics, np.nan)),
            "object command": replace(command, torque=command.torque.astype(object)),
            "huge command": replace(command, torque=command.torque + 1e6),
            "short command": replace(command, torque=command.torque[:-1]),
            "no command": None,
        }
        return spoilt.get(self.faults.now, command), state  # type: ignore[return-value]


def _with(values: np.ndarray, place: int, value: float) -> np.ndarray:
    changed = np.array(values)
    changed[place] = value
    return changed


@dataclass(frozen=True)
class Spoilt:
    """A run with faults."""

    tally: Tally
    """(kind, phase) → faults"""
    wrong: Counter[str]
    """rule → ticks that broke it"""
    ticks: int
    failure: str | None


def spoilt(study: str, case: str, controller: str, duration: float, kinds: Sequence[str], seed: int) -> Spoilt:
    """Runs a case with faults, and looks at everything that leaves."""
    config = get_study(study).case(case).model_copy(update={"controller": controller, "duration": duration})
    wired = get_study(study).build(config)
    faults = Faults(seed, kinds)
    plant = FaultyPlant(wired.plant, faults)
    tally: Tally = Counter()
    wrong: Counter[str] = Counter({"not finite": 0, "beyond a limit": 0, "ledger": 0})
    balances: list[float] = []

    def watch(tick: Tick) -> None:
        wrong["not finite"] += not (np.isfinite(tick.command.torque).all() and np.isfinite(tick.command.clamped).all())
        wrong["beyond a limit"] += bool((np.abs(tick.command.torque) > wired.robot.torque_limit * (1.0 + 1e-9)).any())
        if faults.now:
            tally[faults.now, tick.reference.phase or "the whole run"] += 1
        if "energy/stored" in tick.command.diagnostics and faults.now != "nan diagnostics" and not tick.guard:
            balances.append(balance(tick.command))
            wrong["ledger"] += not abs(balances[-1] - balances[0]) < LEDGER_ERROR

    parts = FaultyEstimator(wired.estimator, faults), FaultySource(wired.source, faults)
    law = FaultyController(wired.controller, faults)
    ended = loop.run(plant, *parts, law, range(round(duration / plant.period)), [watch], wired.robot)
    return Spoilt(tally, wrong, ended.ticks, ended.failure)


def balance(command: Command) -> float:
    """J of the ledger's balance; every tick must show what the first one does, what was stored at the start."""
    told = {name: float(command.diagnostics[f"energy/{name}"]) for name in ("supplied", "tuning", "delivered")}
    lost = float(command.diagnostics["energy/dissipated"]) + float(command.diagnostics["energy/stored"])
    return told["supplied"] + told["tuning"] - told["delivered"] - lost


def every_run() -> dict[tuple[int, str], Spoilt]:
    """(number, controller) → run, of all of them."""
    return {
        (number, controller): spoilt(study, case, controller, duration, kinds, seed=number)
        for number, (study, case, controller, duration, kinds) in enumerate(RUNS)
    }


def cells(runs: dict[tuple[int, str], Spoilt]) -> Counter[tuple[str, str, str]]:
    """(controller, phase, kind) → faults."""
    count: Counter[tuple[str, str, str]] = Counter()
    for (_, controller), run in runs.items():
        for (kind, phase), number in run.tally.items():
            count[controller, phase, kind] += number
    return count


def table(runs: dict[tuple[int, str], Spoilt]) -> str:
    """Every cell, in Markdown: a row for each phase of each controller, a column for each kind."""
    count = cells(runs)
    lines = ["| controller | phase | " + " | ".join(KINDS) + " |", "|---|---|" + "---:|" * len(KINDS)]
    for controller, phase in dict.fromkeys((controller, phase) for controller, phase, _ in count):
        numbers = (str(count[controller, phase, kind]) for kind in KINDS)
        lines.append(f"| `{controller}` | {phase} | " + " | ".join(numbers) + " |")
    return "\n".join(lines)


def summary(runs: dict[tuple[int, str], Spoilt]) -> str:
    """Faults of each kind for each controller, and in brackets the fewest of them in a phase of its task."""
    count = cells(runs)
    phases: dict[str, set[str]] = {}
    for controller, phase, _ in count:
        phases.setdefault(controller, set()).add(phase)
    wrong: Counter[str] = Counter()
    for run in runs.values():
        wrong.update(run.wrong)
    ticks, early = sum(run.ticks for run in runs.values()), sum(run.failure is not None for run in runs.values())
    said = ", ".join(f"{name} {number}" for name, number in wrong.items())
    lines = [f"{count.total()} faults in {ticks} ticks of {len(runs)} runs, of which {early} ended early.", ""]
    lines += [f"Ticks in which a command or the energy ledger broke a rule: {said}.", ""]
    lines += ["| | " + " | ".join(f"`{name}`" for name in phases) + " |", "|---|" + "---:|" * len(phases)]
    lines.append("| phases | " + " | ".join(str(len(of)) for of in phases.values()) + " |")
    for kind in KINDS:
        numbers = [[count[controller, phase, kind] for phase in of] for controller, of in phases.items()]
        lines.append(f"| {kind} | " + " | ".join(f"{sum(each)} ({min(each)})" for each in numbers) + " |")
    return "\n".join(lines)


BEGIN, END = "<!-- faults: written by benchmarks/faults.py -->", "<!-- end of faults -->"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path, help="page that holds the table")
    chosen = parser.parse_args()
    found = every_run()
    for name, run in found.items():
        print(*name, sum(run.tally.values()), "faults", dict(run.wrong), run.failure or "", flush=True)
    if chosen.write is None:
        print(table(found), summary(found), sep="\n\n")
    else:
        before, rest = chosen.write.read_text(encoding="utf-8").split(BEGIN)
        _, after = rest.split(END)
        chosen.write.write_text(f"{before}{BEGIN}\n\n{summary(found)}\n\n{END}{after}", encoding="utf-8")
