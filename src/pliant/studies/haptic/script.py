"""What the user does over time, as references."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pliant.references.exploration.config import ExplorationConfig
from pliant.references.schedule import Schedule
from pliant.signals import ImpedanceTuning, Reference, TaskReference
from pliant.studies.haptic.config import HapticCaseConfig
from pliant.studies.haptic.steps_config import Step


@dataclass(frozen=True)
class Wish:
    """Everything that the user has set at one moment."""

    target: tuple[float, float, float]
    """m"""
    force: tuple[float, float, float]
    """N"""
    tuning: ImpedanceTuning
    exploration: ExplorationConfig
    name: str = ""

    def after(self, step: Step) -> Wish:
        """The wishes once a step was made. A value that is itself impossible is refused by its own type."""
        given = {axis: getattr(step, axis) for axis in ("stiffness", "force_max", "range")}
        changed = {axis: np.array(value) for axis, value in given.items() if value is not None}
        tuning = replace(self.tuning, **changed) if changed else self.tuning
        exploration = self.exploration
        if step.reset is not None and step.reset != exploration.reset:
            exploration = exploration.model_copy(update={"reset": step.reset})
        return Wish(step.target or self.target, step.force or self.force, tuning, exploration, step.name or self.name)

    def reference(self, frame: str) -> Reference:
        """The same as a reference for one frame."""
        wrench = np.array([*self.force, 0.0, 0.0, 0.0])
        task = TaskReference(frame, np.array(self.target), wrench=wrench, tuning=self.tuning)
        return Reference(0.0, (task,), phase=self.name, tuning=self.exploration)


def wishes(config: HapticCaseConfig, exploration: ExplorationConfig) -> list[tuple[float, Wish]]:
    """The user's wishes from each step on, with the time in s."""
    first = config.steps[0]
    assert first.target is not None
    wish = Wish(first.target, (0.0, 0.0, 0.0), config.impedance.tuning(), exploration)
    found: list[tuple[float, Wish]] = []
    for step in config.steps:
        wish = wish.after(step)
        found.append((step.time, wish))
    return found


def schedule(config: HapticCaseConfig, exploration: ExplorationConfig) -> Schedule:
    """The references that the planner starts from."""
    return Schedule([(time, wish.reference(config.frame)) for time, wish in wishes(config, exploration)])
