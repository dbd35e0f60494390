"""From one configuration of a controller to the next, without stopping it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from pliant.controllers.config import StackConfig
from pliant.entries import ControllerConfig, ControllerEntry
from pliant.experiments.base import CaseConfig
from pliant.interfaces import Controller
from pliant.live.page.fields import FieldGroup, Leaf, at, group_of
from pliant.references.exploration.config import ExplorationConfig
from pliant.robot import Robot
from pliant.signals import ImpedanceTuning
from pliant.studies.task.config import TaskCase
from pliant.wiring.recipes import HapticConfig


@dataclass(frozen=True, slots=True)
class ParameterChange:
    """The changes that give a running controller other parameters."""

    tunings: Mapping[str, ImpedanceTuning]
    """frame → tuning, carried by the references"""
    whole: Any
    """tuning of the whole controller, carried by the references; None if it takes none"""
    controller: Controller[Any] | None
    """a replacement, where a parameter changed that no reference carries"""


def online_fields(config: CaseConfig) -> frozenset[str]:
    """Parts of a case that references carry, in studies whose controllers have no parameters of their own."""
    if parameters_of(config) is not None:
        return frozenset()
    values = {name: getattr(config, name) for name in type(config).model_fields}
    return frozenset(name for name, value in values.items() if _is_online(value))


def online_group(config: CaseConfig) -> FieldGroup:
    """The values of these parts; a law or a shape of an impedance is not a number that a reference carries."""
    online = online_fields(config)
    group = group_of(config, skip=frozenset(type(config).model_fields) - online)
    kept: list[Leaf | FieldGroup] = []
    for part in group.entries:
        if isinstance(part, FieldGroup) and not isinstance(at(config, part.path), ExplorationConfig):
            numbers = [entry for entry in part.entries if isinstance(entry, FieldGroup) or entry.kind != "choice"]
            kept.append(replace(part, entries=tuple(numbers)))
        else:
            kept.append(part)
    return replace(group, entries=tuple(kept))


def retuning_of_case(config: CaseConfig) -> ParameterChange:
    """The same for the parts that `online_fields` names."""
    parts = [getattr(config, name) for name in sorted(online_fields(config))]
    frame = str(getattr(config, "frame", ""))
    tuning = next((part.tuning() for part in parts if not isinstance(part, ExplorationConfig)), None)
    tunings = {} if tuning is None else {frame: tuning}
    whole = next((part for part in parts if isinstance(part, ExplorationConfig)), None)
    return ParameterChange(tunings, whole, None)


def _is_online(value: Any) -> bool:
    if isinstance(value, ExplorationConfig):
        return True
    find = getattr(value, "tuning", None)
    return callable(find) and isinstance(find(), ImpedanceTuning)


def parameters_of(config: CaseConfig, suited: ControllerConfig | None = None) -> ControllerConfig | None:
    """Typed parameters of the controller that a case has chosen; None if its study offers none.

    Args:
        config: of the case.
        suited: parameters as its loop was built; the configuration of a task holds changes of them alone.

    Raises:
        ConfigError: a parameter that breaks a rule.
    """
    if isinstance(config, TaskCase):
        return None if suited is None else config.entry.changed(suited, config.control.get(config.controller, {}))
    find = getattr(config, "parameters", None)
    found = find() if callable(find) else None
    return found if isinstance(found, ControllerConfig) else None


def retuning(
    before: ControllerConfig, after: ControllerConfig, config: CaseConfig, robot: Robot, period: float
) -> ParameterChange:
    """The changes from one set of parameters to another.

    Args:
        before: of the controller that runs.
        after: wanted.
        config: of the case, whose `entry` builds controllers.
        robot: of the loop.
        period: control period, s.

    Raises:
        PliantError: no controller can be built from `after`.
    """
    tunings = after.impedances()
    whole = after.whole_tuning()
    if _structure(before) == _structure(after) and (tunings or whole is not None):
        return ParameterChange(tunings, whole, None)
    entry = getattr(config, "entry", None)
    if not isinstance(entry, ControllerEntry):
        return ParameterChange(tunings, whole, None)
    return ParameterChange(tunings, whole, entry.build(robot, after, period))


def _structure(config: ControllerConfig) -> Any:
    """What the references cannot carry: everything but the numbers of impedances and of exploration."""
    if isinstance(config, HapticConfig):
        return _structure(config.impedance), config.exploration is None
    values = config.model_dump()
    if not isinstance(config, StackConfig):
        return values
    kept = {
        label: None if task is None else (task["frame"], task["profile"], task["rotation"] is None)
        for label, task in values["tasks"].items()
    }
    return {**values, "tasks": kept}


def wiring_of(config: CaseConfig) -> dict[str, Any]:
    """What decides how a loop is built, without the parameters that can be changed while it runs."""
    values = config.model_dump()
    values.pop("control", None)
    return values
