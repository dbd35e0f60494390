"""The task file that every run of the study is made from."""

from __future__ import annotations

from pliant.studies.task.config import TaskCase, case_of
from pliant.tasks import load_task
from pliant.tasks.parts import Pose
from pliant.tasks.phase import Phase, Thing

TASK: TaskCase = case_of(load_task("tables-2-3-4"), "tables-2-3-4")
"""[FFMPC] sections VI and VII: a circle under 50 N, by the clock"""
FRAME = TASK.tool.frame
BALL_RADIUS = TASK.tool.radius
"""m; the contact frame is the ball's middle"""
TABLE: Thing = TASK.scene["table"]
assert isinstance(TASK.start, Pose)
START: Pose = TASK.start


def phase(name: str) -> Phase:
    """A phase of the task."""
    return TASK.phase[TASK.phase_names().index(name)]


def end_of(name: str) -> float:
    """s of the run at which a phase ends."""
    place = TASK.phase_names().index(name)
    return sum(one.longest for one in TASK.phase[: place + 1])


def forces(name: str) -> tuple[float, float]:
    """N, upwards, at the beginning and the end of a phase with a profile."""
    profile = phase(name).profile
    assert profile is not None
    return profile.wrench[0][2], profile.wrench[-1][2]
