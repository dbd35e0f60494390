"""The compiled face of a chain of estimators."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from pliant._estimation import ChainPart, Stage
from pliant.compiled import CompiledEstimator, place_of
from pliant.frozen import changed
from pliant.signals import Estimate, Measurement
from pliant.spatial import Array


class CompiledChain(CompiledEstimator):
    """A chain that begins with the measurement.

    Args:
        stages: of the chain.
        frames: of the sensors that it looks at.
        size: numbers of an estimate, of which the last four are of the environment.
        touches: frame → which of them says whether it touches.
        environment: frame whose environment it finds; None: of none.
        known: whether it is known.
        found: measurement and numbers (size,) → estimate.
    """

    def __init__(
        self,
        stages: Sequence[Stage],
        frames: tuple[str, ...],
        size: int,
        touches: Mapping[str, int],
        environment: str | None,
        known: bool,
        found: Callable[[Measurement, Array], Estimate],
    ) -> None:
        self._stages, self._frames, self.size, self._found = stages, frames, size, found
        self._touches, self._environment, self._known = touches, environment, known

    def estimate(self, measurement: Measurement, numbers: Array) -> Estimate:
        found = self._found(measurement, numbers)
        return found if self._known or not found.environments else changed(found, environments={})

    def fits(self, estimate: Estimate) -> bool:
        return bool(estimate.environments) == self._known and list(estimate.contacts) == list(self._touches)

    def contacts(self, begin: int) -> Mapping[str, int]:
        return {frame: begin + place for frame, place in self._touches.items()}

    def environments(self, begin: int) -> Mapping[str, int]:
        return {} if self._environment is None else {self._environment: begin + self.size - 4}

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
