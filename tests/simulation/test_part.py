"""Round workpieces: known forces under both contact laws, direction, lever, friction cone, and what is refused."""

from __future__ import annotations

from typing import Literal

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import ConfigError
from pliant.robot import Robot
from pliant.signals import Command, Truth
from pliant.simulation import (
    Ball,
    Box,
    JointEffects,
    LinkCapsule,
    MujocoPlant,
    Part,
    Plane,
    Scene,
    Surface,
    fixed_part,
)
from pliant.spatial import exp3
from pliant.surfaces import CylinderSurface, MeshSurface, PlaneSurface, SphereSurface, SurfaceGeometry
from pliant.tasks.files import CATALOGUE

Law = Literal["mujoco", "explicit"]
START = np.array([0.0, 0.75, -1.5])  # rad
FELT = Surface(stiffness=2e4, damping=200.0, friction=0.3)
SHAPES: list[SurfaceGeometry] = [
    PlaneSurface(np.zeros(3), exp3([0.2, -0.3, 0.1])),
    CylinderSurface(np.zeros(3), exp3([1.3, 0.3, 0.1]), 0.15),
    SphereSurface(np.zeros(3), np.eye(3), 0.2),
]
INSIDE: list[SurfaceGeometry] = [
    CylinderSurface(np.zeros(3), exp3([1.3, 0.3, 0.1]), 0.15, hollow=True),
    SphereSurface(np.zeros(3), np.eye(3), 0.2, hollow=True),
    MeshSurface.read(CATALOGUE / "parts" / "wave.ply", rotation=exp3([0.1, -0.2, 0.3])),
]
CASES = [(shape, law) for shape in SHAPES for law in ("mujoco", "explicit")] + [(shape, "explicit") for shape in INSIDE]
EACH = pytest.mark.parametrize(("shape", "law"), CASES)


def under(shape: SurfaceGeometry, point: np.ndarray, gap: float) -> SurfaceGeometry:
    """The shape moved so that a point is a gap in m off its top, a little aside from it."""
    place = shape.near(shape.top() + np.array([0.03, -0.02, 0.0]))
    return shape.moved(shift=point - (place.point + gap * place.normal))


def plant_on(leg3: Robot, shape: SurfaceGeometry, law: Law, depth: float, step: float = 1e-4) -> MujocoPlant:
    foot, _ = leg3.placement(START, "foot")
    part = fixed_part("part", under(shape, foot, leg3.contact_radius["foot"] - depth), FELT)
    effects = JointEffects(damping=2.0, compensation="gravity")
    return MujocoPlant(leg3, Scene((part,), contact=law), physics_step=step, start=START, joints=effects)


@EACH
def test_a_part_pushes_by_stiffness_times_depth_along_its_normal(leg3: Robot, shape: SurfaceGeometry, law: Law) -> None:
    depth = 1.5e-3
    plant = plant_on(leg3, shape, law, depth)
    _, world = plant.init()
    geometry = plant.scene.faces[0].geometry
    foot = plant.truth(world).positions["foot"]
    facets = 5e-6 if isinstance(shape, MeshSurface) else 0.0  # m
    assert geometry.near(foot).distance == pytest.approx(leg3.contact_radius["foot"] - depth, abs=1e-8 + facets)
    depth = leg3.contact_radius["foot"] - geometry.near(foot).distance
    force = plant.truth(world).wrenches["foot"][:3]
    np.testing.assert_allclose(
        force, FELT.stiffness * depth * geometry.normal(foot), rtol=1e-6, atol=1e-6 + 4e3 * facets
    )


def pressed(plant: MujocoPlant, force: float, sideways: float, seconds: float) -> tuple[Truth, np.ndarray, np.ndarray]:
    """Pushes the foot along the inward normal and along a tangent, or holds it there if that force is 0.

    Returns the last truth, its normal and the torque.
    """
    geometry = plant.scene.faces[0].geometry
    measurement, world = plant.init()
    data, frame = plant.robot.model.createData(), plant.robot.frame_id("foot")
    first = plant.truth(world).positions["foot"]
    torque = np.zeros(3)
    for _ in range(round(seconds / plant.period)):
        J = pin.computeFrameJacobian(
            plant.robot.model, data, measurement.q, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        )[:3]
        foot, v = plant.truth(world).positions["foot"], J @ measurement.v
        n = geometry.normal(foot)
        pull = sideways * geometry.tangent(foot, [0.0, 1.0, 0.0])
        hold = pull if sideways else 2e3 * (first - foot) - 40.0 * v
        torque = J.T @ (hold - n * float(n @ hold) - force * n)
        measurement, world = plant.step(Command(measurement.time, torque, np.zeros(3)), world)
    truth = plant.truth(world)
    return truth, geometry.normal(truth.positions["foot"]), torque


@EACH
def test_at_rest_force_depth_and_joint_torques_agree(leg3: Robot, shape: SurfaceGeometry, law: Law) -> None:
    """F = K p along the normal, and τ = −Jᵀ F in joints whose gravity is compensated: statics by pinocchio."""
    step = 1e-4 if law == "explicit" else 5e-4
    plant = plant_on(leg3, shape, law, 0.0, step)
    truth, n, torque = pressed(plant, 20.0, 0.0, 0.4)
    force = truth.wrenches["foot"][:3]
    depth = leg3.contact_radius["foot"] - plant.scene.faces[0].geometry.near(truth.positions["foot"]).distance
    assert float(n @ force) == pytest.approx(20.0, rel=5e-3)
    assert FELT.stiffness * depth == pytest.approx(float(n @ force), rel=5e-3)
    axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    J = pin.computeFrameJacobian(leg3.model, leg3.model.createData(), truth.q, leg3.frame_id("foot"), axes)
    np.testing.assert_allclose(torque, -J.T @ truth.wrenches["foot"], atol=0.02)


@pytest.mark.parametrize("law", ["mujoco", "explicit"])
@pytest.mark.parametrize("shape", SHAPES[1:], ids=["cylinder", "sphere"])
def test_friction_ends_at_the_cone_about_the_normal(leg3: Robot, shape: SurfaceGeometry, law: Law) -> None:
    step = 1e-4 if law == "explicit" else 5e-4
    tolerance = 1e-9 if law == "explicit" else 3e-3  # its forces are those of one step before: the normal has turned
    for sideways, slides in ((3.0, False), (9.0, True)):  # μ F = 6 N
        plant = plant_on(leg3, shape, law, 1e-3, step)
        _, start = plant.init()
        before = plant.truth(start).positions["foot"]
        truth, n, _ = pressed(plant, 20.0, sideways, 0.08)
        force = truth.wrenches["foot"][:3]
        pressing = float(n @ force)
        across = float(np.linalg.norm(force - pressing * n))
        assert across <= FELT.friction * pressing * (1.0 + tolerance)
        assert (np.linalg.norm(truth.positions["foot"] - before) > 3e-3) == slides
        if slides:
            assert across == pytest.approx(FELT.friction * pressing, rel=0.02)


@pytest.mark.parametrize("law", ["mujoco", "explicit"])
def test_a_part_that_touches_along_a_link_pushes_with_its_lever(leg3: Robot, law: Law) -> None:
    """The shank rests crosswise on a rod, one third of the way down: force K p, moment lever × force."""
    knee, _ = leg3.placement(START, "shank")
    foot, _ = leg3.placement(START, "foot")
    along = (foot - knee) / np.linalg.norm(foot - knee)
    across = np.cross(along, [0.0, 1.0, 0.0])
    touched = knee + (foot - knee) / 3.0
    depth = 1e-3
    R = np.column_stack([along, across, [0.0, 1.0, 0.0]])
    R[:, 0] *= np.linalg.det(R)
    rod = CylinderSurface(touched + across * (0.02 + 0.1 - depth), R, 0.1)
    links = [LinkCapsule("shank", "foot", 0.02, end_margin=0.05)]
    scene = Scene((Part("rod", rod, FELT),), contact=law)
    plant = MujocoPlant(leg3, scene, physics_step=1e-4, start=START, links=links)
    _, world = plant.init()
    wrench = plant.truth(world).wrenches["shank"]
    force = -FELT.stiffness * depth * across
    np.testing.assert_allclose(wrench[:3], force, rtol=1e-4, atol=1e-4)
    lever = touched + across * (0.02 - 0.5 * depth) - knee
    np.testing.assert_allclose(wrench[3:], np.cross(lever, force), rtol=1e-4, atol=1e-4)


def test_a_part_is_drawn_with_its_own_size_and_cannot_move(leg3: Robot) -> None:
    rod = Part("rod", CylinderSurface(np.array([0.6, 0.0, 0.2]), np.eye(3), 0.15), FELT, length=0.3)
    dome = Part("dome", SphereSurface(np.array([-0.6, 0.0, 0.2]), np.eye(3), 0.2, hollow=True), FELT)
    plant = MujocoPlant(leg3, Scene((rod, dome), contact="explicit"))
    _, world = plant.init()
    assert plant.truth(world).objects == {}
    drawn = {
        int(plant.model.geom_type[i]): (plant.model.geom_size[i].copy(), plant.model.geom_rgba[i, 3])
        for i in range(plant.model.ngeom)
        if plant.model.geom_bodyid[i] == 0 and plant.model.geom_rgba[i, 3] > 0.0
    }
    np.testing.assert_allclose(drawn[int(mujoco.mjtGeom.mjGEOM_CYLINDER)][0][:2], [0.15, 0.3])
    assert drawn[int(mujoco.mjtGeom.mjGEOM_CYLINDER)][1] == 1.0
    np.testing.assert_allclose(drawn[int(mujoco.mjtGeom.mjGEOM_SPHERE)][0][0], 0.2)
    assert drawn[int(mujoco.mjtGeom.mjGEOM_SPHERE)][1] < 0.5  # seen through: the tool is inside


def test_a_plane_stays_a_plane() -> None:
    made = fixed_part("table", PlaneSurface.facing([0.0, -1.0, 1.0], [0.5, 0.0, 0.1]))
    assert isinstance(made, Plane)
    np.testing.assert_allclose(made.normal, [0.0, -np.sqrt(0.5), np.sqrt(0.5)])
    assert made.surface == Surface()


def test_what_has_no_law_is_refused(leg3: Robot) -> None:
    pipe = Part("pipe", CylinderSurface(np.zeros(3), np.eye(3), 0.15, hollow=True))
    with pytest.raises(ConfigError, match=r"part 'pipe' is hollow.*contact = 'explicit'"):
        Scene((pipe,))
    dome = Part("dome", SphereSurface(np.array([0.6, 0.0, 0.0]), np.eye(3), 0.2))
    box = Box("box", (0.1, 0.1, 0.1), (0.6, 0.0, 0.5))
    with pytest.raises(ConfigError, match="no explicit contact law between 'box' and 'dome'"):
        MujocoPlant(leg3, Scene((dome, box), contact="explicit"))
    MujocoPlant(leg3, Scene((dome, Ball("ball", 0.1, (0.6, 0.0, 0.5))), contact="explicit"))
    with pytest.raises(ConfigError, match=r"half length of part 'dome' must be above zero"):
        Part("dome", dome.geometry, length=0.0)
    with pytest.raises(ConfigError, match="need different names"):
        Scene((dome, dome))
