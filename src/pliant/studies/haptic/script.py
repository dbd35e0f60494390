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
class UserSettings:
    """Everything that the user has set at one moment."""

    target: tuple[float, float, float]
    """m"""
    force: tuple[float, float, float]
    """N"""
    tuning: ImpedanceTuning
    exploration: ExplorationConfig
    name: str = ""

    def after(self, step: Step) -> UserSettings:
        """The settings after a step. An impossible value is refused by its own type."""
        given = {axis: getattr(step, axis) for axis in ("stiffness", "force_max", "range")}
        changed = {axis: np.array(value) for axis, value in given.items() if value is not None}
        tuning = replace(self.tuning, **changed) if changed else self.tuning
        exploration = self.exploration
        if step.reset is not None and step.reset != exploration.reset:
            exploration = exploration.model_copy(update={"reset": step.reset})
        return UserSettings(
            step.target or self.target, step.force or self.force, tuning, exploration, step.name or self.name
        )

    def reference(self, frame: str) -> Reference:
        """The same as a reference for one frame."""
        wrench = np.array([*self.force, 0.0, 0.0, 0.0])
        task = TaskReference(frame, np.array(self.target), wrench=wrench, tuning=self.tuning)
        return Reference(0.0, (task,), phase=self.name, tuning=self.exploration)


def user_settings(config: HapticCaseConfig, exploration: ExplorationConfig) -> list[tuple[float, UserSettings]]:
    """The user's settings from each step on, with the time in s."""
    first = config.steps[0]
    assert first.target is not None
    settings = UserSettings(first.target, (0.0, 0.0, 0.0), config.impedance.tuning(), exploration)
    found: list[tuple[float, UserSettings]] = []
    for step in config.steps:
        settings = settings.after(step)
        found.append((step.time, settings))
    return found


def schedule(config: HapticCaseConfig, exploration: ExplorationConfig) -> Schedule:
    """The references that the planner starts from."""
    return Schedule([(time, settings.reference(config.frame)) for time, settings in user_settings(config, exploration)])
