"""A curve beside what is pressed, in lists that are not timed: it starts from rest, is foreseen, and fades."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pliant import run
from pliant.errors import ConfigError
from pliant.interfaces import Lookahead
from pliant.references.planners.curves import PhaseCurve
from pliant.references.trajectories.shapes import circle
from pliant.references.trajectories.trajectory import Hold
from pliant.signals import Estimate, Reference
from pliant.studies.task.build_list import listed
from pliant.studies.task.check import checked_list
from pliant.studies.task.config import TaskCase, case_of
from pliant.studies.task.list_motion import source_of
from pliant.tasks.task import Task

PLACE = (0.6, 0.0, 0.096)  # 4 mm below where the tool touches
CIRCLE = {"shape": "circle", "size": (0.03, 0.0), "period": 1.0, "ramp": 0.5}
ROUND: dict[str, Any] = {"name": "round", "wrench": (0.0, 0.0, 15.0), "motion": CIRCLE, "duration": 2.0}


def case_with(phase: dict[str, Any], **more: Any) -> TaskCase:
    """Down to a table, round, and to the same place again."""
    down = {"name": "down", "target": PLACE, "wrench": (0.0, 0.0, 15.0), "duration": 1.5}
    values: dict[str, Any] = {
        "robot": "iiwa14",
        "controller": "haptic",
        "timing": {"sensing_delay": 0.0, "computation_delay": 0.0},
        "simulation": {"contact": "explicit"},
        "start": {"xyz": (0.6, 0.0, 0.12), "rpy": (180.0, 0.0, 180.0)},
        "scene": {"table": {"shape": "plane", "pose": {"xyz": (0.6, 0.0, 0.085)}}},
        "phase": [down, phase, {"name": "rest", "duration": 1.0}],
    }
    return case_of(Task.model_validate({**values, **more}), "task")


def said(case: TaskCase, lookahead: Lookahead | None = None) -> list[Reference]:
    """References of a robot that stands still, every 10 ms."""
    made = listed(case)
    source, nothing = source_of(case, made, lookahead), np.zeros(made.robot.n)
    found: list[Reference] = []
    state: Any = None
    for time in np.arange(0.0, 4.5, 0.01).tolist():
        estimate = Estimate(time, made.start, nothing, nothing, nothing, contacts={"tool": True})
        state = source.init(estimate) if state is None else state
        reference, state = source.step(estimate, state)
        found.append(reference)
    return found


def test_it_goes_round_beside_the_force_from_rest_to_rest() -> None:
    found = said(case_with(ROUND))
    place = np.array([one.tasks[0].position for one in found])
    still = np.array([one.tasks[0].position for one in said(case_with({**ROUND, "motion": None}))])
    np.testing.assert_array_equal(place[:151], still[:151])  # before
    np.testing.assert_array_equal(place[-40:], still[-40:])  # the curve is gone 0.5 s after its phase
    np.testing.assert_array_equal(place[:, 2], still[:, 2])
    middle, turning = place[200] - place[200] + still[200] + [0.03, 0.0, 0.0], place[200:350]
    np.testing.assert_allclose(np.linalg.norm((turning - middle)[:, :2], axis=1), 0.03, atol=1e-9)
    velocity = np.array([one.tasks[0].velocity[:3] for one in found])
    assert np.abs(np.diff(velocity[150:], axis=0)).max() < 0.03  # 3 m/s²: no jump; the circle's own is 1.2 m/s²
    np.testing.assert_allclose(np.gradient(place[150:], 0.01, axis=0)[2:-2], velocity[152:-2], atol=2e-3)


def test_what_is_foreseen_is_what_comes() -> None:
    case, ahead = case_with(ROUND), Lookahead(30, 0.02)
    found = said(case, ahead)
    for tick in (120, 160, 300, 340, 370):
        preview = found[tick].preview
        assert preview is not None
        for node in (0, 7, 30):
            later = found[tick + 2 * node].tasks[0]
            np.testing.assert_allclose(preview.position[node], later.position, atol=1e-9)
            np.testing.assert_allclose(preview.velocity[node], later.velocity, atol=1e-9)


def test_the_check_of_reach_goes_round_as_well() -> None:
    assert checked_list(case_with(ROUND), drawn=0).reachable
    wide = case_with({**ROUND, "motion": {**CIRCLE, "size": (0.5, 0.0)}})
    assert not checked_list(wide, drawn=0).reachable


def test_a_curve_fades_smoothly() -> None:
    curve = PhaseCurve(circle(np.zeros(3), 0.1, 3.0, np.eye(3)[0], np.eye(3)[1]), 0.4)
    step = 1e-5
    for after in (0.1, 0.2, 0.3):
        before, now, then = (curve.at(1.0 + after + s, after + s) for s in (-step, 0.0, step))
        np.testing.assert_allclose((then.value - before.value) / (2.0 * step), now.rate, atol=1e-8)
        np.testing.assert_allclose((then.rate - before.rate) / (2.0 * step), now.acceleration, atol=1e-7)
    assert not np.any(curve.at(1.4, 0.4).value)
    with pytest.raises(ConfigError, match="gone within more than 0 s"):
        PhaseCurve(Hold(np.zeros(3)), 0.0)


@pytest.mark.parametrize(
    ("phase", "sentence"),
    [
        ({"motion": {**CIRCLE, "up": (0.0, 0.0, 1.0)}}, "'round': its motion goes along z, whose mode is not motion"),
        ({"motion": {**CIRCLE, "ramp": 0.0}}, "motion.ramp is above 0 s"),
        ({"motion": {"shape": "stop"}}, "motion.shape = 'stop' is for a timed list"),
    ],
)
def test_a_curve_that_cannot_be_is_refused(phase: dict[str, Any], sentence: str) -> None:
    case = case_with({**ROUND, **phase})
    with pytest.raises(ConfigError, match=sentence):
        source_of(case, listed(case), None)


@pytest.mark.study
@pytest.mark.parametrize(("controller", "most"), [("haptic", 1.0), ("offset-free-mpc", 0.1)])
def test_the_force_is_kept_while_the_tool_goes_round(controller: str, most: float) -> None:
    asked = case_with(ROUND, controller=controller).model_dump(include=set(Task.model_fields))
    made = run(Task.model_validate(asked))
    assert made.failure is None
    time = made.log.time("measurement/q")
    inside = (time > 2.2) & (time < 3.5)
    place, force = made.log["truth/tool/position"][inside], made.log["truth/tool/wrench"][inside, 2]
    assert np.ptp(place[:, :2], axis=0).min() > 0.05  # 60 mm are asked for
    assert np.abs(force - 15.0).mean() < most
