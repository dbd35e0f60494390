"""The phases of a polishing run, as changes of those in its task file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from pliant.errors import ConfigError
from pliant.studies.polishing.paper_task import BALL_RADIUS, START
from pliant.studies.polishing.work_config import RepeatedPushes, Table, Work

_LONGEST = 3600.0  # s
Place = tuple[float, float, float]


def start_pose(table: Table, work: Work) -> Mapping[str, Any]:
    """Where the tool is at the start: over the table, turned down."""
    return {"xyz": _over(table, work.start), "rpy": START.rpy}


def phase_changes(table: Table, work: Work, duration: float) -> Mapping[str, Any]:
    """Name of a phase → what of it is another one than in the task file. Args: duration: s of the run.

    Raises:
        ConfigError: times that do not increase, or a stop of something else than a circle.
    """
    ends = [work.reach, work.touch, work.pressed, work.circle, *([] if work.stop is None else [work.stop])]
    if work.stop is not None and work.pattern != "circle":
        raise ConfigError(f"task.stop ends a circle; leave it out with task.pattern = {work.pattern!r}")
    if any(late <= early for early, late in pairwise([0.0, *ends])):
        raise ConfigError(f"reach, touch, pressed, circle and stop must increase, got {ends}")
    reach, track, ramp, contact, *circle = (late - early for early, late in pairwise([0.0, *ends]))
    believed = table.height_error
    level = {"shape": "ramp", "times": (0.0, ramp), "wrench": (_up(work.light), _up(work.force))}
    begin = None if believed == 0.0 else _over(table, work.start, believed)
    changes: dict[str, Any] = {
        "reach": {"begin": begin, "target": _over(table, work.above, believed), "duration": reach},
        "track": _descent(table, work, track, duration),
        "ramp": {"profile": level, "duration": ramp},
        "contact": {"wrench": _up(work.force), "duration": contact},
        "circle": _circle(work, duration) | {"duration": circle[0] if circle else _rest(duration, work.circle)},
    }
    if work.stop is not None:  # the tool rests by the costs that drew the circle
        stop = {"shape": "stop", "ramp": work.ease}
        length = _rest(duration, work.stop)
        changes["stop"] = {"name": "stop", "like": "circle", "motion": stop, "duration": length}
    return changes


def disturbances(pushes: RepeatedPushes | None) -> tuple[Mapping[str, Any], ...]:
    """Horizontal pushes in random directions until the end of the run: the first one, and those after a gap each."""
    if pushes is None:
        return ()
    one = {"push": pushes.force, "direction": "level", "frame": pushes.frame, "duration": pushes.duration}
    if pushes.start >= pushes.gap:
        return ({**one, "start": pushes.start - pushes.gap, "gap": pushes.gap},)
    return {**one, "start": pushes.start}, {**one, "start": pushes.start + pushes.duration, "gap": pushes.gap}


def _descent(table: Table, work: Work, seconds: float, duration: float) -> Mapping[str, Any]:
    """By the timetable, or on at the same pace until contact is found."""
    touching = _over(table, 0.0, table.height_error)
    if not work.found:
        return {"target": touching, "duration": seconds}
    until = {"any": ({"contact": True}, {"timeout": max(duration, 2.0 * seconds)})}
    below = _over(table, -work.above, table.height_error)
    return {"via": (touching,), "target": below, "arrive": 2.0 * seconds, "until": until, "duration": None}


def _circle(work: Work, duration: float) -> dict[str, Any]:
    if work.pattern == "circle":
        turn = {"size": (work.radius, 0.0), "period": 2.0 * math.pi / work.speed, "ramp": work.ease}
        return {"motion": turn}
    count = max(1, math.ceil((duration - work.circle) / work.half_period))
    levels = tuple(_up(work.low if index % 2 == 0 else work.force) for index in range(count))
    times = tuple(work.half_period * index for index in range(count))
    return {"motion": {"shape": "hold"}, "profile": {"shape": "step", "times": times, "wrench": levels}}


def _rest(duration: float, begin: float) -> float:
    """s that are left of a run; one that ends before lasts as long as a phase may."""
    return duration - begin if duration > begin else _LONGEST


def _over(table: Table, height: float, error: float = 0.0) -> Place:
    """(3,) m, the ball's middle at a height over the table. Args: error: m, by how much it is believed higher."""
    return table.x, 0.0, table.height + BALL_RADIUS + error + height


def _up(force: float) -> Place:
    return 0.0, 0.0, force
