"""A tour through joint configurations, with a rest at each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from pliant.errors import ShapeError
from pliant.interfaces import ReferenceSource
from pliant.references.trajectories.trajectory import positive, vector
from pliant.references.trajectories.waypoints import Waypoints
from pliant.robot import Robot
from pliant.signals import Estimate, Reference, TaskReference
from pliant.spatial import Array


@dataclass(frozen=True, slots=True)
class TourState:
    """When the tour began."""

    start: float
    """s"""


class PostureTour(ReferenceSource[TourState]):
    """Moves through postures, each joint along a quintic step, and rests at each. The task follows from the posture, so
    that controllers in task space and in joint space do the same.

    Args:
        robot: whose joints move.
        frame: of the task.
        postures: (m, n) rad; the first is where the tour starts.
        move: s from one posture to the next.
        rest: s at each posture.

    Raises:
        ShapeError: postures that do not fit the robot.
        ConfigError: a time that is not above zero.
        RobotError: a frame that the robot does not have.
    """

    def __init__(self, robot: Robot, frame: str, postures: npt.ArrayLike, move: float, rest: float) -> None:
        table = np.array(postures, dtype=np.float64)
        if table.ndim != 2 or table.shape[1] != robot.n:
            raise ShapeError(f"postures must be (m, {robot.n}) for robot {robot.name!r}, got shape {table.shape}")
        self.robot, self.frame = robot, frame
        self.move, self.rest = positive(move, "the time of a move", "s"), positive(rest, "the time of a rest", "s")
        arrivals = np.arange(len(table)) * (move + rest)
        times = np.column_stack([arrivals, arrivals + rest]).reshape(-1)
        self.path = Waypoints(times, np.repeat(table, 2, axis=0))
        self._frame = robot.frame_id(frame)
        self._data = robot.model.createData()  # scratch space: nothing in it outlives a step
        self._no_wrench = vector(np.zeros(6), "no wrench")

    @property
    def duration(self) -> float:
        """s until the last rest ends."""
        return self.path.duration

    def rests(self) -> list[tuple[float, float]]:
        """Begin and end of each rest, s after the start of the tour."""
        step = self.move + self.rest
        count = round((self.duration + self.move) / step)
        return [(i * step, i * step + self.rest) for i in range(count)]

    def init(self, estimate: Estimate) -> TourState:
        return TourState(estimate.time)

    def step(self, estimate: Estimate, state: TourState) -> tuple[Reference, TourState]:
        q, v, a = self.path.at(estimate.time - state.start)
        task = self._task(q, v, a)
        return Reference(estimate.time, (task,), q), state

    def _task(self, q: Array, v: Array, a: Array) -> TaskReference:
        model, data, axes = self.robot.model, self._data, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        pin.forwardKinematics(model, data, q, v, a)
        pose = pin.updateFramePlacement(model, data, self._frame)
        twist = np.array(pin.getFrameVelocity(model, data, self._frame, axes).vector)
        change = np.array(pin.getFrameClassicalAcceleration(model, data, self._frame, axes).vector)
        return TaskReference(
            self.frame, np.array(pose.translation), np.array(pose.rotation), twist, change, self._no_wrench
        )
