"""Checks a task on the believed surface and on possible true surfaces, and proposes a remedy."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from pliant.errors import ConfigError
from pliant.references.postures.posture import PostureOptions, PosturePath, UnreachableError, solve_posture
from pliant.references.reach.course import Course
from pliant.references.reach.margins import Margin, ReachBounds, margins
from pliant.references.reach.remedy import remedy
from pliant.robot import Robot
from pliant.spatial import Array


@dataclass(frozen=True)
class SurfaceCheck:
    """The task on one surface."""

    label: str
    """"believed", or the number of a drawn one"""
    margins: tuple[Margin, ...] = ()
    """empty where no joint path was found"""
    failure: str = ""
    """the first point that fails, with its value, in one sentence; empty: none fails"""
    time: float = math.nan
    """s from the start of the course to that point"""

    @property
    def reachable(self) -> bool:
        return not self.failure


@dataclass(frozen=True)
class ReachCheck:
    """Result of a check."""

    course: Course
    surfaces: tuple[SurfaceCheck, ...]
    """the believed one first"""
    posture: PosturePath | None
    """on the believed surface"""
    help: str = ""
    """remedy, in one sentence"""

    @property
    def reachable(self) -> bool:
        """Whether the task can be done on every surface that was checked."""
        return all(found.reachable for found in self.surfaces)

    def rows(self) -> list[tuple[str, str, str, str, str, str]]:
        """For a table: surface, quantity, worst value, bound, where, ✓ or ✗."""
        table: list[tuple[str, str, str, str, str, str]] = []
        for found in self.surfaces:
            if not found.margins:
                table.append((found.label, "reach", "–", "–", f"t = {found.time:.2f} s", "✗"))
            for margin in found.margins:
                at = margin.worst
                where = f"t = {self.course.times[at]:.2f} s {margin.joint(at)}".rstrip()
                sign = "≥" if margin.least else "≤"
                met = "✓" if margin.first_failure is None else "✗"
                bound = f"{sign} {margin.bound:.3g} {margin.unit}"
                table.append((found.label, margin.name, f"{margin.values[at]:.3g}", bound, where, met))
        return table


def check_reach(
    robot: Robot,
    frame: str,
    course: Course,
    others: Sequence[Callable[[], Course]] = (),
    bounds: ReachBounds | None = None,
    posture: PostureOptions | None = None,
    nominal: Array | None = None,
    solved: PosturePath | None = None,
    subject: str = "surface and path",
    told_of: Callable[[Array], str] = lambda _: "",
) -> ReachCheck:
    """Whether a robot can do a task.

    Args:
        robot: as it is believed.
        frame: the controlled one.
        course: of the task, as it is believed.
        others: further courses that must be possible, for possible true worlds; each is made when it is checked, and
            one that raises ConfigError is not possible.
        bounds: required margins; None: the defaults.
        posture: how its joint path is solved, and whether the rotation about the tool's axis is free; its period is
            chosen here.
        nominal: (n,) rad, as of the task.
        solved: the joint path along `course`, where the task brings its own; None: it is solved here.
        subject: what the user would have to move, for the remedy.
        told_of: what is to be said of a place (3,) m that fails, such as the line of a file that it comes from.

    Returns:
        "Reachable" is a statement on the sampled course with the joint path found, from rest over its first place; how
        a controller gets through it is another matter.
    """
    limits = bounds or ReachBounds()
    options = posture or PostureOptions()
    path, first = _check(robot, frame, course, "believed", limits, nominal, options, told_of, solved)
    found = [first]
    begin = nominal if path is None else path.postures[0]
    for number, made in enumerate(others if path is not None else (), start=1):
        try:
            other = made()
        except ConfigError as error:
            found.append(SurfaceCheck(f"drawn {number}", failure=str(error), time=0.0))
            continue
        near = replace(options, restarts=0)
        found.append(_check(robot, frame, other, f"drawn {number}", limits, begin, near, told_of)[1])
    failed = next((check for check in found if not check.reachable), None)
    if failed is None:
        return ReachCheck(course, tuple(found), path)
    words = remedy(robot, frame, course, failed.margins, limits, options.spins, nominal, subject)
    return ReachCheck(course, tuple(found), path, words)


def _check(
    robot: Robot,
    frame: str,
    course: Course,
    label: str,
    bounds: ReachBounds,
    nominal: Array | None,
    options: PostureOptions,
    told_of: Callable[[Array], str],
    solved: PosturePath | None = None,
) -> tuple[PosturePath | None, SurfaceCheck]:
    try:
        posture = solve_course(robot, frame, course, nominal, options) if solved is None else solved
    except UnreachableError as error:
        told = "" if error.place is None else told_of(error.place)
        return None, SurfaceCheck(label, failure=f"{error}{told}", time=error.time)
    left = margins(robot, frame, course, posture, bounds, options.spins)
    failing = [(margin.first_failure, margin) for margin in left if margin.first_failure is not None]
    if not failing:
        return posture, SurfaceCheck(label, left)
    sample, margin = min(failing, key=lambda each: each[0])
    x, y, z = course.places[sample]
    joint = f" of joint {margin.joint(sample)}" if margin.joint(sample) else ""
    words = (
        f"at t = {course.times[sample]:.2f} s, ({x:.3f}, {y:.3f}, {z:.3f}) m, {margin.name}{joint} is"
        f" {margin.values[sample]:.3g} {margin.unit}, must be {'at least' if margin.least else 'at most'}"
        f" {margin.bound:.3g}{told_of(course.places[sample])}"
    )
    return posture, SurfaceCheck(label, left, words, float(course.times[sample]))


def solve_course(
    robot: Robot, frame: str, course: Course, nominal: Array | None, options: PostureOptions
) -> PosturePath:
    """Joint path of a course. Raises UnreachableError."""
    seconds = float(course.times[-1])
    period = max(seconds / (len(course.times) - 1), 0.02)
    return solve_posture(robot, course.motion(frame), seconds, nominal, replace(options, period=period))
