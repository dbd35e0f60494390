"""What a fractal impedance task is: a frame, its axes, its tuning."""

from __future__ import annotations

from dataclasses import dataclass

from pliant.controllers.profiles import Shape
from pliant.errors import ConfigError, ShapeError
from pliant.signals import ImpedanceTuning


@dataclass(frozen=True)
class FrameTask:
    """One frame held by a fractal impedance: 3 axes (position) or 6 (position, then rotation), along the world's axes.

    Raises:
        ShapeError: the tuning has neither 3 nor 6 axes.
        ConfigError: an empty label, or one with a slash.
    """

    frame: str
    """frame of the robot that is pulled towards its reference"""
    tuning: ImpedanceTuning
    """stiffness, force and range of each axis; a reference may carry a newer one"""
    label: str = ""
    """what the task is called in channel names, for example "ee"; the frame's name where empty"""
    shape: Shape = Shape.EXPONENTIAL
    """how the force bends towards F_max"""

    def __post_init__(self) -> None:
        if self.tuning.axes not in (3, 6):
            raise ShapeError(
                f"a task has 3 axes, or 6 with rotation; the tuning of {self.frame!r} has {self.tuning.axes}"
            )
        if not self.label:
            object.__setattr__(self, "label", self.frame)
        if not self.label or "/" in self.label:
            raise ConfigError(f"a task needs a label without a slash, got {self.label!r}")

    @property
    def axes(self) -> int:
        """3 or 6."""
        return self.tuning.axes
