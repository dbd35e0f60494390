"""Which values of a configuration most people turn, and which they leave alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from pliant.experiments.base_config import CaseConfig
from pliant.live.page.fields import FieldGroup, Leaf

_TURNED = frozenset({
    "weight", "stiffness", "damping", "gain", "damping_ratio", "posture_stiffness", "force_integral", "joint_damping",
    "force_damping", "force_max", "range", "speed",
})  # fmt: skip
"""last parts of the keys of parameters: gains, and the bounds that keep contact safe"""
_OF_EVERY_RUN = frozenset(CaseConfig.model_fields) - {"robot"}
_SELDOM = _OF_EVERY_RUN | {
    "format", "check", "description", "sensor", "velocity_share", "torque_step", "simulation", "compensates", "moves",
    "joints", "sensors", "noise", "solver",
}  # fmt: skip
"""first parts of the keys of a case: of every run, of the robot's wiring and of how the world is computed"""


def is_basic_parameter(leaf: Leaf) -> bool:
    """Whether a parameter of a controller is a gain or a bound."""
    return leaf.path[-1] in _TURNED


def is_basic_value(leaf: Leaf) -> bool:
    """Whether a value of a case says what is done, and where."""
    return leaf.path[0] not in _SELDOM


def apart(group: FieldGroup, basic: Callable[[Leaf], bool]) -> tuple[FieldGroup, FieldGroup]:
    """The basic and the advanced values of a group. A group without basic values has no advanced ones."""
    first = _kept(group, basic)
    if not any(True for _ in first.leaves()):
        return group, replace(group, entries=())
    return first, _kept(group, lambda leaf: not basic(leaf))


def _kept(group: FieldGroup, keep: Callable[[Leaf], bool]) -> FieldGroup:
    entries: list[Leaf | FieldGroup] = []
    for entry in group.entries:
        if isinstance(entry, Leaf):
            entries += [entry] if keep(entry) else []
        else:
            inner = _kept(entry, keep)
            entries += [inner] if inner.entries else []
    return replace(group, entries=tuple(entries))
