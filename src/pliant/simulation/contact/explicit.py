"""Stiff contacts with stiction, computed as forces between the physics engine's two half steps.

`F_n = max(0, s(p/w)(K p + D ṗ))` with s a smoothstep over the transition w, and a bristle that sticks below the static
friction limit ([HapFIC] sec. III). The law itself and its loop are compiled (cpp/contact).
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from pliant._contact import BRISTLE_SIZE, ContactLoop, SampledMesh, Solid
from pliant.errors import ConfigError, RunFailedError
from pliant.simulation.contact.material import ContactMaterial, GradedMaterial, require_stable_step
from pliant.simulation.mujoco_library import HALF_STEPS, addresses
from pliant.simulation.surface import Surface
from pliant.spatial import Array, cross


@dataclass(frozen=True)
class ContactPair:
    """Two geoms that can touch: the first a sphere, capsule or box, or as a tool a cylinder or box, the second a plane,
    box, sphere, cylinder or the frame of a mesh, hole or edge."""

    geom_a: str
    geom_b: str
    material: ContactMaterial
    hollow: bool = False
    """the material of the second, a sphere or a cylinder, is outside of it"""
    form: SampledMesh | Solid | None = None
    """the surface of the second, in its axes; None: its own shape"""
    tool: bool = False
    """the first is a tool that is not a sphere: its contact points share the material"""
    graded: GradedMaterial | None = None
    """in place of `material`, where it changes along a line"""


@dataclass(slots=True)
class ContactState:
    """Contacts of one world. Consumed by `advance`."""

    loop: ContactLoop
    bristles: Array
    """(slots, 5) deflection (3) m, friction coefficient, sliding or not"""
    push: Array
    """(nbody, 6) force and torque at each body's centre of mass from elsewhere, N and N·m"""
    force: Array
    """(slots, 3) on the pair's first geom, world axes, N"""
    point: Array
    """(slots, 3) where it acts, world, m"""
    penetration: Array
    """(slots,) m, above zero where the shapes overlap"""


class ExplicitContacts:
    """The contacts of a model.

    Args:
        model: compiled, with the geoms of all pairs; its own contacts between them switched off.
        pairs: what can touch what.

    Raises:
        ConfigError: a pair of shapes without a law.
    """

    def __init__(self, model: mujoco.MjModel, pairs: Sequence[ContactPair]) -> None:
        self.model = model
        self.pairs = tuple(pairs)
        self._geoms = [(model.geom(pair.geom_a).id, model.geom(pair.geom_b).id) for pair in self.pairs]
        self.slots = self._fill(ContactLoop(model, mujoco.MjData(model), *addresses(HALF_STEPS)))
        """of each pair, its rows in the arrays of a state"""

    @property
    def geom_of_slot(self) -> list[int]:
        """The first geom of the pair of each row."""
        return [
            geom for (geom, _), rows in zip(self._geoms, self.slots, strict=True) for _ in range(rows.start, rows.stop)
        ]

    def init(self, data: mujoco.MjData) -> ContactState:
        """Untouched contacts of a world, at the forces of its present configuration."""
        loop = ContactLoop(self.model, data, *addresses(HALF_STEPS))
        self._fill(loop)
        n = loop.slots
        state = ContactState(
            loop=loop,
            bristles=np.zeros((n, BRISTLE_SIZE)),
            push=np.zeros((self.model.nbody, 6)),
            force=np.zeros((n, 3)),
            point=np.zeros((n, 3)),
            penetration=np.zeros(n),
        )
        for pair, slots in zip(self.pairs, self.slots, strict=True):
            state.bristles[slots, 3] = pair.material.mu_static
        mujoco.mj_step1(self.model, data)
        self.refresh(state)
        return state

    def advance(self, state: ContactState, steps: int) -> None:
        """Makes physics steps, and updates the forces after each.

        Raises:
            RunFailedError: a force or a velocity is not finite.
        """
        dt = float(self.model.opt.timestep)
        done = state.loop.advance(steps, dt, state.push, state.bristles, state.force, state.point, state.penetration)
        if done < steps:
            raise RunFailedError(self._blown_up(state, dt))

    def refresh(self, state: ContactState) -> None:
        """Forces of the present configuration, without letting time pass."""
        state.loop.evaluate(0.0, state.push, state.bristles, state.force, state.point, state.penetration)

    def wrench(self, state: ContactState, index: int, about: Array) -> Array:
        """Wrench (6,) on the first geom of pair number `index`, about a point (3,), world axes."""
        slots = self.slots[index]
        force, lever = state.force[slots], state.point[slots] - about
        moment = cross(lever[0], force[0]) if len(force) == 1 else np.cross(lever, force).sum(axis=0)
        return np.concatenate([force.sum(axis=0), moment])

    def force_on(self, state: ContactState, geom: str) -> Array:
        """Sum of all contact forces on a geom (3,), N, world axes."""
        total = np.zeros(3)
        for pair, slots in zip(self.pairs, self.slots, strict=True):
            sign = (pair.geom_a == geom) - (pair.geom_b == geom)
            total += sign * state.force[slots].sum(axis=0)
        return total

    def touching(self, state: ContactState, index: int) -> bool:
        """Whether pair number `index` is in contact."""
        return bool(np.any(state.force[self.slots[index]]))

    def _fill(self, loop: ContactLoop) -> list[slice]:
        return [self._add(loop, *geoms, pair) for geoms, pair in zip(self._geoms, self.pairs, strict=True)]

    def _add(self, loop: ContactLoop, geom_a: int, geom_b: int, pair: ContactPair) -> slice:
        try:
            if pair.graded is None:
                first, count = loop.add_pair(geom_a, geom_b, pair.material.row(), pair.hollow, pair.form, pair.tool)
            else:
                row, line, places = pair.graded.rows()
                first, count = loop.add_pair(geom_a, geom_b, row, pair.hollow, pair.form, pair.tool, line, places)
        except ValueError as error:
            raise ConfigError(
                f"no explicit contact law between {pair.geom_a!r} and {pair.geom_b!r}; valid: a sphere, capsule, box or"
                " tool against a plane, a mesh, a hole, an edge, a box or the inside of a hollow sphere or cylinder, a"
                " sphere or capsule against the outside of one"
            ) from error
        return slice(first, first + count)

    def _blown_up(self, state: ContactState, dt: float) -> str:
        worst = int(np.argmax(np.where(np.isfinite(state.penetration), state.penetration, np.inf)))
        index = next(i for i, slots in enumerate(self.slots) if slots.start <= worst < slots.stop)
        pair = self.pairs[index]
        return (
            f"the simulation of contacts diverged (deepest: {pair.geom_a!r} in {pair.geom_b!r}, K ="
            f" {pair.material.stiffness:g} N/m, D = {pair.material.damping:g} N s/m); the physics step of {dt:g} s"
            " may be too long, or the command unstable"
        )


def explicit_contacts(
    model: mujoco.MjModel,
    start: Array,
    pairs: Sequence[tuple[str, str, Surface]],
    hollow: Collection[str] = (),
    forms: Mapping[str, SampledMesh | Solid] | None = None,
    tools: Collection[str] = (),
) -> ExplicitContacts:
    """The contacts of a model, checked for the physics step they need.

    Args:
        model: compiled; `timestep` set.
        start: (n,) configuration of the robot, whose joints come first.
        pairs: two geoms and their contact properties.
        hollow: geoms whose material is outside of them.
        forms: geoms that are the frame of a mesh, a hole or an edge → its surface.
        tools: geoms that are tools of several points.

    Raises:
        ConfigError: a pair of shapes without a law, or a physics step that is too long for a contact.
    """
    data = mujoco.MjData(model)
    data.qpos[: start.shape[0]] = start
    mujoco.mj_forward(model, data)
    made: list[ContactPair] = []
    for a, b, surface in pairs:
        geom = model.geom(a).id
        inverse_mass = _tool_inverse_mass(model, data, geom) if a in tools else _inverse_mass(model, data, geom, True)
        inverse_mass += _inverse_mass(model, data, model.geom(b).id, presses=False)
        materials = [ContactMaterial.of(one, inverse_mass) for one in surface.at_places()]
        for material in materials:
            require_stable_step(f"{a}|{b}", material, inverse_mass, float(model.opt.timestep))
        graded = None if surface.change is None else GradedMaterial(surface.change, tuple(materials))
        made.append(ContactPair(a, b, materials[0], b in hollow, (forms or {}).get(b), a in tools, graded))
    return ExplicitContacts(model, made)


def _inverse_mass(model: mujoco.MjModel, data: mujoco.MjData, geom: int, presses: bool) -> float:
    """Largest eigenvalue of J M⁻¹ Jᵀ at a geom's centre, 1/kg; of a box that presses, of its fastest mode on four
    corners."""
    body = int(model.geom_bodyid[geom])
    if model.body_weldid[body] == 0:
        return 0.0  # part of the world
    if presses and model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_BOX:
        half2 = np.asarray(model.geom_size[geom]) ** 2
        rocking = max(half2[i] / (half2[i] + half2[j]) for i in range(3) for j in range(3) if i != j)
        return 4.0 * max(1.0, 3.0 * float(rocking)) / float(model.body_mass[body])
    return _at_point(model, data, body, data.geom_xpos[geom])


def _tool_inverse_mass(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> float:
    """Bound of the same for a tool: its points and those of the other on it, which together have at most four times the
    material's stiffness, each no lighter than the lightest corner of the box round the tool."""
    R, half = data.geom_xmat[geom].reshape(3, 3), np.array(model.geom_size[geom])
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_CYLINDER:
        half = half[[0, 0, 1]]
    corners = [data.geom_xpos[geom] + R @ (half * signs) for signs in itertools.product((-1.0, 1.0), repeat=3)]
    return 4.0 * max(_at_point(model, data, int(model.geom_bodyid[geom]), corner) for corner in corners)


def _at_point(model: mujoco.MjModel, data: mujoco.MjData, body: int, point: Array) -> float:
    """Largest eigenvalue of J M⁻¹ Jᵀ at a point of a body, 1/kg."""
    J = np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, J, None, point, body)
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    return float(np.linalg.eigvalsh(J @ np.linalg.solve(M, J.T))[-1])
