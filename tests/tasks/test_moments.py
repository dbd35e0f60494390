"""A moment that a phase asks for about an axis: a block that stands on a plane presses with its edge."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pliant import run
from pliant.controllers.registry import CONTROLLERS
from pliant.entries import Believed
from pliant.robot import Robot
from pliant.studies.task.measure_list import within
from pliant.tasks.task import Task
from pliant.wiring.recipes import RECIPES

MOMENT = 0.2  # N·m: 15 N at 13 mm from the middle of a block of 60 mm


def mean_moment(about: str, moment: float, seconds: float = 7.5) -> float:
    """N·m about the world's y axis, mean of what comes 1.2 s after the moment is asked for."""
    held = {"wrench": (0.0, 0.0, 15.0, 0.0, moment, 0.0), "settle": 1.2, "duration": 1.5}
    down = {"name": "down", "target": (0.75, 0.0458, -0.065), "wrench": (0.0, 0.0, 15.0, 0.0, 0.0, 0.0)}
    modes = ("motion", "motion", "force", "motion", about, "motion")
    values: dict[str, Any] = {
        "robot": "iiwa14",
        "controller": "operational-space",
        "tool": {"shape": "box", "edges": (0.06, 0.06)},
        "timing": {"sensing_delay": 0.0, "computation_delay": 0.0},
        "simulation": {"contact": "explicit"},
        "scene": {"floor": {"shape": "plane", "pose": {"xyz": (0.75, 0.0458, -0.06)}, "friction": 0.3}},
        "phase": [
            {**down, "until": {"any": [{"force": 12.0}, {"timeout": 6.0}]}},
            {"name": "moment", **held, "modes": modes},
        ],
    }
    made = run(Task.model_validate(values), duration=seconds)
    assert made.failure is None, made.failure
    inside = within(made.log, made.log.time("measurement/q"), "moment", 1.2)
    return float(made.log["truth/tool/wrench"][inside, 4].mean())


@pytest.mark.study
def test_operational_space_keeps_the_mean_of_a_moment() -> None:
    assert mean_moment("force", MOMENT) == pytest.approx(MOMENT, abs=0.08)
    assert abs(mean_moment("motion", 0.0, 4.0) - MOMENT) > 0.2  # the control: the block is held level


def test_an_arm_whose_orientation_is_asked_for_has_a_stiffness_of_rotation() -> None:
    """Also in a prompt loop, for which haptic has the gains of a leg, whose foot is a ball."""
    robot, believed = Robot.load("iiwa14"), Believed(("flange",), 1e-3, oriented=True, presses="flange")
    for name, table in (("haptic", RECIPES), ("stack", CONTROLLERS)):
        entry: Any = table[name]
        config = entry.suggest(robot, entry.default, believed)
        assert config.impedances()["flange"].axes == 6
        loose = entry.suggest(robot, entry.default, Believed(("flange",), 1e-3, oriented=False))
        assert loose.impedances()["flange"].axes == 3
    assert np.all(config.impedances()["flange"].stiffness > 0.0)
