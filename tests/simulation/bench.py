"""Things without a robot that touch each other by the explicit contact law."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from pliant.simulation import Scene, Surface
from pliant.simulation.contact.explicit import ContactPair, ContactState, ExplicitContacts, explicit_contacts
from pliant.simulation.contact.material import ContactMaterial
from pliant.simulation.contact.pairs import pairs_of

G = 9.81  # m/s²
RIGID = Surface(stiffness=1e6, damping=1e4, friction=0.5, friction_moving=0.3)
FINE = 2e-5  # s


@dataclass
class Bench:
    """Things without a robot."""

    model: mujoco.MjModel
    data: mujoco.MjData
    contacts: ExplicitContacts
    state: ContactState

    def run(self, seconds: float) -> None:
        self.contacts.advance(self.state, round(seconds / self.model.opt.timestep))
        mujoco.mj_step1(self.model, self.data)
        self.contacts.refresh(self.state)

    def energy(self) -> float:
        """Kinetic and potential, J; what is stored in contacts not included."""
        mujoco.mj_energyPos(self.model, self.data)
        mujoco.mj_energyVel(self.model, self.data)
        return float(self.data.energy.sum())


def bench(
    things: Sequence[object],
    dt: float = FINE,
    gravity: float = G,
    material: Callable[[ContactMaterial], ContactMaterial] | None = None,
) -> Bench:
    spec = mujoco.MjSpec()
    spec.option.timestep = dt
    spec.option.gravity = [0.0, 0.0, -gravity]
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_AUTORESET
    scene = Scene(tuple(things), contact="explicit")  # type: ignore[arg-type]
    for thing in scene.things:
        thing.add_to(spec)
    model = spec.compile()
    contacts = explicit_contacts(model, np.zeros(0), pairs_of(scene, []))
    if material is not None:
        pairs = [ContactPair(p.geom_a, p.geom_b, material(p.material)) for p in contacts.pairs]
        contacts = ExplicitContacts(model, pairs)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return Bench(model, data, contacts, contacts.init(data))
