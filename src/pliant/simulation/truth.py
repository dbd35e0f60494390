"""What is true of a simulated world, for the log."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from pliant._plant import TruthRow
from pliant._values import Views
from pliant.named_rows import NamedRows
from pliant.signals import Truth
from pliant.simulation.mujoco_library import can_look_inside
from pliant.simulation.world import World
from pliant.spatial import Array


class TruthReader:
    """Reads the truth of worlds of one model: in one compiled call, or in Python where MuJoCo is not the one that
    pliant was compiled for.

    Args:
        model: compiled; the robot's joints come first.
        lower, upper: (n,) limits of the joints, rad (m where they slide).
        sites: frame → its site, for positions and rotations.
        bodies: thing → its body, for poses.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        lower: Array,
        upper: Array,
        sites: Mapping[str, int],
        bodies: Mapping[str, int],
    ) -> None:
        self._lower, self._upper = lower, upper
        self._site_ids, self._body_ids = (np.array([*ids.values()], np.intp) for ids in (sites, bodies))
        n = self._n = len(lower)
        self._joints = Views([(i * n, n) for i in range(4)])
        self._positions = NamedRows(tuple(sites), 4 * n, 3)
        self._rotations = NamedRows(tuple(sites), self._positions.end, 3, 3)
        self._poses = NamedRows(tuple(bodies), self._rotations.end, 7)
        self.core: TruthRow | None = None
        """what reads it compiled"""
        self.row = self.in_python
        """data → numbers of its truth: q, v, torque, excess; positions, rotations, poses"""
        if can_look_inside():
            self.core = TruthRow(model, lower.tolist(), upper.tolist(), [*sites.values()], [*bodies.values()])
            self.row = self._compiled

    def truth(self, world: World, time: float) -> Truth:
        """The truth of a world at a time in s."""
        return self.of(self.row(world.data), time, dict(world.wrenches))

    def of(self, row: Array, time: float, wrenches: Mapping[str, Array]) -> Truth:
        """The truth of a row of numbers at a time in s, with the wrench (6,) of each contact frame."""
        q, v, torque, excess = self._joints.of(row)
        positions, rotations, poses = self._positions.of(row), self._rotations.of(row), self._poses.of(row)
        return Truth(time, q, v, torque, positions, rotations, wrenches, poses, excess)

    def _compiled(self, data: mujoco.MjData) -> Array:
        assert self.core is not None
        row = np.empty(self.core.size)
        self.core.read(data, row)
        return row

    def in_python(self, data: mujoco.MjData) -> Array:
        """The same numbers without compiled code."""
        n, sites, bodies = self._n, self._site_ids, self._body_ids
        q = data.qpos[:n]
        beyond = np.maximum(0.0, np.maximum(self._lower - q, q - self._upper))
        poses = np.hstack([data.xpos.take(bodies, 0), data.xquat.take(bodies, 0)])
        places = (data.site_xpos.take(sites, 0), data.site_xmat.take(sites, 0), poses)
        return np.concatenate([q, data.qvel[:n], data.qfrc_applied[:n], beyond, *[part.ravel() for part in places]])
