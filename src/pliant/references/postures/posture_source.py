"""References for a stack of tasks: the tool's motion, its posture, and other frames at that posture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin

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


@dataclass(slots=True, frozen=True)
class _Task:
    """Constant data of a task."""

    frame: str
    rotation: Array | None
    tuning: ImpedanceTuning | None
    place: slice
    """columns of its position in the spline"""
    twist: slice
    """its six columns: position and zeros, or their rates"""


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
        blocks = [np.pad(block, ((0, 0), (0, 3))) for block in (tool, *secondary.values())]
        self._spline = Spline(path.times, np.hstack([*blocks, path.postures]))
        R = motion.rotation
        self._turning = R if isinstance(R, Turning) and not isinstance(R, Fixed) else None
        fixed = R.at(0.0).rotation if isinstance(R, Fixed) else None
        self._tool = _Task(motion.frame, fixed, motion.tuning, slice(0, 3), slice(0, 6))
        self._others = [
            _Task(frame, None, tunings.get(frame), slice(6 * i, 6 * i + 3), slice(6 * i, 6 * i + 6))
            for i, frame in enumerate(secondary, start=1)
        ]
        self._posture = slice(6 * len(blocks), None)
        self._no_wrench = vector(np.zeros(6), "no wrench")

    def init(self, estimate: Estimate) -> Started:
        return Started(estimate.time)

    def step(self, estimate: Estimate, state: Started) -> tuple[Reference, Started]:
        return self.at(estimate.time, estimate.time - state.time), state

    def at(self, time: float, elapsed: float) -> Reference:
        """The reference at `time` of the loop's clock, `elapsed` s after the start."""
        inside = self.path.inside(elapsed)
        value, rate, acceleration = self._spline.at(inside)
        tasks = [self._tool_task(elapsed, inside, value, rate, acceleration)]
        for task in self._others:
            tasks.append(
                TaskReference(
                    task.frame,
                    value[task.place],
                    None,
                    rate[task.twist],
                    acceleration[task.twist],
                    self._no_wrench,
                    task.tuning,
                )
            )
        return Reference(time, tuple(tasks), value[self._posture])

    def _tool_task(
        self, elapsed: float, inside: float, value: Array, rate: Array, acceleration: Array
    ) -> TaskReference:
        rotation, velocity, change = self._tool.rotation, rate[self._tool.twist], acceleration[self._tool.twist]
        if self._turning is not None and inside <= self.path.times[-1]:
            velocity, change = velocity.copy(), change.copy()
            rotation, velocity[3:], change[3:] = self._turning.at(inside)
        elif self._turning is not None:
            rotation = self._turning.at(float(self.path.times[-1])).rotation
        wrench = self._no_wrench if self.motion.wrench is None else self.motion.wrench.at(elapsed).value
        return TaskReference(
            self._tool.frame, value[self._tool.place], rotation, velocity, change, wrench, self._tool.tuning
        )


def _frame_path(robot: Robot, path: PosturePath, frame: str) -> Array:
    """Positions (m, 3) of a frame along a joint path."""
    data, index = robot.model.createData(), robot.frame_id(frame)
    positions = np.empty((path.times.shape[0], 3))
    for row, q in enumerate(path.postures):
        pin.framesForwardKinematics(robot.model, data, q)
        positions[row] = data.oMf[index].translation
    return positions
