"""Normal force along a path whose normal turns."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pliant.errors import ConfigError, options
from pliant.references.toolpaths.toolpath import Toolpath
from pliant.references.trajectories.rotation import Turning, third_axis
from pliant.references.trajectories.trajectory import Point, Trajectory
from pliant.references.trajectories.waypoints import Waypoints


@dataclass(frozen=True)
class PressingForce:
    """Normal force along a path: straight lines between knots, constant before the first and after the last.

    Raises:
        ConfigError: on construction, when the knots do not increase, a force pulls, or the unit is unknown.
    """

    knots: tuple[float, ...]
    """share of the path length (0…1), or s since the start of the path; increasing"""
    forces: tuple[float, ...]
    """N, one per knot"""
    unit: Literal["share", "s"] = "share"

    def __post_init__(self) -> None:
        if self.unit not in ("share", "s"):
            raise ConfigError(f"unknown unit {self.unit!r} of a force profile; {options(['share', 's'], self.unit)}")
        if len(self.knots) != len(self.forces) or not self.knots:
            raise ConfigError(
                f"a force profile needs one force per knot, got {len(self.knots)} knots and {len(self.forces)} forces"
            )
        if not all(early < late for early, late in zip(self.knots, self.knots[1:], strict=False)):
            raise ConfigError(f"the knots of a force profile must increase, got {list(self.knots)}")
        if not all(math.isfinite(force) and force >= 0.0 for force in self.forces):
            raise ConfigError(f"a force on a surface pushes: not negative (N), got {list(self.forces)}")

    @classmethod
    def constant(cls, force: float) -> PressingForce:
        """A constant force in N."""
        return cls((0.0,), (float(force),))

    @property
    def largest(self) -> float:
        """N."""
        return max(self.forces)

    def along(self, path: Toolpath) -> Trajectory:
        """(1,) N over the time of a path."""
        lines = Waypoints(np.array(self.knots), np.array(self.forces)[:, None], "ramp")
        return lines if self.unit == "s" else _OverShare(lines, path.share)


class _OverShare(Trajectory):
    """F(s(t)) for a force over the share of the path length."""

    def __init__(self, lines: Waypoints, share: Trajectory) -> None:
        self._lines, self._share = lines, share
        self.size, self.duration = 1, share.duration

    def at(self, time: float) -> Point:
        s, rate, acceleration = self._share.at(time)
        force, slope, _ = self._lines.at(float(s[0]))
        return Point(force, slope * rate, slope * acceleration)


class Pressing(Trajectory):
    """The desired reaction (6,) of a surface: a force along the third axis of its task frame, no moments.

    Args:
        force: (1,) N over time.
        axes: R_world_task over the same time; the third column is the outward normal.
    """

    def __init__(self, force: Trajectory, axes: Turning) -> None:
        self._force, self._axes = force, axes
        self.size, self.duration = 6, force.duration

    def at(self, time: float) -> Point:
        F, F_dot, F_ddot = (float(part[0]) for part in self._force.at(time))
        n, n_dot, n_ddot = third_axis(self._axes.at(time))
        rows = np.zeros((3, 6))
        rows[0, :3] = F * n
        rows[1, :3] = F_dot * n + F * n_dot
        rows[2, :3] = F_ddot * n + 2.0 * F_dot * n_dot + F * n_ddot
        return Point(*rows)
