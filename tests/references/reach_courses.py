"""Courses of a ball on surfaces, checked for reach from the home posture, and the torques along them."""

from __future__ import annotations

import math
from unittest.mock import patch

import numpy as np
import pinocchio as pin

from pliant.references.postures.posture import PostureOptions
from pliant.references.reach import Course, ReachBounds, ReachCheck, check_reach, course_of
from pliant.references.toolpaths.patterns import line
from pliant.references.toolpaths.pressing import PressingForce
from pliant.references.toolpaths.toolpath import PathMotion, on_chart
from pliant.surfaces import PlaneSurface, SurfaceGeometry
from tests.references.ball_arm import RADIUS, ROBOT, X


def course_on(
    surface: SurfaceGeometry, near: object, uv: np.ndarray, speed: float = 0.1, force: float = 25.0
) -> Course:
    path = on_chart(surface, np.asarray(near, dtype=np.float64), X, uv, PathMotion(speed, lift=RADIUS), X)
    return course_of(path, PressingForce.constant(force), stand_off=0.03, approach_speed=0.1, leave=0.3)


def on_plane(x: float, z: float = 0.15, speed: float = 0.1, force: float = 25.0) -> Course:
    place = np.array([x, 0.0, z])
    return course_on(PlaneSurface(place, np.eye(3)), place, line((0.1, 0.0)), speed, force)


def torque_share(q: np.ndarray, n: np.ndarray, force: float) -> float:
    """Largest share of a torque limit under weight, force and 20 N in sixteen directions across the normal."""
    data = ROBOT.model.createData()
    zero = np.zeros(ROBOT.n)
    J = pin.computeFrameJacobian(ROBOT.model, data, q, ROBOT.frame_id("tool"), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    weight = pin.rnea(ROBOT.model, data, q, zero, zero)
    first = np.cross(n, X if abs(n[0]) < 0.9 else [0.0, 1.0, 0.0])
    first /= np.linalg.norm(first)
    worst = 0.0
    for angle in np.linspace(0.0, 2.0 * math.pi, 16, endpoint=False):
        push = force * n + 20.0 * (math.cos(angle) * first + math.sin(angle) * np.cross(n, first))
        worst = max(worst, float(np.max(np.abs(weight - J[:3].T @ push) / ROBOT.torque_limit)))
    return worst


def quick(course: Course, spins: bool = False, bounds: ReachBounds | None = None) -> ReachCheck:
    """From the home posture alone, and without a search for what would help, which takes long."""
    with patch("pliant.references.reach.check.remedy", return_value=""):
        options = PostureOptions(restarts=0, spins=spins)
        return check_reach(ROBOT, "tool", course, bounds=bounds, posture=options, nominal=ROBOT.home)
