"""Whether a robot can do a task on a surface: reach, joint limits, singularities, torques and speeds along its path."""

from pliant.references.reach.check import ReachCheck, check_reach
from pliant.references.reach.course import Course, course_of
from pliant.references.reach.margins import Margin, ReachBounds

__all__ = ["Course", "Margin", "ReachBounds", "ReachCheck", "check_reach", "course_of"]
