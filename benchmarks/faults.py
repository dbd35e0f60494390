"""Seeded faults at the border of every controller, counted per cell: `python -m benchmarks.faults` [`--write PAGE`]."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.fault_ledgers import Books
from benchmarks.fault_parts import (
    FREE_OR_NOT,
    GENTLE,
    KINDS,
    Faults,
    FaultyController,
    FaultyEstimator,
    FaultyPlant,
    FaultySource,
)
from pliant import loop
from pliant.configuration import merged
from pliant.experiments.registry import get_study
from pliant.signals import Tick

STACK = ("stack", "stack-paper", "stack-corrected", "stack-hapfic", "spring", "operational-space")
HAPTIC = ("haptic", "haptic-paper", "haptic-hold")
MPC = ("classical-mpc", "torque-feedback-mpc", "force-feedback-mpc", "offset-free-mpc", "visco-elastic-mpc")
LAYERS = {"joint_limits": {"margin": 0.8}, "torque_step": 0.02}  # rad, share: so that both have something to do


@dataclass(frozen=True)
class Spoiled:
    """A run that faults are dealt to."""

    study: str
    case: str
    controller: str
    duration: float
    """s"""
    phases: tuple[str, ...]
    """in each of which every kind of fault must happen"""
    changes: Mapping[str, Any] = field(default_factory=dict[str, Any])
    swung: int | None = None
    """joints from the base on that `huge` faults come on; None: all"""


RUNS = [Spoiled("stack", "figure8-wall", name, 1.9, FREE_OR_NOT, LAYERS) for name in STACK]
RUNS += [Spoiled("haptic", "floor", name, 1.5, FREE_OR_NOT) for name in HAPTIC]
RUNS += [
    Spoiled(
        "polishing",
        "tables-2-3-4-delayed" if name == "offset-free-mpc" else "ideal",
        name,
        3.5,
        ("reach", "track", "ramp", "contact", "circle"),
        LAYERS if name == "classical-mpc" else {},
        swung=2,  # a wrist is thrown by one tick of full torque
    )
    for name in MPC
]
Cell = tuple[str, str, str]  # controller, phase, kind


@dataclass
class Count:
    """What happened in some runs."""

    cells: Counter[Cell] = field(default_factory=Counter[Cell])
    """ticks with a fault"""
    wrong: Counter[str] = field(default_factory=lambda: Counter({"not finite": 0, "beyond a limit": 0, "ledger": 0}))
    """rule → ticks that broke it"""
    books: Counter[tuple[str, str]] = field(default_factory=Counter[tuple[str, str]])
    """(controller, ledger) → runs in which it was kept a second time"""
    ticks: int = 0
    ended: list[str | None] = field(default_factory=list[str | None])
    """why each run ended early; None: it did not"""

    def empty(self, of: Spoiled, phase: str) -> list[str]:
        """Kinds that did not happen in a phase."""
        return [kind for kind in KINDS if not self.cells[of.controller, phase, kind]]


def spoil(of: Spoiled, count: Count, seed: int, kinds: Sequence[str] = KINDS, since: str | None = None) -> None:
    """Runs a case with faults, from a phase on, and looks at everything that leaves."""
    study = get_study(of.study)
    config = merged(study.case(of.case), {"controller": of.controller, "duration": of.duration, **of.changes})
    wired = study.build(config)
    faults, books = Faults(seed, of.phases, kinds, since, of.swung), Books()
    plant = FaultyPlant(wired.plant, faults)

    def watch(tick: Tick) -> None:
        sent, limit = tick.command.torque, wired.robot.torque_limit * (1.0 + 1e-9)
        count.wrong["not finite"] += not (np.isfinite(sent).all() and np.isfinite(tick.command.clamped).all())
        count.wrong["beyond a limit"] += bool((np.abs(sent) > limit).any())
        if faults.now:
            count.cells[of.controller, faults.phase, faults.now] += 1

    parts = FaultyEstimator(wired.estimator, faults), FaultySource(wired.source, faults)
    law = FaultyController(wired.controller, faults, books)

    def clock() -> Iterator[int]:
        for tick in range(round(of.duration / plant.period)):
            phases = of.phases if since is None else (since,)
            if not any(set(count.empty(of, phase)).intersection(kinds) for phase in phases):
                return  # every kind has come
            yield tick

    ended = loop.run(plant, *parts, law, clock(), [watch], wired.robot)
    count.wrong["ledger"] += len(books.wrong)
    count.books.update((of.controller, name) for name in books.kept)
    count.ticks += ended.ticks
    count.ended.append(ended.failure)


def every_run(runs: Sequence[Spoiled] = RUNS) -> Count:
    """All of them. Where `huge` faults ended a run early it is made again without them, and they come once more in
    each phase in runs that end when they have come."""
    count = Count()
    for number, of in enumerate(runs):
        spoil(of, count, number)
        if count.ended[-1] is not None:
            spoil(of, count, number, GENTLE)
        for phase in of.phases:
            while missing := count.empty(of, phase):
                before = len(missing)
                spoil(of, count, 1000 + number, missing, phase)
                if len(count.empty(of, phase)) == before:
                    break  # it is not reached
    return count


def table(count: Count) -> str:
    """Every cell, in Markdown: a row for each phase of each controller, a column for each kind."""
    lines = ["| controller | phase | " + " | ".join(KINDS) + " |", "|---|---|" + "---:|" * len(KINDS)]
    for of in RUNS:
        for phase in of.phases:
            numbers = (str(count.cells[of.controller, phase, kind]) for kind in KINDS)
            lines.append(f"| `{of.controller}` | {phase} | " + " | ".join(numbers) + " |")
    return "\n".join(lines)


def summary(count: Count) -> str:
    """Faults of each kind for each controller, and in brackets the fewest of them in a phase of its task."""
    said = ", ".join(f"{name} {number}" for name, number in count.wrong.items())
    early = sum(failure is not None for failure in count.ended)
    lines = [
        f"{count.cells.total()} faults in {count.ticks} ticks of {len(count.ended)} runs; {early} ended early.",
        "",
    ]
    lines += [f"Ticks in which a command or a ledger broke a rule: {said}.", ""]
    lines += ["| | " + " | ".join(f"`{of.controller}`" for of in RUNS) + " |", "|---|" + "---:|" * len(RUNS)]
    lines.append("| phases | " + " | ".join(", ".join(of.phases) for of in RUNS) + " |")
    books = [[ledger for name, ledger in sorted(count.books) if name == of.controller] for of in RUNS]
    lines.append("| ledgers | " + " | ".join(", ".join(kept) or "–" for kept in books) + " |")
    for kind in KINDS:
        numbers = [[count.cells[of.controller, phase, kind] for phase in of.phases] for of in RUNS]
        lines.append(f"| {kind} | " + " | ".join(f"{sum(each)} ({min(each)})" for each in numbers) + " |")
    return "\n".join(lines)


BEGIN, END = "<!-- faults: written by benchmarks/faults.py -->", "<!-- end of faults -->"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path, help="page that holds the table")
    chosen = parser.parse_args()
    found = every_run()
    if chosen.write is None:
        print(*(failure for failure in found.ended if failure), table(found), summary(found), sep="\n\n")
    else:
        before, rest = chosen.write.read_text(encoding="utf-8").split(BEGIN)
        _, after = rest.split(END)
        chosen.write.write_text(f"{before}{BEGIN}\n\n{summary(found)}\n\n{END}{after}", encoding="utf-8")
