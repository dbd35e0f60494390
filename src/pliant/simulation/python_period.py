"""Start of a simulated robot, and a control period in Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from pliant.simulation.contact.explicit import ExplicitContacts
from pliant.simulation.contact.mujoco_forces import contact_wrenches
from pliant.simulation.disturbances import Push
from pliant.simulation.joint_effects import JointEffects
from pliant.simulation.stepping import PARTS, shares
from pliant.simulation.what_touches import WhatTouches
from pliant.simulation.world import World
from pliant.spatial import Array


class PythonPeriod:
    """A period where MuJoCo is not the one that pliant was compiled for; else `CompiledPeriod` does the same.

    Args:
        model: compiled.
        touches: what can touch, and the sensors.
        geoms: name of each geom that can touch → its frame.
        explicit: contacts as forces; None: MuJoCo's own.
        n: joints of the robot.
        substeps: physics steps in a period.
        joints: what the joints do by themselves.
        pushes: disturbances.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        touches: WhatTouches,
        geoms: Mapping[str, str],
        explicit: ExplicitContacts | None,
        n: int,
        substeps: int,
        joints: JointEffects,
        pushes: Sequence[Push],
    ) -> None:
        self._model, self._touches, self._geoms, self._explicit = model, touches, geoms, explicit
        self._n, self._substeps, self._joints, self._pushes = n, substeps, joints, pushes

    def refresh(self, world: World) -> None:
        """Forces and accelerations under the held torque, without letting time pass."""
        data = world.data
        mujoco.mj_step1(self._model, data)
        if self._explicit is not None:
            world.contacts = self._explicit.init(data)
            self._read_explicit(world, self._explicit)
        self._apply(world)
        mujoco.mj_forward(self._model, data)

    def step(self, world: World) -> None:
        """Holds the world's torque for a period."""
        if self._explicit is None:
            self._step_mujoco(world)
        else:
            self._step_explicit(world, self._explicit)

    def _step_mujoco(self, world: World) -> None:
        for last in range(self._substeps - 1, -1, -1):
            self._apply(world)
            mujoco.mj_step2(self._model, world.data)
            if last == 0:
                self.read_contacts(world)
            mujoco.mj_step1(self._model, world.data)

    def _step_explicit(self, world: World, contacts: ExplicitContacts) -> None:
        assert world.contacts is not None
        for steps in shares(self._substeps, PARTS if self._follows_state(world) else 1):
            self._apply(world)
            contacts.advance(world.contacts, steps)
            mujoco.mj_step1(self._model, world.data)
        contacts.refresh(world.contacts)
        self._read_explicit(world, contacts)

    def _follows_state(self, world: World) -> bool:
        """Whether a torque or force other than the held torque changes within a period."""
        return bool(self._pushes or world.pushes) or self._joints.compensation == "gravity+coriolis"

    def read_contacts(self, world: World) -> None:
        world.wrenches, world.touching = contact_wrenches(
            self._model, world.data, self._touches.frames, self._touches.sites
        )

    def _read_explicit(self, world: World, contacts: ExplicitContacts) -> None:
        assert world.contacts is not None
        world.wrenches = self.no_wrenches()
        touching: set[str] = set()
        for index, pair in enumerate(contacts.pairs):
            frame = self._geoms.get(pair.geom_a)
            if frame is not None and contacts.touching(world.contacts, index):
                about = world.data.site_xpos[self._touches.sites[frame]]
                world.wrenches[frame] += contacts.wrench(world.contacts, index, about)
                touching.add(frame)
        world.touching = frozenset(touching)

    def no_wrenches(self) -> dict[str, Array]:
        return {frame: np.zeros(6) for frame in self._geoms.values()}

    def _apply(self, world: World) -> None:
        n, data = self._n, world.data
        data.qfrc_applied[:] = 0.0
        data.qfrc_applied[:n] = world.torque
        if self._joints.compensation == "gravity+coriolis":
            data.qfrc_applied[:n] += data.qfrc_bias[:n]
        for push in (*self._pushes, *world.pushes):
            if push.at(data.time):
                site = self._model.site(push.frame).id
                body = int(self._model.site_bodyid[site])
                force = np.array(push.force)
                mujoco.mj_applyFT(self._model, data, force, np.zeros(3), data.site_xpos[site], body, data.qfrc_applied)
