"""What wiring derives from what is believed: numbers, frames and filters, one by one."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from pliant.entries import Believed
from pliant.estimation import JointStateFilter
from pliant.estimation.environment import EnvironmentEstimator
from pliant.interfaces import Controller, Needs
from pliant.robot import Robot
from pliant.wiring.estimators import SensorFilters, estimator_for
from pliant.wiring.plugins import entry_of
from pliant.wiring.registry import find_controller


def test_the_environment_is_looked_for_at_the_frame_that_presses_or_the_first(lwr4: Robot) -> None:
    needs = Needs(environment=True)
    first = estimator_for(needs, lwr4, Believed(("flange", "elbow"), 1e-3), SensorFilters())
    pressed = estimator_for(needs, lwr4, Believed(("flange", "elbow"), 1e-3, presses="elbow"), SensorFilters())
    assert isinstance(first, EnvironmentEstimator)
    assert isinstance(pressed, EnvironmentEstimator)
    assert (first.frame, pressed.frame) == ("flange", "elbow")


@pytest.mark.parametrize(
    ("memory", "calm", "filtered"), [(0.0, True, False), (None, True, True), (None, False, False), (0.2, False, True)]
)
def test_joints_are_filtered_where_that_is_asked_for(
    memory: float | None, calm: bool, filtered: bool, lwr4: Robot
) -> None:
    made = estimator_for(Needs(calm=calm), lwr4, Believed(("flange",), 1e-3), SensorFilters(joint_memory=memory))
    assert isinstance(made, JointStateFilter) is filtered


@dataclass
class Own(Controller[None]):
    """The first line says what it is.

    The others do not.
    """


def test_the_first_line_of_a_controllers_own_text_is_its_summary() -> None:
    assert entry_of(Own, "mine:Own").summary == "The first line says what it is."


@pytest.mark.parametrize(("late", "stiffness"), [(1e-3, 60.0), (2e-3, 60.0), (6e-3, 60.0 * 3.0 / 7.0)])
def test_a_wrist_turns_more_softly_in_a_later_loop(late: float, stiffness: float, lwr4: Robot) -> None:
    """At most 60 N·m/rad · 3 ms / lateness; the position keeps its gains."""
    entry = find_controller("stack")
    believed = Believed(("flange", "elbow"), 1e-3, computation_delay=late)
    tool = entry.suggest(lwr4, entry.default, believed).tasks["ee"]
    assert tool.rotation.stiffness == pytest.approx(stiffness)
    assert tool.translation.stiffness == 2500.0
