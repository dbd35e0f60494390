"""The compiled face of a predictive controller."""

from __future__ import annotations

from collections.abc import Mapping
from math import prod
from typing import Any

import numpy as np

from pliant._mpc import ControllerState, ControllerStep, StepPart
from pliant.compiled import CompiledController, Sample, place_of
from pliant.signals import Command, Preview, Reference
from pliant.spatial import Array


class CompiledMpc(CompiledController):
    """A predictive controller with one state, which is its own memory.

    Args:
        core: compiled.
        state: consumed.
        frames: the controlled one and that of the contact.
        n: joints.
        channels: names of the diagnostics and their values, as they lie in a command.
    """

    def __init__(
        self,
        core: ControllerStep,
        state: ControllerState,
        frames: tuple[str, str],
        n: int,
        channels: Mapping[str, float | Array],
    ) -> None:
        self._core, self._state, self._frames, self._n = core, state, frames, n
        self._shapes = {name: np.shape(value) for name, value in channels.items()}
        self.size = 2 * n + sum(map(prod, self._shapes.values()))

    def fits(self, reference: Reference, state: Any) -> bool:
        tasks = reference.tasks
        return state is self._state and len(tasks) == 1 and tasks[0].frame == self._frames[0]

    def command(self, time: float, numbers: Array) -> Command:
        n, begin = self._n, 2 * self._n
        channels: dict[str, float | Array] = {}
        for name, shape in self._shapes.items():
            end = begin + prod(shape)
            channels[name] = numbers[begin:end].reshape(shape) if shape else numbers.item(begin)
            begin = end
        return Command(time, numbers[:n], numbers[n : 2 * n], channels)

    def part(self, given: Sample, begin: int) -> StepPart | None:
        estimate, reference, frame = given.estimate, given.reference, self._frames[1]
        (task,), preview = reference.tasks, reference.preview
        wanted: dict[str, Array | None] = {
            "q": estimate.q,
            "v": estimate.v,
            "torque": estimate.torque,
            "wrench": estimate.wrenches.get(frame),
            "disturbance": estimate.disturbance,
            "position": task.position,
            "rotation": task.rotation,
            "velocity": task.velocity,
            "pressed": task.wrench,
            "task_rotation": task.task_rotation,
            "posture": reference.posture,
            **({} if preview is None else _of_preview(preview)),
        }
        places = {name: place_of(array, given.row) for name, array in wanted.items() if array is not None}
        found = {name: place for name, place in places.items() if place is not None}
        if len(found) < len(places):
            return None
        more = {"time": 0, "contact": given.contacts.get(frame), "environment": given.environments.get(frame)}
        found |= {name: place for name, place in more.items() if place is not None}
        names, phases = given.names
        if preview is not None:
            found |= {"has_ahead": given.ahead, "phases": phases}
        count = 0 if preview is None else len(preview.time)
        return StepPart(self._core, self._state, found, count, reference.phase, list(names), begin)

    def memory(self, state: Any) -> Array:
        return np.empty(0)

    def state(self, memory: Array, before: Any) -> Any:
        return before


def _of_preview(preview: Preview) -> dict[str, Array | None]:
    return {
        "instants": preview.time,
        "positions": preview.position,
        "rotations": preview.rotation,
        "velocities": preview.velocity,
        "wrenches": preview.wrench,
        "postures": preview.posture,
        "task_rotations": preview.task_rotation,
    }
