"""Force and speed of a running task, turned on the first tab: what the loop then does, and in a real browser."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.experiments.base import CaseConfig
from pliant.experiments.registry import get_study
from pliant.interfaces import Lookahead
from pliant.live.link.messages import TaskScaling
from pliant.live.loop.requests import Requests, SharedState
from pliant.live.loop.steered_source import SPEED_RATE_LIMIT, SteeredSource
from pliant.references.foreseen import Foreseen
from pliant.references.source import FrameMotion, TrajectorySource
from pliant.references.trajectories.shapes import lemniscate
from pliant.references.trajectories.waypoints import wrench_steps
from pliant.signals import Estimate, Reference

H, NOTHING = 1e-3, np.zeros(2)


def task() -> CaseConfig:
    """A perfect arm on a table, drawing circles; short ways down and up."""
    study = get_study("polish-circle")
    changes = {
        "surface": {"pose": {"xyz": (0.55, 0.0, 0.1)}},
        "path": {"size": (0.06, 0.06), "turns": 20.0},
        "force": {"normal": 20.0},
        "limits": {"force": 40.0, "speed": 0.2},
        "phases": {"stand_off": 0.01, "press": 0.2},
        "timing": {"sensing_delay": 0.0, "computation_delay": 0.0},
        "truth": {"shift": 0.0, "tilt": 0.0, "imperfections": "none"},
        "accept": {},
    }
    return merged(study.case("polish-circle"), changes)


def test_a_task_says_what_may_be_turned_and_how_far() -> None:
    force, speed = task().dials
    assert (force.name, force.unit, force.value, force.high) == ("force", "N", 20.0, 40.0)
    assert (speed.name, speed.unit, speed.value, speed.high) == ("speed", "m/s", 0.05, 0.2)
    free, pressed = get_study("figure8-plain").case("figure8-plain"), get_study("floor").case("floor")
    assert free.dials == ()  # nothing is pressed, and its motion is not along a path
    assert [(dial.name, dial.value, dial.high) for dial in pressed.dials] == [("force", 80.0, 160.0)]
    assert get_study("stack").case("singular").dials == ()


def told(turns: Sequence[tuple[float, TaskScaling]], seconds: float) -> tuple[list[Reference], SharedState]:
    """References of a figure-8 while somebody turns the sliders. Args: turns: s and what then."""
    motion = FrameMotion("tool", lemniscate(1.0, np.zeros(3), 0.1, 0.05, np.eye(3)[0], np.eye(3)[1]), np.eye(3))
    shared, found = SharedState(), list[Reference]()
    source = SteeredSource(Foreseen(TrajectorySource([motion]), Lookahead(4, 0.01)), shared)
    state: Any = None
    for tick in range(round(seconds / H)):
        estimate = Estimate(5.0 + tick * H, NOTHING, NOTHING, NOTHING, NOTHING)
        wished = [turned for time, turned in turns if time <= tick * H]
        shared.requests = Requests(scaling=wished[-1] if wished else TaskScaling())
        state = source.init(estimate) if state is None else state
        reference, state = source.step(estimate, state)
        found.append(reference)
    return found, shared


def test_who_turns_nothing_changes_nothing() -> None:
    plain, _ = told([], 0.5)
    motion = lemniscate(1.0, np.zeros(3), 0.1, 0.05, np.eye(3)[0], np.eye(3)[1])
    for tick, reference in enumerate(plain):
        np.testing.assert_allclose(reference.tasks[0].position, motion.at(tick * H).value, atol=1e-12)


@pytest.mark.parametrize("speed", [0.2, 0.5, 3.0])
def test_another_speed_is_the_same_way_with_true_rates(speed: float) -> None:
    """On the same curve, continuous, with velocities and accelerations that are its derivatives, nodes that are later
    references, and the clock of the task as far as it went."""
    found, shared = told([(0.1, TaskScaling(speed=speed)), (2.4, TaskScaling(speed=1.0))], 3.5)
    place = np.array([reference.tasks[0].position for reference in found])
    rates = np.array([reference.tasks[0].velocity[:3] for reference in found])
    bends = np.array([reference.tasks[0].acceleration[:3] for reference in found])
    np.testing.assert_allclose(rates[1:-1], (place[2:] - place[:-2]) / (2 * H), atol=2e-2 * max(speed, 1.0))
    np.testing.assert_allclose(
        bends[1:-1], (rates[2:] - rates[:-2]) / (2 * H), atol=0.2 * max(speed, 1.0) ** 2 + SPEED_RATE_LIMIT
    )
    steady = 2200  # tick: the turn is over (from 1 to 3 it takes 2 s), and the next one has not begun
    ahead = found[steady].preview
    assert ahead is not None
    for node in range(5):
        later = np.array([np.interp(ahead.time[node], 5.0 + H * np.arange(len(place)), place[:, i]) for i in range(3)])
        np.testing.assert_allclose(ahead.position[node], later, atol=1e-4)
    done = shared.clock - 5.0
    assert done == pytest.approx(float(np.trapezoid(rate_of(speed), dx=H)), abs=5e-3)


def rate_of(speed: float) -> np.ndarray:
    """What the rate of the clock should have been."""
    rate, found = 1.0, list[float]()
    for tick in range(3500):
        wanted = speed if 0.1 <= tick * H < 2.4 else 1.0
        rate += float(np.clip(wanted - rate, -SPEED_RATE_LIMIT * H, SPEED_RATE_LIMIT * H))
        found.append(rate)
    return np.array(found)


def test_a_force_is_turned_at_once() -> None:
    shared = SharedState()
    motion = FrameMotion("tool", lemniscate(1.0, np.zeros(3), 0.1, 0.05, np.eye(3)[0], np.eye(3)[1]), np.eye(3),
                         wrench_steps([0.0], [20.0]))  # fmt: skip
    source = SteeredSource(TrajectorySource([motion]), shared)
    estimate = Estimate(0.0, NOTHING, NOTHING, NOTHING, NOTHING)
    shared.requests = Requests(scaling=TaskScaling(force=0.25))
    reference, _ = source.step(estimate, source.init(estimate))
    assert reference.tasks[0].wrench[2] == 5.0
