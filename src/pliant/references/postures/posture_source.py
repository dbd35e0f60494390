"""References for a stack of tasks: the tool's motion, its posture, and other frames at that posture."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant._values import Views
from pliant.compiled import KnownReferences
from pliant.interfaces import ReferenceSource
from pliant.references.postures.posture import PostureOptions, PosturePath, solve_posture
from pliant.references.source import FrameMotion, Started
from pliant.references.trajectories.rotation import Fixed, Turning
from pliant.references.trajectories.spline import Spline
from pliant.references.trajectories.trajectory import vector
from pliant.robot import Robot
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import Array


def posture_source(
    robot: Robot,
    motion: FrameMotion,
    secondary: Sequence[str] = (),
    duration: float = 10.0,
    nominal: npt.ArrayLike | None = None,
    posture: PostureOptions | None = None,
    tunings: Mapping[str, ImpedanceTuning] | None = None,
) -> PostureSource:
    """Solves the posture along a motion; the references then include the positions of other frames.

    Args:
        robot: the arm.
        motion: of the tool frame; start it from rest (`motion.eased(2.0)`) so that the run can start at rest.
        secondary: frames (the elbow) whose positions follow from the posture; 3 axes each, orientation free.
        duration: s; afterwards the last pose is held. A motion whose postures repeat themselves before goes on.
        nominal: (n,) rad, see `solve_posture`.
        posture: how to solve it.
        tunings: frame → impedance parameters of a secondary task.

    Returns:
        A source whose references hold the tool's task, then the secondary ones, and the posture; `.start` is the
        configuration at which the run should begin.

    Raises:
        UnreachableError: the robot cannot follow the motion.
        RobotError: a frame that the robot does not have.
    """
    path = solve_posture(robot, motion, duration, nominal, posture)
    positions = [_frame_path(robot, path, frame) for frame in secondary]
    return PostureSource(motion, path, dict(zip(secondary, positions, strict=True)), tunings or {})


Parts = Callable[[Array], tuple[Array, ...]]
"""row of numbers → views of its parts"""


@dataclass(slots=True, frozen=True)
class _Task:
    """Constant data of a task."""

    frame: str
    rotation: Array | None
    tuning: ImpedanceTuning | None
    parts: Parts
    """position (3,), twist and its rate (6,)"""


class PostureSource(ReferenceSource[Started]):
    """Tool, secondary frames and posture from one spline: a step takes one small matrix product.

    Args:
        motion: of the tool frame.
        path: posture along it.
        secondary: frame → (m, 3) positions at the path's samples, m.
        tunings: frame → impedance parameters.
    """

    def __init__(
        self,
        motion: FrameMotion,
        path: PosturePath,
        secondary: Mapping[str, Array],
        tunings: Mapping[str, ImpedanceTuning],
    ) -> None:
        self.path, self.motion = path, motion
        self.start: Array = vector(path.postures[0], "the first posture")
        # Each task takes six columns, position and three zeros, so that a row of rates is a twist.
        tool = np.array([motion.position.at(float(t)).value for t in path.times])
        blocks = [np.hstack([block, np.zeros_like(block)]) for block in (tool, *secondary.values())]
        self._spline = Spline(path.times, np.hstack([*blocks, path.postures]))
        R = motion.rotation
        self._turning = R if isinstance(R, Turning) and not isinstance(R, Fixed) else None
        fixed = R.at(0.0).rotation if isinstance(R, Fixed) else None
        width = self._spline.size
        self._tool = _Task(motion.frame, fixed, motion.tuning, _parts_of(0, width))
        self._others = [
            _Task(frame, None, tunings.get(frame), _parts_of(i, width)) for i, frame in enumerate(secondary, start=1)
        ]
        self._posture = Views([(6 * len(blocks), len(self.start))]).of
        self._more = 15 if self._turning is not None or motion.wrench is not None else 0
        self._turned = Views([(3 * width, 3, 3), (3 * width + 9, 6)]).of
        self._no_wrench = vector(np.zeros(6), "no wrench")

    def init(self, estimate: Estimate) -> Started:
        return Started(estimate.time)

    def step(self, estimate: Estimate, state: Started) -> tuple[Reference, Started]:
        return self.at(estimate.time, estimate.time - state.time), state

    def at(self, time: float, elapsed: float) -> Reference:
        """The reference at `time` of the loop's clock, `elapsed` s after the start."""
        inside = self.path.inside(elapsed)
        row = self._spline.row(inside)
        return self._of(time, self._completed(row, elapsed, inside) if self._more else row)

    def compiled_face(self, estimate: Estimate, state: Started) -> KnownPostures:
        return KnownPostures(3 * self._spline.size + self._more, state.time, self._rows, self._of)

    def _rows(self, elapsed: Array) -> Array:
        """What `_of` needs (k, …) at times (k,) in s after the start."""
        inside = np.array([self.path.inside(time) for time in elapsed.tolist()]) if self.path.repeats else elapsed
        rows = self._spline.table(inside)
        if not self._more:
            return rows
        whole = np.empty((len(rows), rows.shape[1] + self._more))
        for i, at in enumerate(zip(elapsed.tolist(), inside.tolist(), strict=True)):
            whole[i] = self._completed(rows[i], *at)
        return whole

    def _completed(self, row: Array, elapsed: float, inside: float) -> Array:
        """A row of the spline with the twist of a rotation, and behind it the rotation and the wrench."""
        whole = np.concatenate([row, np.empty(self._more)])
        _, velocity, change = self._tool.parts(whole)
        rotation, wrench = self._turned(whole)
        if self._turning is not None and inside <= self.path.times[-1]:
            rotation[:], velocity[3:], change[3:] = self._turning.at(inside)
        elif self._turning is not None:
            rotation[:] = self._turning.at(float(self.path.times[-1])).rotation
        if self.motion.wrench is not None:
            wrench[:] = self.motion.wrench.at(elapsed).value
        return whole

    def _of(self, time: float, row: Array) -> Reference:
        position, velocity, change = self._tool.parts(row)
        rotation, wrench = self._turned(row) if self._more else (None, self._no_wrench)
        rotation = self._tool.rotation if self._turning is None else rotation
        wrench = self._no_wrench if self.motion.wrench is None else wrench
        tasks = [TaskReference(self._tool.frame, position, rotation, velocity, change, wrench, self._tool.tuning)]
        for task in self._others:
            position, rate, change = task.parts(row)
            tasks.append(TaskReference(task.frame, position, None, rate, change, self._no_wrench, task.tuning))
        (posture,) = self._posture(row)
        return Reference(time, tuple(tasks), posture)


class KnownPostures(KnownReferences):
    """References of a `PostureSource` that was started.

    Args:
        size: numbers of a reference.
        start: s of the loop's clock.
        rows: times (k,) in s after the start → references (k, size).
        of: time in s and numbers (size,) → reference.
    """

    def __init__(
        self,
        size: int,
        start: float,
        rows: Callable[[Array], Array],
        of: Callable[[float, Array], Reference],
    ) -> None:
        self.size, self._start, self._rows, self._of = size, start, rows, of

    def reference(self, time: float, numbers: Array) -> Reference:
        return self._of(time, numbers)

    def fill(self, times: Array, rows: Array) -> int:
        rows[:] = self._rows(times - self._start)
        return len(times)


def _parts_of(place: int, width: int) -> Parts:
    """Parts of a row of the spline. Args: place: of a task. width: columns of value, rate and acceleration."""
    begin = 6 * place
    return Views([(begin, 3), (width + begin, 6), (2 * width + begin, 6)]).of


def _frame_path(robot: Robot, path: PosturePath, frame: str) -> Array:
    """Positions (m, 3) of a frame along a joint path."""
    data, index = robot.model.createData(), robot.frame_id(frame)
    positions = np.empty((path.times.shape[0], 3))
    for row, q in enumerate(path.postures):
        pin.framesForwardKinematics(robot.model, data, q)
        positions[row] = data.oMf[index].translation
    return positions
