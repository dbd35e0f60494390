"""References of a phase as rows of numbers, one per instant."""

from __future__ import annotations

import numpy as np

from pliant.references.task_phase import TaskPhase
from pliant.references.trajectories.rotation import Fixed, Orientation, Turning
from pliant.references.trajectories.trajectory import Hold, Trajectory
from pliant.spatial import Array

PLAIN = 57
"""numbers of a row without a posture. Columns are as `cpp/references/task_rows.hpp` has them: position (3), rotation
(9), twist (6) and its rate (6), wrench (6), task axes (9), the third of them and its first two time derivatives (6
each, of which the last three are zero), posture"""
Parts = tuple[Array, Array, Array, Array, Array, Array, Array | None]
"""position, rotation, twist, its rate, wrench, task axes and posture of one row"""


class PhaseRows:
    """A phase at many instants of its own clock, before it is anchored. What does not move is worked out once.

    Args:
        phase: which one.
        rotation: (3, 3) R_world_frame, of a phase that has none of its own.
        posture: (n,) rad, likewise; None for none.
    """

    def __init__(self, phase: TaskPhase, rotation: Array, posture: Array | None) -> None:
        self.phase = phase
        own = posture if phase.posture is None else phase.posture.at(0.0).value
        still = np.zeros((1, PLAIN + (0 if own is None else len(own))))
        still[:, 3:12], still[:, 30:39] = rotation.ravel(), np.eye(3).ravel()
        if own is not None:
            still[:, PLAIN:] = own
        start = np.zeros(1)
        _move(still, start, phase.motion)
        _turn(still, start, phase.rotation)
        _press(still, start, phase.wrench)
        _turn_axes(still, start, phase.axes)
        self._still = still
        self._motion, self._wrench = _moving(phase.motion), _moving(phase.wrench)
        self._rotation, self._axes = _turning(phase.rotation), _turning(phase.axes)
        self._posture = _moving(phase.posture)

    @property
    def width(self) -> int:
        """Numbers of a row: 57 + n, or 57 without a posture."""
        return self._still.shape[1]

    def __call__(self, times: Array) -> Array:
        """Rows (m, width). Args: times (m,) s, m ≥ 1."""
        table = np.empty((len(times), self._still.shape[1]))
        table[:] = self._still
        _move(table, times, self._motion)
        _turn(table, times, self._rotation)
        _press(table, times, self._wrench)
        _turn_axes(table, times, self._axes)
        if self._posture is not None:
            table[:, PLAIN:] = self._posture.rows(times).value
        return table


def _moving(one: Trajectory | None) -> Trajectory | None:
    return None if isinstance(one, Hold) else one


def _turning(one: Turning | None) -> Turning | None:
    return None if isinstance(one, Fixed) else one


def _move(table: Array, times: Array, motion: Trajectory | None) -> None:
    if motion is not None:
        table[:, :3], table[:, 12:15], table[:, 18:21] = motion.rows(times)


def _turn(table: Array, times: Array, rotation: Turning | None) -> None:
    if rotation is not None:
        R, spin, change = rotation.rows(times)
        table[:, 3:12], table[:, 15:18], table[:, 21:24] = R.reshape(-1, 9), spin, change


def _press(table: Array, times: Array, wrench: Trajectory | None) -> None:
    if wrench is not None:
        table[:, 24:30] = wrench.rows(times).value


def _turn_axes(table: Array, times: Array, axes: Turning | None) -> None:
    if axes is not None:
        found = axes.rows(times)
        table[:, 30:39] = found.rotation.reshape(-1, 9)
        table[:, 39:42], table[:, 45:48], table[:, 51:54] = _third_axes(found)


def _third_axes(axes: Orientation) -> tuple[Array, Array, Array]:
    """`rotation.third_axis` of many instants, (m, 3) each."""
    R, spin, change = axes
    n = R[:, :, 2]
    if not (spin.any() or change.any()):
        return n, np.zeros_like(n), np.zeros_like(n)
    n_dot = np.cross(spin, n)
    return n, n_dot, np.cross(change, n) + np.cross(spin, n_dot)
