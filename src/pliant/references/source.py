"""Turns trajectories into references for the control loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from pliant.errors import ConfigError, ShapeError
from pliant.interfaces import ReferenceSource
from pliant.references.trajectories.rotation import Fixed, Turning, WarpedTurning
from pliant.references.trajectories.time_scaling import EaseIn
from pliant.references.trajectories.trajectory import Trajectory, Warped, vector
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import Array

_NO_WRENCH = vector(np.zeros(6), "no wrench")


@dataclass(frozen=True)
class FrameMotion:
    """How one frame moves and presses, as functions of time."""

    frame: str
    position: Trajectory
    """(3,) m, world axes"""
    rotation: Turning | Array | None = None
    """R_world_frame as a function of time, or one matrix (3, 3); None leaves the orientation free"""
    wrench: Trajectory | None = None
    """(6,) desired reaction of the environment, N and N·m; None for zero"""
    tuning: ImpedanceTuning | None = None
    """None: the controller's own"""

    def __post_init__(self) -> None:
        if self.position.size != 3:
            raise ShapeError(f"the position of frame {self.frame!r} must have 3 entries, got {self.position.size}")
        if self.wrench is not None and self.wrench.size != 6:
            raise ShapeError(f"the wrench of frame {self.frame!r} must have 6 entries, got {self.wrench.size}")
        if self.rotation is not None and not isinstance(self.rotation, Turning):
            object.__setattr__(self, "rotation", Fixed(self.rotation))

    def eased(self, seconds: float) -> FrameMotion:
        """The same path, started from rest within `seconds`. The wrench keeps its own clock."""
        warp = EaseIn(seconds)
        rotation = self.rotation
        if isinstance(rotation, Turning) and not isinstance(rotation, Fixed):
            rotation = WarpedTurning(rotation, warp)
        return replace(self, position=Warped(self.position, warp), rotation=rotation)

    def at(self, time: float) -> TaskReference:
        """The task at a time in s."""
        position, rate, acceleration = self.position.at(time)
        rotation = self.rotation
        velocity, change = np.zeros(6), np.zeros(6)
        velocity[:3], change[:3] = rate, acceleration
        matrix = None
        if isinstance(rotation, Turning):
            matrix, velocity[3:], change[3:] = rotation.at(time)
        wrench = _NO_WRENCH if self.wrench is None else self.wrench.at(time).value
        return TaskReference(self.frame, position, matrix, velocity, change, wrench, self.tuning)


class Started(NamedTuple):
    """When a source was started."""

    time: float
    """s of the loop's clock"""


class TrajectorySource(ReferenceSource[Started]):
    """References of the motions of one or several frames, from the start of the loop.

    Args:
        motions: the most important frame first.
        posture: (n,) joint configuration over time, rad; None for none.
        phase: name of the phase in every reference.
    """

    def __init__(self, motions: Sequence[FrameMotion], posture: Trajectory | None = None, phase: str = "") -> None:
        frames = [motion.frame for motion in motions]
        if len(set(frames)) != len(frames):
            raise ConfigError(f"each frame may have one motion, got {frames}")
        self.motions, self.posture, self.phase = tuple(motions), posture, phase

    def init(self, estimate: Estimate) -> Started:
        return Started(estimate.time)

    def step(self, estimate: Estimate, state: Started) -> tuple[Reference, Started]:
        return self.at(estimate.time, estimate.time - state.time), state

    def at(self, time: float, elapsed: float) -> Reference:
        """The reference at `time` of the loop's clock, `elapsed` s after the start."""
        tasks = tuple([motion.at(elapsed) for motion in self.motions])
        posture = None if self.posture is None else self.posture.at(elapsed).value
        return Reference(time, tasks, posture, self.phase)
