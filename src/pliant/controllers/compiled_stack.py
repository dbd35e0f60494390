"""The compiled face of a stack."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from pliant import _impedance
from pliant.compiled import CompiledController, Sample, place_of
from pliant.controllers.stack_input import seen_of, target_of
from pliant.signals import Command, Reference, TaskReference
from pliant.spatial import Array


class CompiledStack(CompiledController):
    """A stack that adds nothing to the torque of its tasks.

    Args:
        core, arm: compiled.
        frames: of its tasks.
        size: numbers of a command.
        command: time in s and numbers (size,) → command.
    """

    def __init__(
        self,
        core: _impedance.Stack,
        arm: _impedance.Arm,
        frames: Sequence[str],
        size: int,
        command: Callable[[float, Array], Command],
    ) -> None:
        self._core, self._arm, self._frames = core, arm, tuple(frames)
        self.size, self._command = size, command

    def fits(self, reference: Reference, state: Any) -> bool:
        now, before = seen_of(self._targets(reference)), state.tuned.seen
        return all(a is b for one, other in zip(now, before, strict=True) for a, b in zip(one, other, strict=True))

    def command(self, time: float, numbers: Array) -> Command:
        return self._command(time, numbers)

    def part(self, given: Sample, begin: int) -> _impedance.StackPart | None:
        row = given.row
        q, targets = place_of(given.estimate.q, row), [_place(task, row) for task in self._targets(given.reference)]
        found = [target for target in targets if target is not None]
        if q is None or len(found) < len(targets):
            return None
        return _impedance.StackPart(self._core, self._arm, q, found, begin)

    def memory(self, state: Any) -> Array:
        return state.memory

    def state(self, memory: Array, before: Any) -> Any:
        return replace(before, memory=memory)

    def _targets(self, reference: Reference) -> list[TaskReference]:
        return [target_of(reference, i, frame) for i, frame in enumerate(self._frames)]


def _place(task: TaskReference, row: Array) -> tuple[int, int, list[float]] | None:
    """Where a task's reference stands in a row; None: in axes of its own, or at places that do not stay."""
    position = place_of(task.position, row)
    if position is None or task.modes is not None:
        return None
    rotation = None if task.rotation is None else place_of(task.rotation, row)
    if task.rotation is None or rotation is not None:
        return position, -1 if rotation is None else rotation, []
    return position, -1, task.rotation.ravel().tolist()
