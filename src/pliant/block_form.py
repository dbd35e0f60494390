"""How the ticks of a block are made: whose the numbers of a row are, and the compiled parts that use them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pliant._loop import Block
from pliant.compiled import CompiledController, CompiledEstimator, CompiledPlant, KnownReferences, Sample, place_of
from pliant.signals import Estimate, Measurement, Reference, Tick
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
    def of(cls, faces: Faces, world: Any, state: Any, most: Sequence[float], noisy: frozenset[str]) -> BlockForm | None:
        """The form of the ticks that come; None: a part cannot read what another one writes.

        Args:
            faces: of the parts.
            world: state of the plant.
            state: of the controller.
            most: (n,) N·m that a torque may be; empty: there is no limit.
            noisy: fields of a measurement in which no two readings are equal.
        """
        form = cls(faces, world)
        row = np.ones(form.width)
        tick = form.tick(row)
        if not faces.controller.fits(tick.reference, state):
            return None
        estimator = faces.estimator.part(tick.measurement, row, form._estimate.start)
        controller = faces.controller.part(form._sample(tick, row), form._command.start)
        torque = place_of(tick.command.torque, row)
        if estimator is None or controller is None or torque is None:
            return None
        form.memory_of_estimator = estimator.memory_size
        plant = faces.plant.world(torque, form.measurement.start)
        known, unknown = form._environments(tick.estimate)
        form.block = Block(
            form.width,
            estimator,
            controller,
            plant,
            measured=[(0, 1), *_spans(_of_measurement(tick.measurement), row)],
            estimated=[*known, *_spans([*_of_estimate(tick.estimate), *_of_reference(tick.reference)], row)],
            made=_spans([tick.command.torque, tick.command.clamped], row),
            drawn=_spans(_drawn(tick.measurement, noisy), row),
            unknown=unknown,
            torque=torque,
            most=most,
        )
        return form

    def _sample(self, tick: Tick, row: Array) -> Sample:
        source, estimator, begin = self.faces.source, self.faces.estimator, self.reference.start
        ahead = -1 if source.ahead < 0 else begin + source.ahead
        names = (source.names[0], begin + source.names[1])
        places = estimator.contacts(self._estimate.start), estimator.environments(self._estimate.start)
        return Sample(row, tick.estimate, tick.reference, *places, ahead, names)

    def _environments(self, estimate: Estimate) -> tuple[list[tuple[int, int]], list[int]]:
        """Spans of environments that are known, and places that hold no number while others are not."""
        places = self.faces.estimator.environments(self._estimate.start)
        known = [(place, 4) for frame, place in places.items() if frame in estimate.environments]
        return known, [place for frame, place in places.items() if frame not in estimate.environments]

    def tick(self, row: Array) -> Tick:
        """A row (width,) → the tick, made of views of it."""
        faces, time = self.faces, row.item(0)
        numbers = row[self.measurement]
        measurement = faces.plant.measurement(time, numbers)
        estimate = faces.estimator.estimate(measurement, row[self._estimate])
        reference = faces.source.reference(time, row[self.reference])
        command = faces.controller.command(time, row[self._command])
        return Tick(measurement, estimate, reference, command, faces.plant.truth(time, numbers, row[self._truth]))

    def holds(self, world: Any, estimate: Estimate, known: KnownReferences, state: Any) -> bool:
        """Whether ticks of a world, with such an estimate, these references and this state of the controller, are still
        of this form."""
        faces = self.faces
        if world is not self._world or known.size != faces.source.size or not faces.estimator.fits(estimate):
            return False
        numbers = np.ones(known.size)
        now, before = known.reference(0.0, numbers), faces.source.reference(0.0, numbers)
        return _alike(now, before) and faces.controller.fits(now, state)


def _alike(now: Reference, before: Reference) -> bool:
    """Whether two references of one source differ in their numbers alone."""
    return all(a is b or a == b for a, b in zip(_structure(now), _structure(before), strict=False))


def _structure(reference: Reference) -> Iterator[object]:
    yield from (reference.phase, id(reference.tuning), len(reference.tasks), reference.posture is None)
    for task in reference.tasks:
        yield from (task.frame, id(task.tuning), id(task.modes), task.rotation is None, task.task_rotation is None)
    preview = reference.preview
    if preview is not None:
        yield from (len(preview.time), preview.rotation is None, preview.posture is None, preview.task_rotation is None)


def _spans(arrays: Iterable[Array], row: Array) -> list[tuple[int, int]]:
    """(begin, size) of those that are views of a row."""
    places = [(place_of(array, row), array.size) for array in arrays]
    return [(place, size) for place, size in places if place is not None]


def _of_measurement(measurement: Measurement) -> list[Array]:
    joints = [measurement.q, measurement.v, measurement.torque, measurement.torque_sent]
    return [*joints, *measurement.wrenches.values()]


def _drawn(measurement: Measurement, noisy: frozenset[str]) -> list[Array]:
    """What noise makes different; all wrenches are one."""
    found: list[Array] = [getattr(measurement, name) for name in noisy if name != "wrenches"]
    return [*found, *measurement.wrenches.values()] if "wrenches" in noisy else found


def _of_estimate(estimate: Estimate) -> list[Array]:
    joints = [estimate.q, estimate.v, estimate.torque, estimate.torque_sent, *estimate.wrenches.values()]
    return joints if estimate.disturbance is None else [*joints, estimate.disturbance]


def _of_reference(reference: Reference) -> list[Array]:
    found = [] if reference.posture is None else [reference.posture]
    for task in reference.tasks:
        found += [task.position, task.velocity, task.acceleration, task.wrench]
        found += [rotation for rotation in (task.rotation, task.task_rotation) if rotation is not None]
    ahead = reference.preview
    if ahead is None:
        return found
    found += [ahead.time, ahead.position, ahead.velocity, ahead.wrench]
    return found + [part for part in (ahead.rotation, ahead.task_rotation, ahead.posture) if part is not None]
