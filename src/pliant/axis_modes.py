"""The mode of each axis of a task: motion, force, or free (Mason 1981)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from pliant.errors import ConfigError, ShapeError
from pliant.spatial import Array

Mode = Literal["motion", "force", "free"]
Asked = Literal["motion", "press", "yield", "free"]
"""of an axis of a task: as its mode, where a force above 0 N presses and one of 0 N yields"""
AXIS_NAMES = ("x", "y", "z", "about x", "about y", "about z")


@dataclass(frozen=True, eq=False)
class AxisModes:
    """Modes of the six axes of a frame, with the bounds of the motion along its force axes.

    On an axis of mode "force" the wrench of the reference is a request, 0 N too. One value stands for a whole phase:
    who compares two of them compares their identity.

    Raises:
        ShapeError: there are not six modes, or the rotation is not (3, 3).
        ConfigError: a bound that is not positive.
    """

    modes: tuple[Mode, ...]
    """three of the translations along the axes, three of the rotations about them"""
    rotation: Array = field(default_factory=lambda: np.eye(3))
    """R_world_axes (3, 3)"""
    speed: float = math.inf
    """m/s, largest speed along force axes"""
    deviation: float = math.inf
    """m, largest distance along force axes from where the phase began"""

    def __post_init__(self) -> None:
        if len(self.modes) != 6 or np.shape(self.rotation) != (3, 3):
            raise ShapeError(
                f"axis modes are six in axes (3, 3), got {len(self.modes)} and shape {np.shape(self.rotation)}"
            )
        for name in ("speed", "deviation"):
            if not getattr(self, name) > 0.0:
                raise ConfigError(f"{name} along force axes must be above zero, got {getattr(self, name)}")
        object.__setattr__(self, "_turned", not bool(np.array_equal(self.rotation, np.eye(3))))

    @property
    def turned(self) -> bool:
        """Whether its axes differ from the world's."""
        return bool(self._turned)  # type: ignore[attr-defined]

    def having(self, mode: Mode) -> tuple[bool, ...]:
        """(6,) which axes have a mode."""
        return tuple(one == mode for one in self.modes)

    def into(self, vector: Array) -> Array:
        """(6,) of world axes in these axes, linear and angular part alike."""
        return np.concatenate([self.rotation.T @ vector[:3], self.rotation.T @ vector[3:]])

    def pressing(self, wrench: Array) -> AxisModes:
        """The same, with mode "force" on each axis on which a wrench (6,), N and N·m in world axes, has a component."""
        told = self.into(wrench)
        pressed = np.abs(told) > 1e-9 * max(float(np.abs(told).max(initial=0.0)), 1e-9)
        modes = tuple("force" if presses else mode for presses, mode in zip(pressed.tolist(), self.modes, strict=True))
        if modes == self.modes:
            return self
        return AxisModes(modes, self.rotation, self.speed, self.deviation)  # type: ignore[arg-type]


def modes_of_wrench(wrench: Sequence[float], *, oriented: bool) -> tuple[Mode, ...]:
    """Mode "force" on the axes on which a wrench (6,), in the same axes, has a component, "motion" on the others.

    Args: oriented: whether the orientation is held; else the rotations without a moment are free.
    """
    pressed = [abs(part) > 0.0 for part in wrench]
    other: Mode = "motion" if oriented else "free"
    linear: tuple[Mode, ...] = tuple("force" if one else "motion" for one in pressed[:3])
    return (*linear, *("force" if one else other for one in pressed[3:]))
