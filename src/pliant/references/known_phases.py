"""References of one phase of a task as numbers, for blocks of ticks without Python."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import prod
from typing import Any

import numpy as np

from pliant._values import Views
from pliant.compiled import KnownReferences
from pliant.signals import Preview, Reference, TaskReference
from pliant.spatial import Array

Step = Callable[[float, Any], tuple[Reference, Any]]
"""time in s and the source's state → reference, next state"""


class KnownPhase(KnownReferences):
    """References of a phase that ends by the clock alone. What does not depend on the robot is stepped ahead in Python.

    Args:
        sample: a reference of the phase, with a preview if there are any.
        names: of all phases.
        step: of the source.
        state: of the source, in the phase.
        until: s of the loop's clock, the end of the phase.
    """

    def __init__(self, sample: Reference, names: Sequence[str], step: Step, state: Any, until: float) -> None:
        self._sample, self._step, self._state, self._until = sample, step, state, until
        self._states: list[Any] = []
        self._shapes = [None if part is None else part.shape for part in _arrays(sample)]
        places: list[list[int]] = []
        end = 0
        for shape in self._shapes:
            if shape is not None:
                places.append([end, *shape])
                end += prod(shape)
        self._views = Views(places).of
        self.size = self._end = end
        self.names = tuple(names), end
        self._index = {name: float(i) for i, name in enumerate(names)}
        self._nodes = 0 if sample.preview is None else len(sample.preview.time)
        if self._nodes:
            self.ahead, self.size = end + self._nodes, end + self._nodes + 1

    def reference(self, time: float, numbers: Array) -> Reference:
        views = iter(self._views(numbers))
        parts: list[Any] = [None if shape is None else next(views) for shape in self._shapes]
        position, velocity, acceleration, wrench, rotation, axes, posture = parts[:7]
        (task,) = self._sample.tasks
        made = TaskReference(
            task.frame, position, rotation, velocity, acceleration, wrench, task.tuning, axes, task.modes
        )
        preview = None
        if self._nodes and numbers[self.ahead]:
            instants, positions, velocities, wrenches, rotations, turned, postures = parts[7:]
            known = self.names[0]
            phases = tuple([known[int(i) % len(known)] for i in numbers[self._end : self.ahead]])
            preview = Preview(instants, positions, rotations, velocities, wrenches, phases, postures, turned)
        return Reference(time, (made,), posture, self._sample.phase, preview)

    def fill(self, times: Array, rows: Array) -> int:
        state, self._states = self._state, []
        for row, time in zip(rows, times.tolist(), strict=True):
            if time >= self._until:
                break
            reference, state = self._step(time, state)
            if not self._write(reference, row):
                break
            self._states.append(state)
        return len(self._states)

    def after(self, state: Any, ticks: int) -> Any:
        return self._states[ticks - 1]

    def _write(self, reference: Reference, row: Array) -> bool:
        """False: a reference of another structure."""
        arrays, shapes = _arrays(reference), self._shapes
        if [None if part is None else part.shape for part in arrays] != shapes[: len(arrays)]:
            return False
        given = [part.ravel() for part in arrays if part is not None]
        flat = np.concatenate(given)
        row[: len(flat)] = flat
        if self._nodes:
            preview = reference.preview
            row[self.ahead] = preview is not None
            if preview is not None:
                row[self._end : self.ahead] = [self._index[name] for name in preview.phase]
        return reference.phase == self._sample.phase


def _arrays(reference: Reference) -> list[Array | None]:
    """Arrays of a reference, then those of its preview if there is one."""
    (task,), preview = reference.tasks, reference.preview
    found = [task.position, task.velocity, task.acceleration, task.wrench, task.rotation, task.task_rotation]
    found.append(reference.posture)
    if preview is None:
        return found
    found += [preview.time, preview.position, preview.velocity, preview.wrench, preview.rotation]
    return [*found, preview.task_rotation, preview.posture]
