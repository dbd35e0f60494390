"""Costs of phases that ask something else of each axis, and which of them count."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pliant.axis_modes import Asked, AxisModes
from pliant.entries import Believed
from pliant.interfaces import ReferenceSource
from pliant.mpc.axis_costs import with_felt_phases
from pliant.mpc.config import MpcConfig
from pliant.mpc.make_problem import problem_from_robot
from pliant.robot import Robot
from pliant.signals import Estimate, Preview, Reference, TaskReference
from pliant.spatial import exp3
from pliant.studies.task.pressed import asked_axes
from pliant.surfaces import PlaneSurface
from pliant.wiring.registry import find_controller

ROBOT = Robot.load("iiwa14")
TURN = exp3(np.array([0.3, -0.6, 0.2]))


def suited(controller: str, **axes: tuple[Asked, ...]) -> MpcConfig:
    surface = PlaneSurface.facing((0.0, 0.0, 1.0))
    believed = Believed(("flange",), 1e-3, presses="flange", surface=surface, axes=axes)
    entry: Any = find_controller(controller)
    config: MpcConfig = entry.suggest(ROBOT, entry.default, believed)
    return config


def counted(config: MpcConfig, phase: str, name: str) -> list[bool]:
    return (problem_from_robot(ROBOT, config).weights[phase][name][0] > 0.0).tolist()


@pytest.mark.parametrize("controller", ["offset-free-mpc", "force-feedback-mpc"])
def test_position_counts_where_motion_is_asked_for_and_force_where_a_force_is(controller: str) -> None:
    config = suited(controller, corner=("yield", "motion", "press"))
    assert config.contact.dimension == 3
    assert counted(config, "corner", "translation_weight") == [False, True, True]  # it comes down, and yields at once
    assert counted(config, "corner touching", "translation_weight") == [False, True, False]
    assert counted(config, "corner touching", "force_weight") == [True, False, True]
    stiff, slack, _ = config.contact.stiffness
    assert stiff > 10.0 * slack  # along y the tool slides: no spring is predicted there


def test_one_axis_of_contact_is_enough_for_one_force() -> None:
    config = suited("force-feedback-mpc", stay=("motion", "motion", "yield"), go=("motion", "motion", "motion"))
    assert config.contact.dimension == 1
    assert counted(config, "stay", "translation_weight") == [True, True, False]
    assert counted(config, "stay touching", "force_weight") == [True]
    assert counted(config, "go touching", "translation_weight") == [True, True, True]
    assert counted(config, "go touching", "force_weight") == [False]
    assert set(suited("force-feedback-mpc").phases) == {"free", "contact"}  # nobody asks for anything else


class Says(ReferenceSource[None]):
    """One reference with a preview of two phases."""

    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, state: None) -> tuple[Reference, None]:
        rows = np.zeros((2, 6))
        preview = Preview(np.zeros(2), rows[:, :3], None, rows, rows, ("first", "second"))
        return Reference(0.0, (TaskReference("flange", np.zeros(3)),), phase="first", preview=preview), None


def test_the_phases_of_a_preview_are_told_apart_by_the_contact_that_is_felt() -> None:
    config = suited("offset-free-mpc", first=("yield", "motion", "press"), second=("motion", "motion", "press"))
    zero = np.zeros(7)

    def names(source: ReferenceSource[Any], touches: bool) -> tuple[str, ...]:
        reference, _ = source.step(Estimate(0.0, zero, zero, zero, zero, contacts={"flange": touches}), None)
        assert reference.phase == "first"  # as people know it
        assert reference.preview is not None
        return reference.preview.phase

    source = with_felt_phases(Says(), ROBOT, config)
    assert names(source, False) == ("first", "second")
    assert names(source, True) == ("first touching", "second touching")
    assert set(names(source, True)) <= set(config.phases)
    plain = Says()
    assert with_felt_phases(plain, ROBOT, suited("offset-free-mpc")) is plain


def test_what_is_asked_is_told_in_the_axes_of_the_force() -> None:
    def told(modes: tuple[Any, ...], wrench: Any, axes: Any) -> tuple[Asked, ...] | None:
        pressed = np.concatenate([TURN @ wrench, np.zeros(3)])
        return asked_axes(
            TaskReference("flange", np.zeros(3), wrench=pressed, modes=AxisModes(modes, TURN), task_rotation=axes)
        )

    free = ("free", "free", "free")
    swapped = TURN[:, [1, 2, 0]]  # the force is along the first axis of the frame
    assert told(("force", "free", "force", *free), [9.0, 0.0, 0.0], swapped) == ("free", "yield", "press")
    assert told(("force", "motion", "motion", *free), [0.0, 0.0, 0.0], swapped) == ("motion", "motion", "yield")
    assert told(("force", "motion", "motion", *free), [9.0, 0.0, 0.0], np.eye(3)) is None
