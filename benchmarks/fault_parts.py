"""Parts of a loop that are wrong now and then, on purpose."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pliant.environment import Environment
from pliant.interfaces import Controller, Estimator, Plant, ReferenceSource
from pliant.signals import Command, Estimate, Measurement, Reference, Truth

SHARE = 0.15  # of the ticks in which a fault begins
FROZEN_FOR = 4  # ticks
READING = ("nan q", "inf v", "nan torque", "nan wrench", "nan sent", "nan time", "size", "short wrench", "complex v")
READING += ("object q", "back", "stale", "late", "frozen")
BELIEF = ("nan estimate", "nan environment", "estimate back", "estimate stale", "complex estimate", "short estimate")
WISH = ("nan reference", "nan reference time", "short reference", "no reference")
ANSWER = ("nan command", "nan command time", "nan clamped", "nan diagnostics", "object command", "short command")
ANSWER += ("no command",)
GENTLE = READING + BELIEF + WISH + ANSWER
HUGE = ("huge sent", "huge command")
"""these may swing the arm, within its limits, until it stops for its speed; `Faults` deals them once a phase"""
KINDS = GENTLE + HUGE
FREE_OR_NOT = ("free", "contact")
"""phases of a task that has none: whether the robot touches anything"""


class Faults:
    """Which fault a tick has, drawn before the tick: in each phase every kind once, in random order, then again.

    Args:
        seed: of every draw.
        phases: of the task, by the names that its references give; or FREE_OR_NOT.
        kinds: of faults.
        since: phase before which no fault is dealt; None: from the start.
        swung: on how many joints, from the base on, `huge` faults come; None: on any.
    """

    def __init__(
        self,
        seed: int,
        phases: tuple[str, ...],
        kinds: Sequence[str] = KINDS,
        since: str | None = None,
        swung: int | None = None,
    ) -> None:
        self.phases = phases
        self.rng, self.kinds, self.since, self.swung = np.random.default_rng(seed), kinds, since, swung
        self.now, self.phase, self.left = "", "", 0
        self.decks: dict[str, list[str]] = {}

    def draw(self) -> str:
        if self.left:
            self.left -= 1
            return self.now
        self.since = None if self.phase == self.since else self.since
        drawn = self.rng.random() < SHARE and self.since is None
        self.now = self._next() if drawn else ""
        self.left = FROZEN_FOR - 1 if self.now == "frozen" else 0
        return self.now

    def joint(self, n: int) -> int:
        """One of n joints."""
        return int(self.rng.integers(self.swung if self.swung and self.now in HUGE else n))

    def _next(self) -> str:
        first = self.phase not in self.decks
        deck = self.decks.setdefault(self.phase, [])
        if not deck:
            kinds = self.kinds if first else [kind for kind in self.kinds if kind not in HUGE]
            deck.extend(str(kind) for kind in self.rng.permutation(kinds or self.kinds))
        return deck.pop()


class FaultyPlant(Plant[Any]):
    """Spoils readings; says which phase it is where touching something decides that."""

    def __init__(self, inner: Plant[Any], faults: Faults) -> None:
        self.inner, self.faults, self.period = inner, faults, inner.period
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
        reading, world = self.inner.step(command, world)
        truth = self.inner.truth(world)
        if self.faults.phases == FREE_OR_NOT and truth is not None:
            self.faults.phase = FREE_OR_NOT[any(np.any(wrench) for wrench in truth.wrenches.values())]
        spoilt = self._spoilt(reading, self.faults.draw())
        self.last = reading
        return spoilt, world

    def truth(self, world: Any) -> Truth | None:
        return self.inner.truth(world)

    def _spoilt(self, m: Measurement, kind: str) -> Measurement:
        one = self.faults.joint(len(m.q))
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
        if self.faults.phases != FREE_OR_NOT:
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
    def __init__(self, inner: Controller[Any], faults: Faults, watch: Callable[[Estimate, Command, Any], None]) -> None:
        self.inner, self.faults, self.watch = inner, faults, watch

    def init(self, estimate: Estimate) -> Any:
        return self.inner.init(estimate)

    def step(self, estimate: Estimate, reference: Reference, state: Any) -> tuple[Command, Any]:
        command, state = self.inner.step(estimate, reference, state)
        self.watch(estimate, command, state)
        assert np.isfinite(command.torque).all(), "a sound law was fed something else"
        one = self.faults.joint(len(command.torque))
        spoilt = {
            "nan command": replace(command, torque=command.torque * np.nan),
            "nan command time": replace(command, time=np.nan),
            "nan clamped": replace(command, clamped=command.clamped * np.nan),
            "nan diagnostics": replace(command, diagnostics=dict.fromkeys(command.diagnostics, np.nan)),
            "object command": replace(command, torque=command.torque.astype(object)),
            "huge command": replace(command, torque=_with(command.torque, one, 1e6)),
            "short command": replace(command, torque=command.torque[:-1]),
            "no command": None,
        }
        return spoilt.get(self.faults.now, command), state  # type: ignore[return-value]


def _with(values: np.ndarray, place: int, value: float) -> np.ndarray:
    changed = np.array(values)
    changed[place] = value
    return changed
