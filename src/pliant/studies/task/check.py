"""Whether a robot can do a task: as believed, and in the random worlds of the seeds."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from pliant.interfaces import Lookahead
from pliant.references.postures.posture import PostureOptions
from pliant.references.reach.check import ReachCheck, check_reach
from pliant.references.reach.course import Course, course_of, course_through, instants_of
from pliant.signals import Estimate, Reference, TaskReference
from pliant.spatial import Array
from pliant.studies.task.build import refuse_path
from pliant.studies.task.build_list import listed
from pliant.studies.task.config import TaskCase
from pliant.studies.task.drawn_case import as_drawn
from pliant.studies.task.geometry import force_of, laid_out
from pliant.studies.task.landing import usual_approach
from pliant.studies.task.list_motion import Listed, planner_in_time, with_curves
from pliant.studies.task.timed import timed_source
from pliant.studies.task.world import true_surface

CHECKED_DRAWS = 10


def checked_path(case: TaskCase, drawn: int = CHECKED_DRAWS) -> ReachCheck:
    """Of a task of one path, on the believed surface and on true ones.

    Raises:
        PliantError: a robot, frame or path that there is not.
    """
    runs, case = _seeds(case, drawn), as_drawn(case)
    robot, surface, path = laid_out(case, case.robot)
    refuse_path(case, path)
    phases = case.phases
    speed = phases.approach_speed or usual_approach(case)
    course = course_of(path, force_of(case), phases.stand_off, speed, phases.leave)
    true = [true_surface(one, surface, path).geometry for one in runs]
    return check_reach(
        robot,
        case.tool.frame,
        course,
        [partial(course.on, one, case.tool.tool().reach) for one in true],
        posture=PostureOptions(spins=case.path.spins),
        nominal=robot.home,
        told_of=path.told_of,
    )


def checked_list(case: TaskCase, drawn: int = CHECKED_DRAWS) -> ReachCheck:
    """Of a list of phases: its first frame, each phase as long as it may last, with the events at the times that the
    seeds draw; without events there is one course alone.

    Raises:
        PliantError: what cannot be run.
    """
    runs, case = _seeds(case, drawn if case.event or case.draw else 0), as_drawn(case)
    made = listed(case)
    return check_reach(
        made.robot,
        made.believed.frames[0],
        _course(case),
        [partial(_course, one) for one in runs],
        nominal=made.start,
        solved=None if made.tracked is None else made.tracked.path,
        subject="the targets, and what they touch," if made.tracked is None else "the tracks",
    )


def _seeds(case: TaskCase, drawn: int) -> list[TaskCase]:
    return [as_drawn(case.model_copy(update={"seed": case.seed + index})) for index in range(drawn)]


def _course(case: TaskCase) -> Course:
    """Path of the first frame of a list if every phase lasts as long as possible."""
    made = listed(case)
    times = instants_of(made.duration)
    if made.tracked is not None:
        return course_through([made.tracked.at(time, time) for time in times.tolist()])
    if case.timed:
        return _timed_course(case, made, times)
    planner, nothing = planner_in_time(case, made), np.zeros(made.robot.n)
    estimate = Estimate(0.0, made.start, nothing, nothing, nothing)
    goal, _ = planner.inner.step(estimate, planner.inner.init(estimate))
    moving: Any = with_curves(case, made, planner)
    _, state = moving.step(estimate, moving.init(estimate))
    return course_through(moving.foreseen(goal, state, times))


def _timed_course(case: TaskCase, made: Listed, times: Array) -> Course:
    """The same for a timed list: what it foresees at its start. Args: times: (k,) s, evenly spaced."""
    ahead = Lookahead(len(times) - 1, float(times[1] - times[0]))
    source, nothing = timed_source(case, made.robot, made.start, ahead, in_time=True), np.zeros(made.robot.n)
    estimate = Estimate(0.0, made.start, nothing, nothing, nothing)
    seen = source.step(estimate, source.init(estimate))[0].preview
    assert seen is not None
    assert seen.rotation is not None
    rows = zip(seen.time.tolist(), seen.position, seen.rotation, seen.wrench, strict=True)
    frame = made.believed.frames[0]
    return course_through([Reference(t, (TaskReference(frame, x, R, wrench=w),)) for t, x, R, w in rows])
