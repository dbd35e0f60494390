"""The compiled face of a chain of estimators."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from pliant._estimation import ChainPart, Stage
from pliant.compiled import CompiledEstimator, place_of
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array


class CompiledChain(CompiledEstimator):
    """A chain that begins with the measurement.

    Args:
        stages: of the chain.
        frames: of the sensors that it looks at.
        size: numbers of an estimate.
        found: measurement and numbers (size,) → estimate.
    """

    def __init__(
        self,
        stages: Sequence[Stage],
        frames: tuple[str, ...],
        size: int,
        found: Callable[[Measurement, Array], Estimate],
    ) -> None:
        self._stages, self._frames, self.size, self._found = stages, frames, size, found

    def estimate(self, measurement: Measurement, numbers: Array) -> Estimate:
        return self._found(measurement, numbers)

    def part(self, measurement: Measurement, row: Array, begin: int) -> ChainPart | None:
        joints = (measurement.q, measurement.v, measurement.torque, measurement.torque_sent)
        places = [place_of(signal, row) for signal in joints]
        felt = [place_of(measurement.wrenches[frame], row) for frame in self._frames]
        first = felt[0] if felt else 0
        found = [place for place in (*places, first) if place is not None]
        if first is None or len(found) < 5 or felt != [first + 6 * i for i in range(len(felt))]:
            return None
        return ChainPart(self._stages, len(measurement.q), self._frames, [0, *found], begin)

    def memory(self, state: Any) -> Array:
        return state.memory

    def state(self, memory: Array, before: Any) -> Any:
        return replace(before, memory=memory)
