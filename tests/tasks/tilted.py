"""A list of phases that presses and slides on a plane, level or tilted."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from pliant import run
from pliant.spatial import Array
from pliant.studies.task.measure_list import within
from pliant.tasks.task import Task
from pliant.telemetry.log import Log

FORCE = 15.0  # N
_HOME = np.array([0.7506, 0.0458, 0.0233])  # m, of the tool of iiwa14
_RADIUS, _GAP = 0.015, 0.02  # m
_OVER = 3.1  # s: the way down takes 0.5 s, not its 2 s, and the last phase ends by 2.8 s


def normal_of(tilt: float) -> Array:
    """(3,) of a plane tilted by degrees about the world's y axis."""
    return np.array([math.sin(math.radians(tilt)), 0.0, math.cos(math.radians(tilt))])


def tilted_task(tilt: float, controller: str, *, late: bool, gap: float = _GAP, **more: Any) -> Task:
    """Down to the plane, 15 N at rest, then 15 N along a way of 50 mm. Args: late: whether the arm is imperfect; gap: m
    between tool and plane."""
    place = _HOME - (gap + _RADIUS) * normal_of(tilt)
    below = 0.01  # m, of the frame: 5 mm into the plane
    values: dict[str, Any] = {
        "robot": "iiwa14",
        "controller": controller,
        "scene": {"plane": {"shape": "plane", "pose": {"xyz": place.tolist(), "rpy": (0.0, tilt, 0.0)}}},
        "truth": {"imperfections": "p3" if late else "none"},
        "planner": {"speed": 0.1},
        "phase": [
            {
                "name": "down",
                "frame": "plane",
                "target": (0.0, 0.0, below),
                "wrench": (0.0, 0.0, FORCE),
                "until": {"any": [{"force": 0.8 * FORCE}, {"timeout": 2.0}]},
                "else": "next",
            },
            {"name": "hold", "settle": 0.9, "duration": 1.3},
            {"name": "slide", "target": (0.04, 0.03, below), "settle": 0.2, "duration": 0.9},
        ],
    }
    if not late:
        values["timing"] = {"sensing_delay": 0.0, "computation_delay": 0.0}
    return Task.model_validate({**values, **more})


def force_error(log: Log, tilt: float) -> float:
    """Mean |F_n − F_d|, N, along the true normal, at rest and on the way."""
    time, felt = log.time("measurement/q"), log["truth/tool/wrench"][:, :3] @ normal_of(tilt)
    hold, slide = within(log, time, "hold", 0.9), within(log, time, "slide", 0.2)
    assert hold.any()
    assert slide.any()
    return float(np.mean(np.abs(felt[hold | slide] - FORCE)))


def run_tilted(tilt: float, controller: str, *, late: bool, **more: Any) -> float:
    """The force error, N, of a run that did not fail."""
    made = run(tilted_task(tilt, controller, late=late, **more), duration=_OVER)
    assert made.failure is None, made.failure
    return force_error(made.log, tilt)
