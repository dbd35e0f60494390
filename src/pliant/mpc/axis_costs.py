"""Costs of phases that ask something else of each axis: a position, a force, or nothing.

The axes are those of the task; all of a force above 0 N is along the third one. Where a position is asked for, the
cost of the position counts; where a force is, that of the force, 0 N too. Before contact an axis that presses is moved
along, and one that yields is not: it gives way at once. A free axis yields as well: with no cost at all it would stand
still against a push, since standing still is what the costs of velocity and posture ask for.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pliant.axis_modes import Asked
from pliant.frozen import changed
from pliant.interfaces import ReferenceSource
from pliant.mpc.config import Contact, MpcConfig
from pliant.mpc.costs import PhaseCosts, Term
from pliant.robot import Robot
from pliant.signals import Estimate, Reference

_FORCES: tuple[Asked, ...] = ("press", "yield", "free")
_SLACK = (10.0, 1.0)  # N/m and N·s/m of an axis whose force is measured and never asked for
_TOUCHING = " touching"


def axis_costs(
    config: MpcConfig,
    axes: Mapping[str, tuple[Asked, ...]],
    position: Term,
    turns: Mapping[str, tuple[bool, ...]],
) -> dict[str, Any]:
    """Changes of a configuration that make each phase ask of its axes what it should.

    Every phase has costs for free motion and costs for contact. The contact has three axes where a force is asked for
    beside the one that presses, and the measured force is a state; else one.

    Args:
        config: to be changed.
        axes: phase → what is asked of the three axes of its task.
        position: cost of the position on an axis where it counts.
        turns: phase → which rotations about the frame's own axes count; without an entry all do.
    """
    asked = [any(one[axis] in _FORCES for one in axes.values()) for axis in range(3)]
    three = any(asked[:2]) and config.predictive_model.force_state
    costs: dict[str, PhaseCosts] = {}
    for name, told in axes.items():
        free = _counted(position, [one in ("motion", "press") for one in told])
        touching = _counted(position, [one == "motion" for one in told])
        pressed = [one in _FORCES for one in told][slice(None) if three else slice(2, 3)]
        force, rate = (_counted(term, pressed) for term in (config.costs.force, config.costs.force_rate))
        turn = _counted(config.costs.rotation, list(turns[name])) if name in turns else None
        costs[name] = PhaseCosts(translation=free, rotation=turn)
        costs[name + _TOUCHING] = PhaseCosts(
            contact=True, translation=touching, rotation=turn, force=force, force_rate=rate
        )
    return {
        "phases": costs,
        "phase_by": "name",
        "contact": _of_axes(config.contact, asked) if three else config.contact,
    }


def _counted(term: Term, counts: list[bool]) -> Term:
    return term.model_copy(update={"activation": tuple(float(one) for one in counts)})


def _of_axes(contact: Contact, asked: list[bool]) -> Contact:
    """Three axes, of which those without a force are slack."""
    filled = {
        name: tuple(getattr(contact, name)[0] if one else slack for one in (*asked[:2], True))
        for name, slack in zip(("stiffness", "damping"), _SLACK, strict=True)
    }
    return contact.model_copy(update={"dimension": 3, **filled})


class FeltPhases(ReferenceSource[Any]):
    """Says in the preview of another source whether its phases are those with contact, as it is felt now.

    Args:
        inner: references with a preview.
        frame: that touches.
    """

    def __init__(self, inner: ReferenceSource[Any], frame: str) -> None:
        self.inner, self.frame = inner, frame

    def init(self, estimate: Estimate) -> Any:
        return self.inner.init(estimate)

    def step(self, estimate: Estimate, state: Any) -> tuple[Reference, Any]:
        reference, state = self.inner.step(estimate, state)
        preview = reference.preview
        if preview is None or not estimate.contacts.get(self.frame, False):
            return reference, state
        felt = changed(preview, phase=tuple(name + _TOUCHING for name in preview.phase))
        return changed(reference, preview=felt), state


def with_felt_phases(source: ReferenceSource[Any], robot: Robot, config: MpcConfig) -> ReferenceSource[Any]:
    """The source, whose phases are told apart by contact where the costs of the configuration are."""
    if not any(name + _TOUCHING in config.phases for name in config.phases):
        return source
    return FeltPhases(source, config.contact.frame or config.frame)
