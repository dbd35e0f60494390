"""Tools that touch with several points: forces and moments about the tool's frame against formulas and MuJoCo's law."""

from __future__ import annotations

import itertools
from typing import Literal

import mujoco
import numpy as np
import pytest

from pliant.errors import ConfigError
from pliant.robot import Robot, Tool
from pliant.simulation import ForceSensor, MujocoPlant, Plane, Scene, Surface, fixed_part
from pliant.simulation.contact.explicit import ContactPair, ExplicitContacts
from pliant.simulation.contact.material import ContactMaterial
from pliant.simulation.contact.mujoco_forces import contact_wrenches
from pliant.simulation.contact.recipe import add_pair, apply_surface
from pliant.spatial import Array, exp3
from pliant.surfaces import EdgeSurface, HoleSurface, PlaneSurface

Shape = Literal["sphere", "cylinder", "box"]
K, MU = 2e4, 0.3
FELT = Surface(stiffness=K, damping=100.0, friction=MU, transition=0.0)
RADIUS, EDGES, LENGTH, MASS = 0.03, (0.05, 0.03), 0.1, 0.4
ROLLING = {"cylinder": 0.5 * RADIUS**2, "box": 0.25 * EDGES[1] ** 2, "sphere": 0.0}
"""m², mean of y² over the points of the end face"""


def armed(shape: Shape) -> tuple[Robot, Array, Array]:
    """An arm with the tool, and where its frame is at home."""
    tool = Tool(length=LENGTH, mass=MASS, radius=RADIUS, shape=shape, edges=EDGES)
    arm = Robot.load("iiwa14", tool=tool).touching_with(tool)
    return arm, *arm.placement(arm.home, "tool")


def pressed(shape: Shape, depth: float, tilt: float, sensors: tuple[str, ...] = ()) -> tuple[Array, dict[str, Array]]:
    """Wrench in the tool's axes, and readings: the end lies `depth` deep in a plane, turned about the tool's x axis."""
    arm, x, R = armed(shape)
    reach = RADIUS if shape == "sphere" else 0.0
    normal = -R @ exp3([tilt, 0.0, 0.0])[:, 2]
    plane = fixed_part("plane", PlaneSurface.facing(normal, x + (depth - reach) * normal), FELT)
    felt = [ForceSensor(frame) for frame in sensors]
    plant = MujocoPlant(arm, Scene((plane,), contact="explicit"), physics_step=1e-4, sensors=felt)
    measurement, world = plant.init()
    wrench = plant.truth(world).wrenches["tool"]
    return np.concatenate([R.T @ wrench[:3], R.T @ wrench[3:]]), dict(measurement.wrenches)


@pytest.mark.parametrize("shape", ["sphere", "cylinder", "box"])
def test_flat_on_a_plane_a_tool_is_as_stiff_as_the_surface_and_feels_no_moment(shape: Shape) -> None:
    wrench, _ = pressed(shape, 1e-3, 0.0)
    np.testing.assert_allclose(wrench, [0.0, 0.0, -K * 1e-3, 0.0, 0.0, 0.0], atol=1e-8)


@pytest.mark.parametrize("shape", ["cylinder", "box"])
@pytest.mark.parametrize("tilt", [0.02, -0.03])
def test_a_tilted_end_is_turned_back_by_stiffness_times_its_second_moment(shape: Shape, tilt: float) -> None:
    """Every point is deeper by y sin(tilt) than the middle, so M = K ⟨y²⟩ sin(tilt) cos(tilt) about the tool's x axis,
    and the sum of the forces is the middle's."""
    wrench, _ = pressed(shape, 1.5e-3, tilt)
    np.testing.assert_allclose(np.linalg.norm(wrench[:3]), K * 1.5e-3, rtol=1e-9)
    moment = K * ROLLING[shape] * np.sin(tilt) * np.cos(tilt)
    np.testing.assert_allclose(abs(wrench[3]), abs(moment), rtol=1e-6)
    np.testing.assert_allclose(wrench[4:], 0.0, atol=1e-8)
    # it turns the tool's axis towards the plane's normal
    normal = -exp3([tilt, 0.0, 0.0])[:, 2]
    assert wrench[3:] @ np.cross([0.0, 0.0, -1.0], normal) > 0.0


def test_a_ball_has_no_moment_that_turns_it_back() -> None:
    """The control: the formula above does not hold for one point; what is left is the lever of the ball's radius."""
    wrench, _ = pressed("sphere", 1.5e-3, 0.02)
    lever = RADIUS - 0.5 * 1.5e-3
    np.testing.assert_allclose(wrench[3:], 0.0, atol=1e-6 * K * lever)


@pytest.mark.parametrize("shape", ["cylinder", "box"])
def test_on_its_rim_alone_the_whole_force_has_the_rims_lever(shape: Shape) -> None:
    """Tilted so far that one side alone touches: the centre of pressure lies there."""
    half = RADIUS if shape == "cylinder" else 0.5 * EDGES[1]
    wrench, _ = pressed(shape, 1e-4 - half * np.sin(0.3), 0.3)
    assert 0.0 < np.linalg.norm(wrench[:3]) <= 1.01 * K * 1e-4
    pressing = float(np.linalg.norm(wrench[:3]))
    assert abs(wrench[3]) == pytest.approx(pressing * half * np.cos(0.3), rel=2e-2)


@pytest.mark.parametrize("shape", ["cylinder", "box"])
def test_sensors_feel_the_moments_at_the_tools_end_and_where_it_is_mounted(shape: Shape) -> None:
    truth, readings = pressed(shape, 1e-3, 0.02, ("tool", "flange"))
    np.testing.assert_allclose(readings["tool"], truth, atol=1e-8)
    moved = truth[3:] + np.cross([0.0, 0.0, LENGTH], truth[:3])
    np.testing.assert_allclose(readings["flange"], np.concatenate([truth[:3], moved]), atol=1e-8)
    assert abs(truth[3]) > 0.01


# ---------------------------------------------------------------------- a free body, pressed on a plane


SIZES = {"cylinder": [RADIUS, 0.05, 0.0], "box": [0.5 * EDGES[0], 0.5 * EDGES[1], 0.05]}


def free_body(shape: Shape) -> mujoco.MjSpec:
    spec = mujoco.MjSpec()
    spec.option.timestep = 1e-4
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_REFSAFE
    ground = spec.worldbody.add_geom(name="ground", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1])
    body = spec.worldbody.add_body(name="tool", pos=[0.0, 0.0, 0.05])
    body.add_freejoint()
    body.add_site(name="tool", pos=[0.0, 0.0, -0.05])
    kind = mujoco.mjtGeom.mjGEOM_BOX if shape == "box" else mujoco.mjtGeom.mjGEOM_CYLINDER
    geom = body.add_geom(name="body", type=kind, size=SIZES[shape], mass=MASS)
    for one in (ground, geom):
        one.contype, one.conaffinity = 0, 0
    return spec


def by_own_law(
    shape: Shape, load: Array, seconds: float, tool: bool = True, spin: float = 0.0, felt: Surface = FELT
) -> mujoco.MjData:
    """A free body under a load (6,) at its centre, whose moment grows for half the time and then stays."""
    spec = free_body(shape)
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[5] = spin
    pair = ContactPair("body", "ground", ContactMaterial.of(felt, 4.0 / MASS), tool=tool)
    contacts = ExplicitContacts(model, [pair])
    state = contacts.init(data)
    grown = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    for share in np.minimum(np.linspace(0.0, 2.0, 50), 1.0):
        state.push[1] = load * np.maximum(grown, share)
        contacts.advance(state, round(seconds / model.opt.timestep / 50))
    mujoco.mj_step1(model, data)
    contacts.refresh(state)
    wrench = contacts.wrench(state, 0, data.site_xpos[0])
    data.xfrc_applied[0] = wrench  # of the world, which nothing else pushes
    return data


LOAD = np.array([0.0, 0.0, -30.0, 0.12, 0.2, 0.0])


def test_a_static_load_tilts_a_box_as_in_mujocos_own_contacts() -> None:
    """MuJoCo's four corners with a quarter of the stiffness each, the same load: same pose, same wrench."""
    spec = free_body("box")
    add_pair(spec, "pair", "body", "ground")
    model = spec.compile()
    apply_surface(model, "pair", Surface(0.25 * K, 25.0, MU))
    theirs = mujoco.MjData(model)
    for _ in range(8000):
        theirs.xfrc_applied[1] = LOAD
        mujoco.mj_step(model, theirs)
    wrenches, _ = contact_wrenches(model, theirs, {model.geom("body").id: "tool"}, {"tool": 0})
    ours = by_own_law("box", LOAD, 0.8)
    tilt = np.linalg.norm(ours.qpos[4:6]) * 2.0
    assert tilt > 2e-3
    np.testing.assert_allclose(ours.qpos[4:6], theirs.qpos[4:6], atol=2e-3 * tilt)
    assert ours.qpos[2] == pytest.approx(theirs.qpos[2], abs=2e-6)
    np.testing.assert_allclose(ours.xfrc_applied[0], wrenches["tool"], atol=2e-2)
    # equilibrium: the contact carries load and weight, with the moment that the load has about the tool's frame
    weight = MASS * 9.81
    np.testing.assert_allclose(ours.xfrc_applied[0][:3], [0.0, 0.0, 30.0 + weight], atol=1e-2)
    # the control: with the whole stiffness on every corner the box tilts by a quarter of that
    stiff = by_own_law("box", LOAD, 0.8, tool=False)
    assert 2.0 * np.linalg.norm(stiff.qpos[4:6]) < 0.35 * tilt


@pytest.mark.parametrize("shape", ["cylinder", "box"])
def test_a_tool_tips_over_where_the_moment_passes_force_times_half_its_edge(shape: Shape) -> None:
    """On a stiff plane, so that it hardly leans before."""
    half, stiff = RADIUS if shape == "cylinder" else 0.5 * EDGES[1], Surface(1e6, 300.0, MU, transition=0.0)
    force = 30.0 + MASS * 9.81
    for share, tips in ((0.85, False), (1.15, True)):
        load = np.array([0.0, 0.0, -30.0, share * force * half, 0.0, 0.0])
        data = by_own_law(shape, load, 0.5, felt=stiff)
        assert (2.0 * np.linalg.norm(data.qpos[4:6]) > 0.2) == tips


def test_friction_of_a_spinning_cylinder_is_that_of_its_rim() -> None:
    """α = μ F r / I about its axis: friction acts at each point against its own sliding."""
    force, inertia = 30.0 + MASS * 9.81, 0.5 * MASS * RADIUS**2
    data = by_own_law("cylinder", np.array([0.0, 0.0, -30.0, 0.0, 0.0, 0.0]), 0.03, spin=60.0)
    before = by_own_law("cylinder", np.array([0.0, 0.0, -30.0, 0.0, 0.0, 0.0]), 0.02, spin=60.0)
    slower = (before.qvel[5] - data.qvel[5]) / 0.01
    assert slower == pytest.approx(MU * force * RADIUS / inertia, rel=0.03)
    assert np.linalg.norm(data.qvel[:2]) < 1e-6


# ---------------------------------------------------------------------- what cannot be


def test_what_has_no_law_is_refused() -> None:
    arm, x, _ = armed("box")
    with pytest.raises(ConfigError, match=r"tool 'tool' is a box.*contact = 'explicit'"):
        MujocoPlant(arm, Scene((Plane("plane", tuple(x - 0.1), (0.0, 0.0, 1.0)),)))
    with pytest.raises(ConfigError, match="unknown shape of a tool 'boxx'; valid: 'box', 'cylinder', 'sphere'"):
        Tool(shape="boxx").check()  # type: ignore[arg-type]
    with pytest.raises(ConfigError, match="edges > 0"):
        Tool(shape="box", edges=(0.0, 0.1)).check()
    for part in (HoleSurface(x - 0.1, np.eye(3)), EdgeSurface(x - 0.1, np.eye(3))):
        with pytest.raises(ConfigError, match="is a mesh, a hole or an edge"):
            Scene((fixed_part("part", part),))
    stiff = fixed_part("plane", PlaneSurface.facing([0.0, 0.0, 1.0], x - 0.1), Surface(1e7, 1e4))
    with pytest.raises(ConfigError, match="must be below"):
        MujocoPlant(arm, Scene((stiff,), contact="explicit"), physics_step=1e-3)


@pytest.mark.parametrize("shape", ["cylinder", "box"])
def test_a_tool_is_drawn_and_weighs_as_what_it_is(shape: Shape) -> None:
    arm, _, _ = armed(shape)
    tool = Tool(length=LENGTH, mass=MASS, radius=RADIUS, shape=shape, edges=EDGES)
    assert arm.visual is not None
    drawn = next(one for one in arm.visual.geometryObjects if one.name == "tool_rod")
    assert type(drawn.geometry).__name__ == shape.capitalize()
    density = MASS / LENGTH / (np.pi * RADIUS**2 if shape == "cylinder" else EDGES[0] * EDGES[1])
    rng = np.random.default_rng(0)
    points = rng.uniform(-0.5, 0.5, (200_000, 3)) * np.array([2 * RADIUS, 2 * RADIUS, LENGTH])
    if shape == "box":
        points = rng.uniform(-0.5, 0.5, (200_000, 3)) * np.array([*EDGES, LENGTH])
    inside = np.hypot(points[:, 0], points[:, 1]) <= RADIUS if shape == "cylinder" else np.ones(len(points), bool)
    volume = np.prod([2 * RADIUS, 2 * RADIUS, LENGTH] if shape == "cylinder" else [*EDGES, LENGTH])
    p = points[inside]
    for i, j in itertools.combinations(range(3), 2):
        k = 3 - i - j
        sampled = density * volume * np.sum(p[:, i] ** 2 + p[:, j] ** 2) / len(points)
        assert tool.inertia.inertia[k, k] == pytest.approx(sampled, rel=2e-2)
