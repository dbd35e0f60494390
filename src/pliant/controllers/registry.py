"""The controllers of this package by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pliant.controllers.advice import advise, advise_damping, sentences, smallest_inertia
from pliant.controllers.attractor import Law
from pliant.controllers.config import OperationalSpaceConfig, StackConfig
from pliant.controllers.damping import Damping
from pliant.controllers.operational_space import OperationalSpace
from pliant.controllers.presets import STIFF_STACK
from pliant.controllers.stack import Stack, needs_of_law
from pliant.controllers.suggest import (
    OPERATIONAL_SPACE_RULES,
    STACK_RULES,
    suggest_operational_space,
    suggest_stack,
)
from pliant.entries import ControllerEntry
from pliant.interfaces import Needs
from pliant.robot import Robot


def build_stack(robot: Robot, config: StackConfig, period: float) -> Stack:
    """A stack from its configuration, for a control period in s."""
    return Stack(
        robot,
        config.frame_tasks(),
        period,
        law=config.law,
        phases=config.phases,
        damping=Damping(config.joint_damping, config.motion_damping),
        gravity_compensation=config.gravity_compensation,
    )


def build_operational_space(robot: Robot, config: OperationalSpaceConfig, period: float) -> OperationalSpace:
    """An operational-space controller from its configuration; its law knows no period."""
    return OperationalSpace(robot, **config.model_dump())


def advise_stack(robot: Robot, config: StackConfig, period: float, late: float | None = None) -> tuple[str, ...]:
    """Warnings about a stack on a robot at its home.

    Args:
        robot: as believed.
        config: of the stack.
        period: s, of control.
        late: s, period and delays of the loop; None: the period.
    """
    found = list(advise_damping(config.motion_damping, period if late is None else late))
    for task in config.frame_tasks():
        inertia = smallest_inertia(robot, task.frame)[: task.axes]
        advices = sentences(advise(task.tuning, period, inertia, shape=task.shape))
        found += [f"task {task.label!r}, {text}" for text in advices]
    return tuple(found)


_PASSIVE = "energy out of each axis ≤ stored + supplied (docs/controllers.md says when)"


def _stack(name: str, law: Law, summary: str) -> ControllerEntry[StackConfig]:
    default = STIFF_STACK.model_copy(update={"law": law})
    return ControllerEntry(
        name,
        summary,
        default,
        build_stack,
        lambda robot, config, believed: advise_stack(robot, config, believed.period, believed.late),
        family="stack",
        guarantees=_PASSIVE if law is Law.CAPPED else "–",
        needs=lambda config: needs_of_law(config.law),
        suggest=suggest_stack,
        rules=STACK_RULES,
        fixed={"law": law},
    )


CONTROLLERS: Mapping[str, ControllerEntry[Any]] = {
    entry.name: entry
    for entry in (
        _stack(
            "stack", Law.CAPPED, "stack of fractal impedances with the capped convergence law and a passivity account"
        ),
        _stack("stack-paper", Law.STACK_PRINTED, "the same with the law of Tiseo et al. 2020, Algorithm 1, as printed"),
        _stack("stack-corrected", Law.STACK_CORRECTED, "the same with the sign of that law reversed"),
        _stack("stack-hapfic", Law.HAPFIC, "the same with the law of Tiseo et al. 2021, eq. 1, as printed"),
        _stack(
            "spring",
            Law.SPRING,
            "the same force profiles as plain springs, without an attractor; it comes to rest by joint_damping alone",
        ),
        ControllerEntry(
            "operational-space",
            "Khatib's operational-space controller with a dynamically consistent posture; presses along force axes",
            OperationalSpaceConfig(),
            build_operational_space,
            family="operational-space",
            regulates_force=True,
            needs=lambda config: Needs(posture=True, wrench=config.force_integral > 0.0),
            suggest=suggest_operational_space,
            rules=OPERATIONAL_SPACE_RULES,
        ),
    )
}
"""name → entry"""
