"""How the ticks of a block are made: whose the numbers of a row are, and the compiled parts that use them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant._loop import Block
from pliant.compiled import CompiledController, CompiledEstimator, CompiledPlant, KnownReferences, place_of
from pliant.signals import Estimate, Reference, Tick
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class Faces:
    """Compiled faces of the parts of a loop."""

    plant: CompiledPlant
    estimator: CompiledEstimator
    source: KnownReferences
    controller: CompiledController


class BlockForm:
    """The form of ticks whose signals have one structure. A row holds the time, s, then the numbers of the measurement,
    of what is true, of the reference, of the estimate and of the command.

    Args:
        faces: of the parts.
        world: state of the plant.
    """

    block: Block

    def __init__(self, faces: Faces, world: Any) -> None:
        self.faces, self._world = faces, world
        plant = faces.plant
        sizes = (1, plant.size, plant.truth_size, faces.source.size, faces.estimator.size, faces.controller.size)
        ends = np.cumsum(sizes).tolist()
        _, self.measurement, self._truth, self.reference, self._estimate, self._command = [
            slice(end - size, end) for end, size in zip(ends, sizes, strict=True)
        ]
        self.width: int = ends[-1]
        self.memory_of_estimator = 0

    @classmethod
    def of(cls, faces: Faces, world: Any, state: Any, most: Sequence[float]) -> BlockForm | None:
        """The form of the ticks that come; None: a part cannot read what another one writes.

        Args:
            faces: of the parts.
            world: state of the plant.
            state: of the controller.
            most: (n,) N·m that a torque may be; empty: there is no limit.
        """
        form = cls(faces, world)
        row = np.zeros(form.width)
        tick = form.tick(row)
        if not faces.controller.fits(tick.reference, state):
            return None
        estimator = faces.estimator.part(tick.measurement, row, form._estimate.start)
        controller = faces.controller.part(tick.estimate, tick.reference, row, form._command.start)
        torque = place_of(tick.command.torque, row)
        if estimator is None or controller is None or torque is None:
            return None
        form.memory_of_estimator = estimator.memory_size
        plant = faces.plant.world(torque, form.measurement.start)
        measured = [(0, 1), (form.measurement.start, faces.plant.size)]
        made = _spans([*_of_estimate(tick.estimate), *_of_reference(tick.reference)], row)
        made += _spans([tick.command.torque, tick.command.clamped], row)
        form.block = Block(form.width, estimator, controller, plant, measured, made, torque, most)
        return form

    def tick(self, row: Array) -> Tick:
        """A row (width,) → the tick, made of views of it."""
        faces, time = self.faces, row.item(0)
        numbers = row[self.measurement]
        measurement = faces.plant.measurement(time, numbers)
        estimate = faces.estimator.estimate(measurement, row[self._estimate])
        reference = faces.source.reference(time, row[self.reference])
        command = faces.controller.command(time, row[self._command])
        return Tick(measurement, estimate, reference, command, faces.plant.truth(time, numbers, row[self._truth]))

    def holds(self, world: Any, known: KnownReferences, state: Any) -> bool:
        """Whether ticks of a world, with these references and this state of the controller, are still of this form."""
        numbers = np.zeros(self.faces.source.size)
        now, before = known.reference(0.0, numbers), self.faces.source.reference(0.0, numbers)
        return world is self._world and _alike(now, before) and self.faces.controller.fits(now, state)


def _alike(now: Reference, before: Reference) -> bool:
    """Whether two references of one source differ in their numbers alone."""
    same = now.phase == before.phase and now.tuning is before.tuning and len(now.tasks) == len(before.tasks)
    return same and all(
        one.frame == other.frame and one.tuning is other.tuning and one.modes is other.modes
        for one, other in zip(now.tasks, before.tasks, strict=True)
    )


def _spans(arrays: Iterable[Array], row: Array) -> list[tuple[int, int]]:
    """(begin, size) of those that are views of a row."""
    places = [(place_of(array, row), array.size) for array in arrays]
    return [(place, size) for place, size in places if place is not None]


def _of_estimate(estimate: Estimate) -> list[Array]:
    joints = [estimate.q, estimate.v, estimate.torque, estimate.torque_sent, *estimate.wrenches.values()]
    return joints if estimate.disturbance is None else [*joints, estimate.disturbance]


def _of_reference(reference: Reference) -> list[Array]:
    found = [] if reference.posture is None else [reference.posture]
    for task in reference.tasks:
        found += [task.position, task.velocity, task.acceleration, task.wrench]
        found += [rotation for rotation in (task.rotation, task.task_rotation) if rotation is not None]
    return found
