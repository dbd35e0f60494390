"""How far a task is off: its place where a motion is asked for, its force where a force is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pliant.signals import TaskReference
from pliant.spatial import Array

_JUDGED = 0.25
"""share of a world axis that must be free to move: one within 30° of a force has no error of place"""
_M_TO_MM = 1e3


@dataclass(frozen=True, slots=True)
class TaskError:
    """What is off at one instant, and where."""

    place: Array
    """(3,) m of the frame"""
    force: float
    """N more than is asked for, along the force that is asked for; not-a-number where nothing is pressed"""
    path: float
    """mm from the target, without what lies along axes that a force rules"""

    @staticmethod
    def of(task: TaskReference, place: Array, contact: Array) -> TaskError | None:
        """Of a frame that touches; None where it does not, or is asked for no force.

        Args:
            task: of the frame.
            place: (3,) m, where it is.
            contact: (3,) N on the robot there.
        """
        asked = float(np.linalg.norm(task.wrench[:3]))
        if asked == 0.0 or not np.any(contact):
            return None
        force = float(task.wrench[:3] @ contact) / asked - asked
        beside = motion_axes(task) @ (task.position - place)
        return TaskError(place, force, _M_TO_MM * float(np.linalg.norm(beside)))


def motion_axes(task: TaskReference) -> Array:
    """(3, 3) projector onto the directions along which a task asks for a place, not for a force and not for nothing."""
    if task.modes is None:
        return beside(task.wrench[:3])
    moved = task.modes.rotation[:, [mode == "motion" for mode in task.modes.modes[:3]]]
    projector: Array = moved @ moved.T
    return projector


def beside(force: Array) -> Array:
    """(3, 3) projector onto what is across a force (3,); of no force the identity."""
    size = math.hypot(*force)
    n = np.asarray(force) / size if size > 0.0 else np.zeros(3)
    return np.eye(3) - np.outer(n, n)


def position_error(error: Array, projector: Array) -> Array:
    """(3,) of an error of place (3,), world axes: what counts of it; not-a-number along an axis that a force rules."""
    return np.where(np.diag(projector) > _JUDGED, projector @ error, np.nan)


def position_errors(errors: Array, forces: Array) -> Array:
    """(k, 3) the same of many, from the forces (k, 3) that were asked for."""
    size = np.linalg.norm(forces, axis=1, keepdims=True)
    n = np.divide(forces, size, out=np.zeros_like(forces), where=size > 0.0)
    across = errors - n * np.sum(n * errors, axis=1, keepdims=True)
    return np.where(1.0 - n * n > _JUDGED, across, np.nan)
