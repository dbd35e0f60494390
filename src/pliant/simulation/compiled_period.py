"""A control period of a simulated robot as one compiled call (cpp/plant/physics.cpp)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import mujoco
import numpy as np

from pliant._plant import Physics
from pliant._values import Views
from pliant.named_rows import NamedRows
from pliant.simulation.contact.explicit import ExplicitContacts
from pliant.simulation.disturbances import Push
from pliant.simulation.mujoco_library import FUNCTIONS, addresses
from pliant.simulation.stepping import PARTS, shares
from pliant.simulation.what_touches import WhatTouches
from pliant.simulation.world import World
from pliant.spatial import Array, symmetric

PushRow = tuple[int, tuple[float, float, float], float, float]
"""site, force N, from, to s"""


class CompiledPeriod:
    """The handle of `_plant.Physics` for one model.

    Args:
        model: compiled.
        touches: contact frames and sensors.
        substeps: physics steps in a period.
        coriolis: whether the robot compensates its bias forces at every step.
        limit: (n,) N·m.
        fastest: (n,) rad/s; infinite: no bound.
        pushes: disturbances.
        explicit: contacts as forces, whose steps are another compiled loop; None: MuJoCo's own.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        touches: WhatTouches,
        *,
        substeps: int,
        coriolis: bool,
        limit: Array,
        fastest: Array,
        pushes: Sequence[Push],
        explicit: ExplicitContacts | None = None,
    ) -> None:
        self._model, self._substeps, self.explicit = model, substeps, explicit
        self._follows = coriolis or bool(pushes)
        self.contacts = tuple(dict.fromkeys(touches.frames.values()))
        """frames that can touch"""
        self.sensors = tuple(sensor.frame for sensor in touches.sensors)
        """frames of the sensors"""
        of_geom = [self.contacts.index(touches.frames[g]) if g in touches.frames else -1 for g in range(model.ngeom)]
        rows = [
            (
                touches.sites[sensor.frame],
                sensor.mass,
                sensor.center,
                symmetric(sensor.inertia).ravel().tolist(),
                [self.contacts.index(frame) for frame in touches.felt[sensor]],
            )
            for sensor in touches.sensors
        ]
        self.core = Physics(
            model,
            addresses(FUNCTIONS),
            substeps,
            coriolis,
            limit.tolist(),
            fastest.tolist(),
            of_geom,
            [touches.sites[frame] for frame in self.contacts],
            [] if explicit is None else [of_geom[geom] for geom in explicit.geom_of_slot],
            rows,
            self.rows(pushes),
        )
        self.n = len(limit)
        self.size = self.core.outcome_size
        """numbers of a period's outcome"""
        self.signals = Views([(i * self.n, self.n) for i in range(3)]).of
        """a period's outcome → views of the joints' positions, velocities and torques, (n,) each"""
        felt = NamedRows(self.contacts, 3 * self.n, 6)
        self.wrenches = felt.of
        """a period's outcome → frame of each contact → wrench (6,)"""
        self.readings = NamedRows(self.sensors, felt.end, 6).of
        """a period's outcome → frame of each sensor → what it reads (6,)"""
        self._touching: dict[int, frozenset[str]] = {}

    def step(self, world: World, torque: Array) -> tuple[Array, int]:
        """Holds a torque (n,) for a period. Returns its outcome (`size`,), for `keep`, and a bit for each frame in
        contact; -1: a joint is too fast."""
        out = np.empty(self.size)
        if self.explicit is None:
            return out, self.core.step(world.data, torque, self.rows(world.pushes), out)
        return out, self._step_explicit(world, torque, self.explicit, out)

    def _step_explicit(self, world: World, torque: Array, explicit: ExplicitContacts, out: Array) -> int:
        data, contacts, pushes = world.data, world.contacts, self.rows(world.pushes)
        assert contacts is not None
        for steps in shares(self._substeps, PARTS if self._follows or pushes else 1):
            self.core.hold(data, torque, pushes, out)
            explicit.advance(contacts, steps)
            mujoco.mj_step1(self._model, data)
        explicit.refresh(contacts)
        return self.core.read(data, contacts.force, contacts.point, out)

    def keep(self, world: World, out: Array, mask: int) -> None:
        """Writes a period's outcome (`size`,) and the contacts into the world."""
        _, _, world.torque = self.signals(out)
        world.wrenches = self.wrenches(out)
        touching = self._touching.get(mask)
        if touching is None:
            touching = frozenset(frame for bit, frame in enumerate(self.contacts) if mask >> bit & 1)
            self._touching[mask] = touching
        world.touching = touching

    def rows(self, pushes: Iterable[Push]) -> list[PushRow]:
        """Pushes in the format of the compiled code."""
        return (
            [(self._model.site(p.frame).id, p.force, p.start, p.start + p.duration) for p in pushes] if pushes else []
        )


def compiled_period_of(plant: Any) -> CompiledPeriod | None:
    """The compiled period of a plant that can run without Python, with the readings of its sensors by frame."""
    period = getattr(plant, "compiled", None)
    if not isinstance(period, CompiledPeriod) or len(set(period.sensors)) < len(period.sensors):
        return None
    return period if period.explicit is None else None
