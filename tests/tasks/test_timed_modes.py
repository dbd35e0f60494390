"""Timed lists: what a phase asks of each axis, and a force that is built up."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pliant import run
from pliant.mpc.config import MpcConfig
from pliant.signals import TaskReference
from pliant.studies.task.build_list import listed
from pliant.studies.task.config import TaskCase, case_of
from pliant.studies.task.measure_list import within
from pliant.studies.task.study import of_value
from pliant.tasks.task import Task
from tests.tasks.test_curves import said

HELD = ("motion", "motion", "motion")
PLACE, WALL = (0.65, 0.0, 0.1), {"shape": "plane", "pose": {"xyz": (0.66, 0.0, 0.1), "rpy": (0.0, -90.0, 0.0)}}


def timed(modes: tuple[str, ...] | None, controller: str = "offset-free-mpc", **more: Any) -> Task:
    """The tool goes 5 mm into a wall that stands before it along x, by the clock, and stays there."""
    values: dict[str, Any] = {
        "robot": "iiwa14",
        "controller": controller,
        "timed": True,
        "timing": {"sensing_delay": 0.0, "computation_delay": 0.0},
        "start": {"xyz": (0.63, 0.0, 0.1), "rpy": (180.0, 0.0, 180.0)},
        "scene": {"wall": WALL},
        "phase": [
            {"name": "go", "target": PLACE, "modes": modes, "duration": 1.0},
            {"name": "stay", "modes": modes, "duration": 1.0},
        ],
    }
    return Task.model_validate({**values, **more})


def case(task: Task) -> TaskCase:
    return case_of(task, "task")


def of_stay(task: Task, name: str) -> np.ndarray:
    """(k, …) of a log's channel in the last 0.3 s."""
    made = run(task)
    assert made.failure is None or made.failure.startswith("no contact: frame"), made.failure
    return made.log[name][within(made.log, made.log.time("measurement/q"), "stay", 0.7)]


def test_references_and_belief_carry_what_is_asked() -> None:
    modes = ("force", "motion", "motion", "motion", "motion", "free")
    references = said(case(timed(modes, "haptic")))
    assert all(one.tasks[0].modes is not None and one.tasks[0].modes.modes == modes for one in references)
    believed = listed(case(timed(modes))).believed
    assert believed.axes["stay"] == ("motion", "motion", "yield")  # the third axis of the task is the one of 0 N
    assert believed.turns["stay"] == (True, True, False)
    plain = listed(case(timed(None))).believed
    assert not plain.axes
    assert not plain.turns
    untold: TaskReference = said(case(timed(None, "haptic")))[0].tasks[0]
    assert untold.modes is None


def test_what_a_predictive_controller_does_not_hold_is_said() -> None:
    def told(modes: tuple[str, ...], **more: Any) -> str:
        study = of_value(timed(modes, **more), "task")
        return " ".join(study.build(study.case("task")).warnings)

    assert "will not be held" not in told((*HELD, "motion", "motion", "free"))
    assert "'go' (about z), 'stay' (about z) will not be held" in told((*HELD, "motion", "motion", "force"))
    leaning = {"xyz": (0.63, 0.0, 0.1), "rpy": (150.0, 0.0, 180.0)}  # z of the world is no axis of the tool then
    assert "(about z)" in told((*HELD, "motion", "motion", "free"), start=leaning)


@pytest.mark.study
@pytest.mark.parametrize("controller", ["offset-free-mpc", "force-feedback-mpc", "haptic"])
def test_a_force_of_zero_is_a_request_by_the_clock_too(controller: str) -> None:
    name, turns = "truth/tool/wrench", ("motion", "motion", "motion")
    assert np.abs(of_stay(timed((*HELD, *turns), controller), name)[:, 0]).max() > 2.0  # the control
    assert np.abs(of_stay(timed(("force", "motion", "motion", *turns), controller), name)[:, 0]).max() < 1.0
    assert np.abs(of_stay(timed(("free", "motion", "motion", *turns), controller), name)[:, 0]).max() < 1.0


def test_a_free_rotation_has_no_weight_about_its_axis_alone() -> None:
    """The tool points down: its y axis is the world's, reversed or not, and its z axis, too."""

    def weights(*turns: str) -> tuple[float, ...]:
        parameters = listed(case(timed((*HELD, *turns)))).parameters
        assert isinstance(parameters, MpcConfig)
        for name in ("stay", "stay touching") if "free" in turns else ():
            rotation = parameters.phases[name].rotation
            assert rotation is not None
            return tuple(rotation.along(2, 3, 0.01, "rotation")[0])
        assert all(one.rotation is None for one in parameters.phases.values())
        return tuple(parameters.costs.rotation.along(2, 3, 0.01, "rotation")[0])

    held = weights("motion", "motion", "motion")
    assert min(held) > 0.0
    assert weights("motion", "free", "motion") == (held[0], 0.0, held[2])
    assert weights("motion", "motion", "free") == (held[0], held[1], 0.0)
    assert weights("free", "free", "free") == (0.0, 0.0, 0.0)


def test_a_force_is_built_up_within_its_press() -> None:
    down = {"name": "down", "target": PLACE, "duration": 0.5}
    press: dict[str, Any] = {"name": "press", "wrench": (0.0, 0.0, 25.0), "duration": 1.0}

    def force(**more: Any) -> np.ndarray:
        """(k,) N every 10 ms."""
        found = said(case(timed(None, scene={}, phase=[down, {**press, **more}])))
        return np.array([one.tasks[0].wrench[2] for one in found])

    assert not np.any(force(press=0.3)[:50])
    np.testing.assert_allclose(force(press=0.3)[50:], np.minimum(25.0 * np.arange(400) / 30.0, 25.0), atol=1e-9)
    np.testing.assert_array_equal(force()[50:], 25.0)  # by the clock, at once


@pytest.mark.study
def test_what_haptic_overshoots_when_a_force_begins_at_once() -> None:
    """In a prompt loop, after contact with a table that lies 5 mm over the target; docs/tasks.md has the numbers."""
    table = {"table": {"shape": "plane", "pose": {"xyz": (0.65, 0.0, 0.01)}}}
    felt = {"any": [{"contact": True}, {"timeout": 1.2}]}
    down = {"name": "down", "target": (0.65, 0.0, 0.02), "until": felt}
    stay = {"name": "stay", "frame": "contact", "target": (0.0, 0.0, 0.0), "wrench": (0.0, 0.0, 25.0), "duration": 2.0}
    start = {"xyz": (0.65, 0.0, 0.125), "rpy": (180.0, 0.0, 180.0)}

    def peak(press: float, damping: float) -> float:
        """N."""
        control = {"haptic": {"impedance": {"motion_damping": damping}}}
        phases = [down, {**stay, "press": press}]
        made = run(timed(None, "haptic", scene=table, start=start, phase=phases, control=control))
        assert made.failure is None
        return float(made.log["truth/tool/wrench"][:, 2].max())

    at_once, built_up, damped = peak(0.0, 0.0), peak(0.3, 0.0), peak(0.3, 30.0)
    assert at_once == pytest.approx(34.1, abs=1.0)
    assert built_up == pytest.approx(29.9, abs=1.0)
    assert damped == pytest.approx(27.9, abs=1.0)


@pytest.mark.study
def test_a_force_that_is_built_up_lands_more_gently_on_a_slope() -> None:
    """20 N across a plane of 25 degrees, from contact on."""
    s, c = np.sin(np.radians(25.0)), np.cos(np.radians(25.0))
    table = {"table": {"shape": "plane", "pose": {"xyz": (0.6, 0.0, 0.1 - 0.015 / c), "rpy": (0.0, 25.0, 0.0)}}}
    frame = {"xyz": (0.6, 0.0, 0.1), "rpy": (0.0, 25.0, 0.0)}
    start = {"xyz": (0.6 + 0.05 * s, 0.0, 0.1 + 0.05 * c), "rpy": (180.0, -25.0, 180.0)}
    felt = {"any": [{"contact": True}, {"timeout": 0.8}]}
    down = {"name": "down", "frame": frame, "target": (0.0, 0.0, -0.004), "until": felt}
    stay = {"name": "stay", "frame": "contact", "target": (0.0, 0.0, 0.0), "wrench": (20 * s, 0.0, 20 * c)}

    def peak(press: float) -> float:
        """N."""
        phases = [down, {**stay, "duration": 1.0, "press": press}]
        made = run(timed(None, "force-feedback-mpc", scene=table, start=start, locked={"A7": 0.0}, phase=phases))
        assert made.failure is None
        return float(np.linalg.norm(made.log["truth/tool/wrench"][:, :3], axis=1).max())

    assert peak(0.3) < 21.0
    assert peak(0.0) > 30.0
