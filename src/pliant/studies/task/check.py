"""Whether a robot can do a task, on the believed surface and on those that the seeds draw."""

from __future__ import annotations

from pliant.errors import ConfigError
from pliant.references.postures.posture import PostureOptions
from pliant.references.reach.check import ReachCheck, check_reach
from pliant.references.reach.course import course_of
from pliant.studies.task.config import TaskCase
from pliant.studies.task.geometry import force_of, laid_out
from pliant.studies.task.world import true_surface

_DRAWN = 10


def checked_reach(case: TaskCase, drawn: int = _DRAWN) -> ReachCheck:
    """Reach, limits, freedom, torque and speed along the whole task. Args: drawn: how many true surfaces.

    Raises:
        PliantError: a robot, frame or path that there is not; a task without a path on a surface.
    """
    if case.phase:
        raise ConfigError("`pliant task check` checks paths on a surface; this task is a list of [[phase]]")
    robot, surface, path = laid_out(case, case.robot)
    phases = case.phases
    course = course_of(path, force_of(case), phases.stand_off, phases.approach_speed, phases.leave)
    seeds = (case.model_copy(update={"seed": case.seed + index}) for index in range(drawn))
    true = [true_surface(one, surface, path).geometry for one in seeds]
    return check_reach(
        robot,
        case.tool.frame,
        course,
        true,
        case.tool.radius,
        posture=PostureOptions(spins=case.path.spins),
        nominal=robot.home,
    )
