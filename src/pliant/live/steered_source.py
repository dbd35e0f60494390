"""References that people change while they are followed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from pliant.interfaces import ReferenceSource
from pliant.live.desk import Desk
from pliant.live.messages import Aim
from pliant.signals import Estimate, ImpedanceTuning, Preview, Reference, TaskReference
from pliant.spatial import Array


class SteeredSource(ReferenceSource[Any]):
    """Another source's references with what the desk says: other tunings, another place, another force.

    Args:
        inner: where the references come from.
        desk: read once a step.
    """

    def __init__(self, inner: ReferenceSource[Any], desk: Desk) -> None:
        self.inner, self._desk = inner, desk

    def init(self, estimate: Estimate) -> Any:
        return self.inner.init(estimate)

    def step(self, estimate: Estimate, state: Any) -> tuple[Reference, Any]:
        reference, state = self.inner.step(estimate, state)
        wishes = self._desk.wishes
        if wishes.tunings:
            reference = _retuned(reference, wishes.tunings)
        if wishes.whole is not None:
            reference = replace(reference, tuning=wishes.whole)
        if wishes.aim != _AS_PLANNED and reference.tasks:
            reference = _aimed(reference, wishes.aim)
        return reference, state


_AS_PLANNED = Aim()


def _retuned(reference: Reference, tunings: Mapping[str, ImpedanceTuning]) -> Reference:
    tasks = [replace(task, tuning=tunings.get(task.frame, task.tuning)) for task in reference.tasks]
    return replace(reference, tasks=tuple(tasks))


def _aimed(reference: Reference, aim: Aim) -> Reference:
    first, *others = reference.tasks
    offset = np.array(aim.offset)
    preview = reference.preview and _aimed_preview(reference.preview, offset, aim.force_scale)
    return replace(reference, tasks=(_aimed_task(first, offset, aim.force_scale), *others), preview=preview)


def _aimed_task(task: TaskReference, offset: Array, force_scale: float) -> TaskReference:
    return replace(task, position=task.position + offset, wrench=force_scale * task.wrench)


def _aimed_preview(preview: Preview, offset: Array, force_scale: float) -> Preview:
    return replace(preview, position=preview.position + offset, wrench=force_scale * preview.wrench)
