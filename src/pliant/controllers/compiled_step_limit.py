"""The compiled face of a bound on torque steps."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pliant import _guard
from pliant.compiled import CompiledController, Sample, place_of
from pliant.flat_channels import FlatChannels, FlatLayout
from pliant.signals import Command, Reference
from pliant.spatial import Array


class CompiledStepLimit(CompiledController):
    """The bound round a controller that has a face.

    Args:
        core: the bound, compiled.
        inner: face of the controller inside.
        n: joints.
        followed: layout of the controller's channels → with those of the bound.
        added: names of the bound's channels.
        spendable: channel that says what may be spent.
    """

    def __init__(
        self,
        core: _guard.StepLimit,
        inner: CompiledController,
        n: int,
        followed: Callable[[FlatLayout], FlatLayout],
        added: Sequence[str],
        spendable: str,
    ) -> None:
        self._core, self._inner, self._n, self._spendable = core, inner, n, spendable
        self._added = tuple(added)
        given = self._inside(np.zeros(inner.size)).diagnostics
        self._layout = followed(given.layout) if isinstance(given, FlatChannels) else None
        self.size = inner.size + 2 * n + (len(self._added) if self._layout is None else self._layout.size)

    def fits(self, reference: Reference, state: Any) -> bool:
        return self._inner.fits(reference, state.inner)

    def command(self, time: float, numbers: Array) -> Command:
        n, own = self._n, numbers[self._inner.size :]
        channels: Mapping[str, float | Array]
        if self._layout is None:
            added = dict(zip(self._added, own[2 * n :].tolist(), strict=True))
            channels = {**self._inside(numbers[: self._inner.size]).diagnostics, **added}
        else:
            channels = FlatChannels(self._layout, own[2 * n :])
        return Command(time, own[:n], own[n : 2 * n], channels)

    def part(self, given: Sample, begin: int) -> _guard.StepLimitPart | None:
        inner, row = self._inner.part(given, begin), given.row
        command = self._inside(row[begin : begin + self._inner.size])
        asked = command.diagnostics
        flat = asked if isinstance(asked, FlatChannels) else None
        if inner is None or (flat is None and self._spendable in asked):
            return None
        channels = [] if flat is None else [flat.numbers]
        places = [place_of(part, row) for part in (given.estimate.q, command.torque, command.clamped, *channels)]
        found = [place for place in places if place is not None]
        if len(found) < len(places):
            return None
        q, torque, clamped, first = (*found, 0) if flat is None else found
        said = None if flat is None else flat.layout.places.get(self._spendable)
        spendable = first + said if isinstance(said, int) else -1
        at = [torque, clamped, first, 0 if flat is None else flat.layout.size, spendable]
        return _guard.StepLimitPart(self._core, inner, q, at, begin + self._inner.size)

    def memory(self, state: Any) -> Array:
        return np.concatenate([state.memory, self._inner.memory(state.inner)])

    def state(self, memory: Array, before: Any) -> Any:
        own = len(before.memory)
        return replace(before, memory=memory[:own], inner=self._inner.state(memory[own:], before.inner))

    def _inside(self, numbers: Array) -> Command:
        return self._inner.command(0.0, numbers)
