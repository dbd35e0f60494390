"""Proposes a change that makes a task possible."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pliant.references.postures.posture import PostureOptions, PosturePath, UnreachableError, solve_posture
from pliant.references.reach.course import Course
from pliant.references.reach.margins import Margin, ReachBounds, margins
from pliant.robot import Robot
from pliant.spatial import Array

_SIZES = (0.05, 0.1, 0.2, 0.3)  # m
_LEAST_SHARE = 1e-9  # of a force; with less there is none


def remedy(
    robot: Robot,
    frame: str,
    course: Course,
    left: Sequence[Margin],
    bounds: ReachBounds,
    spins: bool,
    nominal: Array | None,
    subject: str,
) -> str:
    """One sentence. The proposal was tried on the believed surface, except a lower speed, which follows from the
    required speed.

    Args: as `check_reach`; left: margins where a joint path was found, else empty; subject: what would be moved.
    """
    broken = {margin.name: margin for margin in left if margin.first_failure is not None}
    if broken and set(broken) <= {"joint speed"}:
        share = float(broken["joint speed"].values.max())
        return f"run the path {share / bounds.speed:.2g} times slower, its acceleration too"
    if broken and set(broken) <= {"torque"}:
        lighter = _lighter(robot, frame, course, bounds, spins, nominal)
        if lighter is not None:
            force = lighter * float(course.force.max())
            return f"press with {100.0 * lighter:.2g}% of the force, at most {_rounded_down(force):g} N"
    if not spins and _possible(robot, frame, course, bounds, True, nominal):
        return "let the tool turn about its own axis"
    for size in _SIZES:
        for name, way in _ways(course):
            if _possible(robot, frame, course.moved(size * way), bounds, spins, nominal):
                return f"move {subject} by {1e2 * size:.0f} cm {name}"
    return "none of the moves by up to 30 cm that were tried makes it possible: another place, robot or tool is needed"


def _ways(course: Course) -> list[tuple[str, Array]]:
    middle = course.places[:, :2].mean(axis=0)
    out = np.array([*middle, 0.0]) / max(float(np.linalg.norm(middle)), 1e-9)
    side, up = np.array([-out[1], out[0], 0.0]), np.array([0.0, 0.0, 1.0])
    return [
        ("towards the base", -out),
        ("away from the base", out),
        ("up", up),
        ("down", -up),
        ("to the left, seen from the base", side),
        ("to the right, seen from the base", -side),
    ]


def _possible(
    robot: Robot, frame: str, course: Course, bounds: ReachBounds, spins: bool, nominal: Array | None
) -> bool:
    try:
        posture = _followed(robot, frame, course, spins, nominal)
    except UnreachableError:
        return False
    found = margins(robot, frame, course, posture, bounds, spins)
    return all(margin.first_failure is None for margin in found)


def _lighter(
    robot: Robot, frame: str, course: Course, bounds: ReachBounds, spins: bool, nominal: Array | None
) -> float | None:
    """Largest share of the force, within 1 %, under which the task is possible; None: it is not without force."""
    try:
        posture = _followed(robot, frame, course, spins, nominal)
    except UnreachableError:
        return None

    def holds(share: float) -> bool:
        found = margins(robot, frame, replace(course, force=share * course.force), posture, bounds, spins)
        return all(margin.first_failure is None for margin in found)

    low, high = _LEAST_SHARE, 1.0
    if not holds(low):
        return None
    while high > 1.01 * low:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def _followed(robot: Robot, frame: str, course: Course, spins: bool, nominal: Array | None) -> PosturePath:
    period = max(float(course.times[-1]) / 60.0, 0.02)
    options = PostureOptions("aico", period, spins=spins, restarts=2)  # the faster method
    return solve_posture(robot, course.motion(frame), float(course.times[-1]), nominal, options)


def _rounded_down(force: float) -> float:
    """N, to two digits."""
    digit = 10.0 ** (math.floor(math.log10(force)) - 1)
    return math.floor(force / digit) * digit
