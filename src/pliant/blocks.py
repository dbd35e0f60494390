"""Blocks of ticks without Python, for a loop whose parts all have a compiled face (`pliant.compiled`).

Python stays the owner: before a block it fills in the references, after it it takes the states back, so that the loop
in `pliant.loop` can go on at any tick. A tick in which anything is not as usual is left to that loop, whose guard finds
out what it is.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from operator import length_hint
from typing import Any, TypeVar

import numpy as np

from pliant.block_form import BlockForm, Faces
from pliant.compiled import (
    CompiledController,
    CompiledEstimator,
    CompiledPlant,
    KnownReferences,
    Rows,
    face_of,
    unchanged,
)
from pliant.interfaces import Controller, Estimator, Observer, Plant, ReferenceSource
from pliant.signals import Command, Estimate, Measurement, Reference
from pliant.spatial import Array

_Answer = TypeVar("_Answer")
MOST = 256
"""ticks of a block; also the most that Python makes after blocks that came to nothing"""
_FIRST = 16  # ticks of the first block
_LONGEST = 0.05  # s of wall time of a block, about: Ctrl-C waits for its end
_RANGE = type(iter(range(0)))
"""a clock that waits for nobody"""


@dataclass(slots=True)
class Standing:
    """Where a loop stands between two ticks."""

    measurement: Measurement
    world: Any
    estimate: Estimate
    reference: Reference
    command: Command
    states: tuple[Any, Any, Any]
    """of estimator, source and controller"""


@dataclass(frozen=True, slots=True)
class Ran:
    """What a block came to."""

    at: Standing
    """after its last tick; the world is told by `land`"""
    ticks: int
    """one or more"""
    reading: Measurement
    """of the last tick"""
    rows: Rows
    land: Callable[[], None]
    """writes the block into the world. Raises RunFailedError: the robot stopped in the period of the last tick"""


class Blocks:
    """Runs blocks of one loop.

    Args:
        plant, estimator, source, controller: the parts.
        observers: of the loop.
        bound: (n,) N·m that a torque may be; None: there is no limit.
    """

    def __init__(
        self,
        plant: Plant[Any],
        estimator: Estimator[Any],
        source: ReferenceSource[Any],
        controller: Controller[Any],
        observers: Sequence[Observer],
        bound: Array | None,
    ) -> None:
        self._parts = (plant, estimator, source, controller)
        self._most = () if bound is None else tuple(bound.tolist())
        taken = [unchanged(observer, "take_block") for observer in observers]
        self._observers = [take for take in taken if take is not None]
        faced = all(unchanged(part, "compiled_face") is not None for part in self._parts)
        self.possible = faced and len(self._observers) == len(taken)
        """False: not with these parts or observers"""
        self._form: BlockForm | None = None
        self._numbers, self._wall = np.empty((0, 0)), np.empty((MOST, 2))
        self._rest, self._pause, self._ticks = 0, 1, _FIRST

    def run(self, at: Standing | None, clock: Iterator[object]) -> Ran | None:
        """Runs a block; None: the next tick is for Python. Of the clock it takes a period for each tick.

        Args:
            at: None: the next tick is for Python.
            clock: if it is no range, somebody waits for its periods.
        """
        if at is None or type(clock) is not _RANGE:
            return None
        if self._rest:
            self._rest -= 1
            return None
        ran = self._attempt(at, min(length_hint(clock), self._ticks, MOST))
        if ran is None:
            self._rest, self._pause = self._pause, min(2 * self._pause, MOST)
            return None
        self._pause = 1
        deque(islice(clock, ran.ticks), maxlen=0)
        return ran

    def show(self, ran: Ran) -> None:
        """Shows a block to the observers, whose errors are their own."""
        for take in self._observers:
            take(ran.rows)

    # ------------------------------------------------------------------ inside

    def _attempt(self, at: Standing, most: int) -> Ran | None:
        plant, estimator, source, controller = self._parts
        known = _asked(lambda: face_of(source, KnownReferences, at.estimate, at.states[1]))
        if known is None or not most:
            return None
        form = self._form
        if form is None or not form.holds(at.world, at.estimate, known, at.states[2]):
            self._form = None
            robot = face_of(plant, CompiledPlant, at.world)
            believes = face_of(estimator, CompiledEstimator, at.measurement, at.states[0], at.estimate)
            asks = face_of(controller, CompiledController, at.estimate, at.states[2])
            if robot is None or believes is None or asks is None:
                return None
            form = self._form = BlockForm.of(
                Faces(robot, believes, known, asks), at.world, at.states[2], self._most, plant.noisy
            )
        return None if form is None else self._run(form, known, at, most)

    def _run(self, form: BlockForm, known: KnownReferences, at: Standing, most: int) -> Ran | None:
        faces, rows = form.faces, self._rows(form.width)
        times = faces.plant.begin(most)
        if times[0] != at.measurement.time:
            return None
        count = _asked(lambda: known.fill(times, rows[:most, form.reference])) or 0
        rows[0, 0], rows[0, form.measurement] = at.measurement.time, faces.plant.numbers(at.measurement)
        est, ref, ctl = at.states
        memory = np.concatenate([faces.estimator.memory(est), faces.controller.memory(ctl)])
        begun = time.perf_counter()
        ticks, _ = form.block.run(rows, count, memory, self._wall)
        if not ticks:
            return None
        self._ticks = max(1, int(_LONGEST * ticks / (time.perf_counter() - begun)))
        last, after = form.tick(rows[ticks - 1].copy()), rows[ticks].copy()
        own = form.memory_of_estimator
        states = (
            faces.estimator.state(memory[:own], est),
            known.after(ref, ticks),
            faces.controller.state(memory[own:], ctl),
        )
        numbers = after[form.measurement]
        measurement = faces.plant.measurement(float(after[0]), numbers)
        stands = Standing(measurement, at.world, last.estimate, last.reference, last.command, states)
        wall = {"plan": self._wall[:ticks, 0], "control": self._wall[:ticks, 1]}
        shown = Rows(rows[:ticks], form.tick, wall)
        return Ran(stands, ticks, last.measurement, shown, lambda: faces.plant.passed(ticks, numbers))

    def _rows(self, width: int) -> Array:
        """(MOST + 1, width), used again and again."""
        if self._numbers.shape[1] != width:
            self._numbers = np.zeros((MOST + 1, width))
        return self._numbers


def _asked(question: Callable[[], _Answer]) -> _Answer | None:
    """An answer about references to come; None where one cannot be made: Python finds out why, in its own tick."""
    try:
        return question()
    except Exception:
        return None
