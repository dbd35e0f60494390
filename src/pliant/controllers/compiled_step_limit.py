"""The compiled face of a bound on torque steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from pliant import _guard
from pliant.compiled import CompiledController, place_of
from pliant.flat_channels import FlatChannels, FlatLayout
from pliant.signals import Command, Estimate, Reference
from pliant.spatial import Array


class CompiledStepLimit(CompiledController):
    """The bound round a controller whose diagnostics are numbers in an array.

    Args:
        core: the bound, compiled.
        inner: face of the controller inside.
        n: joints.
        size: of the memory.
        followed: layout of the controller's channels → with those of the bound.
        spendable: channel that says what may be spent.
    """

    def __init__(
        self,
        core: _guard.StepLimit,
        inner: CompiledController,
        n: int,
        followed: Callable[[FlatLayout], FlatLayout],
        spendable: str,
    ) -> None:
        self._core, self._inner, self._n, self._followed, self._spendable = core, inner, n, followed, spendable
        given = self._given(np.zeros(inner.size))
        self._layout = None if given is None else followed(given.layout)
        self.size = inner.size + 2 * n + (0 if self._layout is None else self._layout.size)

    def fits(self, reference: Reference, state: Any) -> bool:
        return self._inner.fits(reference, state.inner)

    def command(self, time: float, numbers: Array) -> Command:
        n, own = self._n, numbers[self._inner.size :]
        assert self._layout is not None
        return Command(time, own[:n], own[n : 2 * n], FlatChannels(self._layout, own[2 * n :]))

    def part(self, estimate: Estimate, reference: Reference, row: Array, begin: int) -> _guard.StepLimitPart | None:
        inner = self._inner.part(estimate, reference, row, begin)
        numbers = row[begin : begin + self._inner.size]
        command, given = self._inner.command(0.0, numbers), self._given(numbers)
        if inner is None or given is None:
            return None
        places = [place_of(part, row) for part in (estimate.q, command.torque, command.clamped, given.numbers)]
        found = [place for place in places if place is not None]
        if len(found) < len(places):
            return None
        q, torque, clamped, channels = found
        said = given.layout.places.get(self._spendable)
        spendable = channels + said if isinstance(said, int) else -1
        at = [torque, clamped, channels, given.layout.size, spendable]
        return _guard.StepLimitPart(self._core, inner, q, at, begin + self._inner.size)

    def memory(self, state: Any) -> Array:
        return np.concatenate([state.memory, self._inner.memory(state.inner)])

    def state(self, memory: Array, before: Any) -> Any:
        own = len(before.memory)
        return replace(before, memory=memory[:own], inner=self._inner.state(memory[own:], before.inner))

    def _given(self, numbers: Array) -> FlatChannels | None:
        """The inner controller's channels; None: they are no numbers in an array."""
        given = self._inner.command(0.0, numbers).diagnostics
        return given if isinstance(given, FlatChannels) else None
