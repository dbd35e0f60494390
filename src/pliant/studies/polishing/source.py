"""References of the polishing task, as phases: reach, track, ramp, contact, circle, stop."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from pliant.errors import ConfigError
from pliant.interfaces import Lookahead
from pliant.references.phases import PhasedSource, TaskPhase
from pliant.references.trajectories.excerpt import Excerpt
from pliant.references.trajectories.shapes import circle
from pliant.references.trajectories.trajectory import Blend, Hold
from pliant.references.trajectories.waypoints import Waypoints, wrench_steps
from pliant.robot import Robot
from pliant.spatial import Array, rpy
from pliant.studies.polishing.config import BALL_RADIUS, FRAME, PolishingConfig

TURNED_DOWN = rpy(math.pi, 0.0, math.pi)
"""R_world_tool with the tool pointing down"""


def polishing_source(config: PolishingConfig, robot: Robot, lookahead: Lookahead | None) -> PhasedSource:
    """References of the task: reach, track (descend), ramp, contact (hold), circle or force steps, and the stop.

    Raises:
        ConfigError: times that do not increase, or a stop of something else than a circle.
    """
    task = config.task
    ends = [task.reach, task.touch, task.pressed, task.circle, *([] if task.stop is None else [task.stop])]
    if task.stop is not None and task.pattern != "circle":
        raise ConfigError(f"task.stop ends a circle; leave it out with task.pattern = {task.pattern!r}")
    if any(late <= early for early, late in pairwise([0.0, *ends])):
        raise ConfigError(f"reach, touch, pressed, circle and stop must increase, got {ends}")
    surface = touching_point(config) + np.array([0.0, 0.0, config.table.height_error])
    start, above = surface + np.array([0.0, 0.0, task.start]), surface + np.array([0.0, 0.0, task.above])
    descent = task.touch - task.reach
    below = surface - np.array([0.0, 0.0, task.above])  # where a descent that nothing stops would end
    down = [above, surface, below] if task.found else [above, surface]
    times = [0.0, descent, 2.0 * descent][: len(down)]
    at_touch = Hold(np.zeros(3))
    rising = wrench_steps([0.0, task.pressed - task.touch], [task.light, task.force], shape="ramp")
    pressing = wrench_steps([0.0], [task.force])
    phases = (
        TaskPhase("reach", Waypoints([0.0, task.reach], [start, above]), duration=task.reach),
        TaskPhase("track", Waypoints(times, down), duration=descent, ends_on_contact=task.found),
        TaskPhase("ramp", at_touch, "touch", rising, task.pressed - task.touch, touches=True),
        TaskPhase("contact", at_touch, "touch", pressing, task.circle - task.pressed, touches=True),
        *_last_phases(config),
    )
    return PhasedSource(robot, FRAME, phases, TURNED_DOWN, lookahead, robot.home)


def _last_phases(config: PolishingConfig) -> tuple[TaskPhase, ...]:
    task = config.task
    if task.pattern == "circle":
        turn, pressing = (
            circle(np.zeros(3), task.radius, task.speed).eased(task.ease),
            wrench_steps([0.0], [task.force]),
        )
        if task.stop is None:
            return (TaskPhase("circle", turn, "touch", pressing, touches=True),)
        length = task.stop - task.circle
        onward = Excerpt(turn, length, length + task.ease)
        resting = Blend(onward, Hold(turn.at(length + 0.5 * task.ease).value), task.ease)
        return (
            TaskPhase("circle", turn, "touch", pressing, length, touches=True),
            TaskPhase("stop", resting, "touch", pressing, touches=True),
        )
    count = max(1, math.ceil((config.duration - task.circle) / task.half_period))
    levels = [task.low if index % 2 == 0 else task.force for index in range(count)]
    steps = wrench_steps([task.half_period * index for index in range(count)], levels)
    return (TaskPhase("circle", Hold(np.zeros(3)), "touch", steps, touches=True),)


def touching_point(config: PolishingConfig) -> Array:
    """(3,) m, centre of the ball where it just touches the table."""
    return np.array([config.table.x, 0.0, config.table.height + BALL_RADIUS])
