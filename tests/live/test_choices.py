"""What the page offers to choose: whole changes of a case, and a loop that goes on where a choice cannot be."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.registry import get_study
from pliant.live.link.messages import Begin, Flow, Message, Note, Ready
from pliant.live.loop.tuning import parameters_of
from pliant.live.loop.worker import Worker
from pliant.live.page.basic import apart, is_basic_parameter
from pliant.live.page.changed_case import (
    SURFACES,
    robots_for,
    with_controller,
    with_path,
    with_robot,
    with_surface,
    with_tool,
)
from pliant.live.page.fields import group_of
from pliant.studies.task.config import TaskCase
from pliant.wiring.registry import find_controller
from tests.live.test_studies import steer

PERFECT: dict[str, Any] = {
    "timing": {"sensing_delay": 0.0, "computation_delay": 0.0},
    "truth": {"shift": 0.0, "tilt": 0.0, "imperfections": "none"},
    "accept": {},
}


def wipe() -> TaskCase:
    case = merged(get_study("wipe").case("wipe"), {"surface": {"pose": {"xyz": (0.55, 0.0, 0.1)}}})
    assert isinstance(case, TaskCase)
    return case


def test_a_tool_of_another_shape_comes_with_what_it_needs() -> None:
    """The shape alone (the control) breaks a rule of the task."""
    with pytest.raises(ConfigError, match=r"tool\.edges"):
        merged(wipe(), {"tool": {"shape": "box"}})
    box = with_tool(wipe(), "box")
    assert isinstance(box, TaskCase)
    assert box.tool.edges == (0.03, 0.03)
    assert box.simulation.contact == "explicit"
    ball = with_tool(box, "sphere")
    assert isinstance(ball, TaskCase)
    assert (ball.tool.shape, ball.tool.edges) == ("sphere", None)


@pytest.mark.parametrize("shape", SURFACES)
def test_every_surface_can_be_chosen_from_every_other(shape: str) -> None:
    """It stands where the robot reaches it; a mesh is an example's where the task has none, and its file goes again."""
    first = with_surface(wipe(), "mesh")
    assert isinstance(first, TaskCase)
    assert first.surface.file is not None
    case = with_surface(first, shape)
    assert isinstance(case, TaskCase)
    assert case.surface.shape == shape
    assert case.surface.pose is None
    assert (case.surface.file is None) == (shape != "mesh")


def test_another_robot_controller_and_path() -> None:
    assert {"iiwa14", "panda", "lwr4"} <= set(robots_for(wipe()))
    assert with_robot(wipe(), "panda").robot == "panda"
    leg = get_study("ball").case("ball")
    assert isinstance(leg, TaskCase)
    assert leg.start is not None
    other = with_robot(leg, "panda")
    assert isinstance(other, TaskCase)
    assert other.start is None  # angles of the leg's joints
    assert with_controller("wipe", wipe(), "haptic").controller == "haptic"
    circle = with_path(wipe(), "circle", (0.1, 0.08))
    assert isinstance(circle, TaskCase)
    assert (circle.path.pattern, circle.path.size) == ("circle", (0.1, 0.08))


def test_a_study_keeps_the_robot_when_its_controller_changes() -> None:
    study = get_study("polishing")
    case = with_robot(study.case(next(iter(study.cases))), "panda")
    assert with_controller("polishing", case, "haptic").robot == "panda"


@pytest.mark.parametrize("name", ["offset-free-mpc", "haptic", "stack", "operational-space"])
def test_gains_stand_apart_from_what_few_people_turn(name: str) -> None:
    """Every parameter is on one of the two sides, and each side has some."""
    group = group_of(find_controller(name).default)
    basic, advanced = apart(group, is_basic_parameter)
    sides = [{leaf.path for leaf in side.leaves()} for side in (basic, advanced)]
    assert all(sides)
    assert not sides[0] & sides[1]
    assert sides[0] | sides[1] == {leaf.path for leaf in group.leaves()}
    nothing, _ = apart(group, lambda leaf: False)
    assert nothing == group  # of parameters that nobody sorted all are shown


class Talk:
    """A link whose other side is a test."""

    def __init__(self) -> None:
        self.closed = threading.Event()
        self.said: list[Message] = []
        self._coming: list[Message] = []
        self.waiting = False

    def send(self, message: Message) -> None:
        self.said.append(message)

    def tell(self, *messages: Message) -> None:
        self._coming += messages
        self.waiting = True

    def take(self) -> list[Message]:
        coming, self._coming, self.waiting = self._coming, [], False
        return coming

    def wait(self, seconds: float) -> bool:
        time.sleep(0.001)
        return self.waiting

    def of(self, kind: type[Any]) -> list[Any]:
        return [message for message in self.said if isinstance(message, kind)]


def heard(talk: Talk, kind: type[Any], count: int) -> Sequence[Any]:
    end = time.monotonic() + 100.0
    while len(talk.of(kind)) < count:
        assert time.monotonic() < end, f"no {kind.__name__} number {count}"
        time.sleep(0.01)
    return talk.of(kind)


def test_where_a_choice_cannot_be_the_run_before_it_goes_on_and_the_reason_is_said() -> None:
    """A circle of 4 m is out of reach; without a run before it (the control) nothing runs."""
    bad, good = with_path(wipe(), "circle", (4.0, 4.0)), merged(wipe(), PERFECT)
    talk = Talk()
    thread = threading.Thread(target=Worker(talk).serve, daemon=True)  # type: ignore[arg-type]
    thread.start()
    try:
        talk.tell(Flow(), Begin("wipe", bad))
        (first,) = heard(talk, Note, 1)
        assert first.kind == "failed"
        assert not talk.of(Ready)
        talk.tell(Begin("wipe", good))
        assert heard(talk, Ready, 1)[0].refused == ""
        talk.tell(Begin("wipe", bad))
        again: Ready = heard(talk, Ready, 2)[1]
        note: Note = heard(talk, Note, 2)[1]
        assert note.kind == "refused"
        assert again.refused == note.text
        assert again.config == good
    finally:
        talk.closed.set()
        thread.join(30.0)


def test_the_parameters_of_a_task_are_turned_while_it_runs() -> None:
    """Haptic presses 20 N; its bound F_max turned down to 8 N, the contact follows; left alone (the control) it stays.

    The configuration of a task holds changes of parameters that suit it: those that are left alone stay as they were.
    """
    base = merged(get_study("press").case("press"), {**PERFECT, "controller": "haptic"})
    told = {"control": {"haptic": {"impedance": {"tasks": {"ee": {"translation": {"force_max": 8.0}}}}}}}

    def pressed(asks: Sequence[Any]) -> float:
        seen, said = steer("press", "press", 2600, 2000, asks, {**PERFECT, "controller": "haptic"})
        assert not [message for message in said if isinstance(message, Note)]
        (ready,) = [message for message in said if isinstance(message, Ready)]
        assert ready.parameters is not None
        suited, after = ready.parameters, parameters_of(merged(base, told), ready.parameters)
        assert after is not None
        assert after.model_dump()["exploration"] == suited.model_dump()["exploration"]
        truth = seen[-1].truth
        assert truth is not None
        return float(np.linalg.norm(truth.wrenches["tool"][:3]))

    assert pressed([]) == pytest.approx(20.0, rel=0.05)
    assert pressed([told]) < 12.0
