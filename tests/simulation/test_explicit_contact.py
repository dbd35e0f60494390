"""The explicit contact law obeys mechanics: it sticks, slides, converges, conserves, and fails loudly."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import ConfigError, RunFailedError
from pliant.interfaces import Plant
from pliant.robot import Robot
from pliant.signals import Command
from pliant.simulation import (
    Ball,
    Box,
    Imperfections,
    ImperfectPlant,
    JointEffects,
    LinkCapsule,
    MujocoPlant,
    Plane,
    Scene,
    Surface,
    floor,
)
from pliant.simulation.contact_pairs import pairs_of
from pliant.simulation.explicit_contact import (
    ContactMaterial,
    ContactPair,
    ContactState,
    ExplicitContacts,
    explicit_contacts,
)
from pliant.spatial import rpy

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


# ---------------------------------------------------------------------- friction

EDGE = 0.1  # m, half edge of the block


def block_on_slope(tilt: float, material: Callable[[ContactMaterial], ContactMaterial] | None = None) -> Bench:
    """A 2 kg block lying on a plane tilted about y.

    Gravity first presses it onto the plane and then turns upright within 0.2 s. Let go at once, the block would already
    slide when its weight arrives on the plane, and between the two coefficients it would go on sliding, as it should.
    """
    normal = (np.sin(tilt), 0.0, np.cos(tilt))
    centre = EDGE * np.array(normal)
    block = Box("block", (2 * EDGE, 2 * EDGE, 2 * EDGE), tuple(centre), 2.0, (0.0, tilt, 0.0), RIGID)
    b = bench([block, Plane("slope", (0.0, 0.0, 0.0), normal, RIGID)], material=material)
    for share in np.linspace(0.0, 1.0, 101):
        angle = (1.0 - share) * tilt
        b.model.opt.gravity = [-G * np.sin(angle), 0.0, -G * np.cos(angle)]
        b.run(2e-3)
    return b


def downhill(b: Bench, tilt: float) -> tuple[float, float]:
    """Distance and speed along the slope."""
    along = np.array([np.cos(tilt), 0.0, -np.sin(tilt)])
    return float(b.data.qpos[:3] @ along), float(b.data.qvel[:3] @ along)


@pytest.mark.parametrize("degrees", [2.0, 15.0, 24.0])
def test_a_block_sticks_on_a_slope_below_the_friction_angle(degrees: float) -> None:
    tilt = np.deg2rad(degrees)
    assert np.tan(tilt) < RIGID.friction
    b = block_on_slope(tilt)
    b.run(0.3)
    before, _ = downhill(b, tilt)
    b.run(0.7)
    after, _ = downhill(b, tilt)
    assert abs(after - before) / 0.7 < 1e-6  # m/s


def test_a_capped_viscous_friction_creeps_on_the_same_slope() -> None:
    tilt = np.arcsin(5.0 / (2.0 * G))  # a load of 5 N downhill

    def viscous(material: ContactMaterial) -> ContactMaterial:
        # 5 N at 1 mm/s, shared by the four corners the block stands on.
        return replace(material, tangential_stiffness=0.0, tangential_damping=5.0 / 1e-3 / 4.0)

    creep = []
    for b in (block_on_slope(tilt), block_on_slope(tilt, viscous)):
        b.run(0.3)
        before, _ = downhill(b, tilt)
        b.run(0.5)
        creep.append(abs(downhill(b, tilt)[0] - before) / 0.5)
    assert creep[0] < 1e-6
    assert creep[1] == pytest.approx(1e-3, rel=0.05)


@pytest.mark.parametrize("degrees", [30.0, 40.0])
def test_above_the_friction_angle_it_slides_with_the_dynamic_coefficient(degrees: float) -> None:
    tilt = np.deg2rad(degrees)
    assert np.tan(tilt) > RIGID.friction
    b = block_on_slope(tilt)
    b.run(0.1)
    _, early = downhill(b, tilt)
    b.run(0.2)
    _, late = downhill(b, tilt)
    expected = G * (np.sin(tilt) - 0.3 * np.cos(tilt))
    assert (late - early) / 0.2 == pytest.approx(expected, rel=0.01)


def test_between_the_two_coefficients_a_resting_block_stays_and_a_moving_one_goes_on() -> None:
    tilt = np.deg2rad(21.0)  # tan 21° = 0.38
    at_rest, moving = block_on_slope(tilt), block_on_slope(tilt)
    moving.data.qvel[:3] = 0.2 * np.array([np.cos(tilt), 0.0, -np.sin(tilt)])
    for b in (at_rest, moving):
        b.run(0.3)
    assert abs(downhill(at_rest, tilt)[1]) < 1e-6
    expected = 0.2 + 0.3 * G * (np.sin(tilt) - 0.3 * np.cos(tilt))
    assert downhill(moving, tilt)[1] == pytest.approx(expected, rel=0.02)


def test_a_sliding_ball_ends_up_rolling_at_five_sevenths_of_its_speed() -> None:
    surface = replace(RIGID, friction_moving=None)
    b = bench([Ball("ball", 0.1, (0.0, 0.0, 0.1), 0.5, surface), floor(0.0, surface)])
    b.run(0.1)
    b.data.qvel[0] = 1.0
    b.run(0.5)
    assert b.data.qvel[0] == pytest.approx(5.0 / 7.0, rel=5e-3)
    assert b.data.qvel[4] * 0.1 == pytest.approx(b.data.qvel[0], rel=2e-3)


# ---------------------------------------------------------------------- convergence, energy, momentum


def oblique_impact(dt: float) -> np.ndarray:
    """State of a ball 60 ms after it was thrown at a floor, spinning."""
    surface = Surface(1e5, 3e1, 0.5, 0.3)
    b = bench([Ball("ball", 0.1, (0.0, 0.0, 0.102), 0.5, surface), floor(0.0, surface)], dt)
    b.data.qvel[:] = [0.4, 0.1, -0.5, 0.0, 3.0, 0.0]
    b.run(0.06)
    return np.concatenate([b.data.qpos[:3], b.data.qvel])


def test_the_physics_converges_at_first_order_in_the_step() -> None:
    exact = oblique_impact(6.25e-7)
    steps = [8e-5, 4e-5, 2e-5, 1e-5, 5e-6, 2.5e-6]
    errors = [float(np.abs(oblique_impact(dt) - exact).max()) for dt in steps]
    assert errors[0] < 0.01
    # Touching and leaving fall between two steps, so only the trend is smooth.
    slope, _ = np.polyfit(np.log(steps), np.log(errors), 1)
    assert 0.7 < slope < 1.5


def bouncing_energy(dt: float) -> float:
    """Relative change of energy over 1 s of bouncing without damping or friction."""
    surface = Surface(1e5, 0.0, 0.0)
    b = bench([Ball("ball", 0.1, (0.0, 0.0, 0.2), 0.5, surface), floor(0.0, surface)], dt)
    before = b.energy()
    changes = []
    for _ in range(50):
        b.run(0.02)
        if not b.state.force.any():
            changes.append(abs(b.energy() - before))
    # Potential energy counts from the floor, so the ball's drop is what can be gained or lost.
    return max(changes) / (0.5 * G * 0.1)


def test_created_energy_tends_to_zero_with_the_step() -> None:
    coarse, middle, fine = (bouncing_energy(dt) for dt in (2e-4, 1e-4, 5e-5))
    assert coarse > middle > fine
    assert fine < coarse / 2.5
    assert fine < 0.01


def test_friction_and_damping_only_take_energy_away() -> None:
    box = Box("box", (0.2, 0.3, 0.1), (0.0, 0.0, 0.25), 2.0, (0.4, 0.3, 0.0), Surface(1e5, 1e2, 0.5, 0.3))
    b = bench([box, floor(0.0, box.surface)])
    b.data.qvel[:] = [0.5, -0.3, 0.0, 2.0, 1.0, -4.0]
    mujoco.mj_step1(b.model, b.data)
    last = b.energy()
    start = last
    for _ in range(200):
        b.run(0.01)
        if b.state.force.any():
            continue  # energy stored in springs is not in the balance
        assert b.energy() <= last + 1e-4 * start
        last = b.energy()
    assert b.energy() < 0.5 * start


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_what_two_free_things_do_to_each_other_cancels(friction: float) -> None:
    surface = Surface(1e5, 1e2, friction)
    box = Box("box", (0.2, 0.3, 0.1), (0.0, 0.0, 0.0), 2.0, (0.3, 0.2, 0.1), surface)
    ball = Ball("ball", 0.1, (0.02, 0.03, 0.3), 0.5, surface)
    b = bench([box, ball], gravity=0.0)
    b.data.qvel[6:9] = [0.3, 0.1, -2.0]
    b.data.qvel[9:12] = [1.0, 5.0, 0.0]
    mujoco.mj_step1(b.model, b.data)
    before = momentum(b)
    speed = b.data.qvel[8]
    b.run(0.2)
    assert b.data.qvel[8] > 0.2 * abs(speed) or abs(b.data.qvel[2]) > 0.1  # they did meet
    assert np.allclose(momentum(b)[:3], before[:3], atol=1e-12)
    assert np.allclose(momentum(b)[3:], before[3:], atol=1e-5)  # the integrator's own drift


def momentum(b: Bench) -> np.ndarray:
    """Linear and angular momentum about the origin, (6,)."""
    total = np.zeros(6)
    for body in range(1, b.model.nbody):
        mass, R = b.model.body_mass[body], b.data.ximat[body].reshape(3, 3)
        spin = np.zeros(6)
        mujoco.mj_objectVelocity(b.model, b.data, mujoco.mjtObj.mjOBJ_BODY, body, spin, 0)
        x = b.data.xipos[body]
        total[:3] += mass * spin[3:]
        total[3:] += mass * np.cross(x, spin[3:]) + R @ (b.model.body_inertia[body] * (R.T @ spin[:3]))
    return total


def test_a_box_lies_on_a_fixed_one() -> None:
    post = Box("post", (0.3, 0.3, 0.1), (0.0, 0.0, 0.0), 0.0, surface=RIGID)
    box = Box("box", (0.1, 0.1, 0.1), (0.0, 0.0, 0.1005), 1.0, surface=RIGID)
    b = bench([post, box])
    b.run(0.3)
    assert np.abs(b.data.qvel).max() < 1e-9
    assert np.allclose(b.contacts.force_on(b.state, "box"), [0.0, 0.0, G], atol=1e-6)


def test_it_agrees_with_mujocos_own_contact_where_only_the_normal_counts(leg3: Robot) -> None:
    surface = Surface(1e3, 10.0, 0.0)
    things = (Ball("ball", 0.1, (0.5, 0.0, 0.15), 0.5, surface), floor(0.0, surface))
    plant = MujocoPlant(leg3, Scene(things), physics_step=FINE)
    _, world = plant.init()
    sharp = bench(things, material=lambda m: replace(m, transition=0.0))
    faded = bench(things)
    heights = np.zeros((500, 3))
    for k in range(500):
        _, world = plant.step(Command(0.0, np.zeros(3), np.zeros(3)), world)
        sharp.run(plant.period)
        faded.run(plant.period)
        heights[k] = plant.truth(world).objects["ball"][2], sharp.data.qpos[2], faded.data.qpos[2]
    assert heights[:, 0].min() < 0.085  # 15 mm deep
    assert np.abs(heights[:, 1] - heights[:, 0]).max() < 1e-5  # m
    # Fading in over 1 mm of penetration shifts the path by less than half of that.
    assert 1e-5 < np.abs(heights[:, 2] - heights[:, 0]).max() < 5e-4


# ---------------------------------------------------------------------- in the plant


def leg_on_floor(
    leg3: Robot, surface: Surface, dt: float = FINE, joints: JointEffects | None = None
) -> tuple[MujocoPlant, np.ndarray]:
    x, _ = leg3.placement(leg3.home, "foot")
    scene = Scene((floor(x[2] - 0.02, surface),), contact="explicit")
    return MujocoPlant(leg3, scene, physics_step=dt, joints=joints), x


@dataclass
class Log:
    """What happened, one row per ms."""

    wrench: np.ndarray
    """(k, 6) at the foot"""
    residual: np.ndarray
    """(k, 3) τ + Jᵀ W − g, N·m: what is left to accelerate the joints"""


def press_and_slide(plant: Plant[Any], robot: Robot, x: np.ndarray, seconds: float, speed: float) -> Log:
    """Presses 40 N while a damped spring pulls the foot along x."""
    data, fid = robot.model.createData(), robot.frame_id("foot")
    measurement, world = plant.init()
    wrenches, residuals = [], []
    for k in range(round(seconds / plant.period)):
        J = pin.computeFrameJacobian(robot.model, data, measurement.q, fid, pin.LOCAL_WORLD_ALIGNED)
        gravity = pin.computeGeneralizedGravity(robot.model, data, measurement.q)
        pin.framesForwardKinematics(robot.model, data, measurement.q)
        target = x + np.array([speed * k * plant.period, 0.0, 0.0])
        pull = 3000.0 * (target - data.oMf[fid].translation) - 40.0 * (J[:3] @ measurement.v)
        pull[2] = -40.0
        torque = gravity + J[:3].T @ pull
        measurement, world = plant.step(Command(measurement.time, torque, np.zeros(3)), world)
        truth = plant.truth(world)
        assert truth is not None
        wrenches.append(truth.wrenches["foot"])
        residuals.append(torque + J.T @ wrenches[-1] - gravity)
    return Log(np.array(wrenches), np.array(residuals))


def test_the_foot_wrench_is_the_force_that_balances_the_robot(leg3: Robot) -> None:
    plant, x = leg_on_floor(leg3, RIGID)
    log = press_and_slide(plant, leg3, x, 0.6, 0.0)
    wrench = log.wrench[-1]
    assert np.abs(log.residual[-1]).max() < 1e-6
    assert wrench[2] == pytest.approx(40.0, abs=0.1)
    # The force acts at the sole, a radius (less the penetration) below the frame's origin.
    assert np.allclose(wrench[3:], np.cross([0.0, 0.0, -0.02], wrench[:3]), atol=2e-3)


def test_what_lies_on_the_floor_carries_what_presses_on_it(leg3: Robot) -> None:
    foot, _ = leg3.placement(leg3.home, "foot")
    top = float(foot[2]) - 0.02
    box = Box("box", (0.2, 0.2, 0.06), (float(foot[0]), 0.0, top - 0.03), 2.0, surface=RIGID)
    scene = Scene((box, floor(top - 0.06, RIGID)), contact="explicit")
    plant = MujocoPlant(leg3, scene, joints=JointEffects(damping=5.0, compensation="gravity"))
    J = pin.computeFrameJacobian(
        leg3.model, leg3.model.createData(), leg3.home, leg3.frame_id("foot"), pin.LOCAL_WORLD_ALIGNED
    )
    _, world = plant.init()
    for _ in range(400):
        _, world = plant.step(Command(0.0, J[:3].T @ np.array([0.0, 0.0, -20.0]), np.zeros(3)), world)
    contacts, state = plant.explicit, world.contacts
    assert contacts is not None
    assert state is not None
    assert np.allclose(contacts.force_on(state, "box"), [0.0, 0.0, 2.0 * G], atol=0.01)
    pressed = plant.truth(world).wrenches["foot"][:3]
    assert pressed[2] > 10.0
    assert np.allclose(contacts.force_on(state, "floor"), -pressed - [0.0, 0.0, 2.0 * G], atol=0.01)


def test_a_stiff_floor_holds_a_light_foot_without_hopping_while_it_slides(leg3: Robot) -> None:
    plant, x = leg_on_floor(leg3, RIGID)
    log = press_and_slide(plant, leg3, x, 0.8, 0.05).wrench[300:]
    assert log[:, 2].min() > 5.0  # no break
    assert log[:, 2].max() < 80.0  # no hammering
    friction = -log[:, 0] / log[:, 2]
    assert friction[-200:].mean() == pytest.approx(0.3, abs=0.03)


def test_halving_the_step_moves_the_forces_by_less_than_two_per_cent(leg3: Robot) -> None:
    peaks, means = [], []
    for dt in (FINE, 0.5 * FINE):
        plant, x = leg_on_floor(leg3, RIGID, dt)
        log = press_and_slide(plant, leg3, x, 0.5, 0.05).wrench
        peaks.append(log[:, 2].max())
        means.append(log[200:, 0].mean())
    assert peaks[0] == pytest.approx(peaks[1], rel=0.02)
    assert means[0] == pytest.approx(means[1], rel=0.02)


def test_the_shank_touches_a_box_and_the_foot_feels_nothing(leg3: Robot) -> None:
    knee, _ = leg3.placement(leg3.home, "shank")
    foot, _ = leg3.placement(leg3.home, "foot")
    middle = 0.5 * (knee + foot)
    shank = LinkCapsule("shank", "foot", 0.02, end_margin=0.04)
    # A fixed box in front of the leg, 5 mm away from the middle of the shank.
    across = np.array([-(foot - knee)[2], 0.0, (foot - knee)[0]])
    side = -across / np.linalg.norm(across)
    angle = float(np.arctan2(side[2], -side[0]))
    box = Box("box", (0.1, 0.1, 0.05), tuple(middle + side * (0.02 + 0.05 + 0.005)), 0.0, (0.0, angle, 0.0), RIGID)
    effects = JointEffects(damping=1.0, compensation="gravity")
    plant = MujocoPlant(leg3, Scene((box,), contact="explicit"), links=[shank], joints=effects)
    _, world = plant.init()
    sign = 1.0 if side[0] < 0 else -1.0
    felt = False
    for _ in range(300):
        _, world = plant.step(Command(0.0, np.array([0.0, 0.0, 3.0 * sign]), np.zeros(3)), world)
        truth = plant.truth(world)
        felt = felt or bool(truth.wrenches["shank"].any())
        assert not truth.wrenches["foot"].any()
    assert felt
    assert "shank" in world.touching


@settings(max_examples=12)
@given(
    stiffness=st.floats(2.5, 6.0).map(lambda power: 10.0**power),
    friction=st.floats(0.0, 1.0),
    roll=st.floats(-20.0, 20.0),
    pitch=st.floats(-20.0, 20.0),
    speed=st.floats(-0.2, 0.2),
)
def test_any_floor_can_be_pressed_and_stroked(
    leg3: Robot, stiffness: float, friction: float, roll: float, pitch: float, speed: float
) -> None:
    """Forces stay those of a contact: they push, within the cone, and no more than an impact allows."""
    x, _ = leg3.placement(leg3.home, "foot")
    normal = rpy(np.deg2rad(roll), np.deg2rad(pitch), 0.0)[:, 2]
    surface = Surface(stiffness, 1e-2 * stiffness, friction, 0.6 * friction)
    plane = Plane("floor", tuple(x - 0.025 * normal), tuple(normal), surface)
    plant = MujocoPlant(leg3, Scene((plane,), contact="explicit"))
    forces = press_and_slide(plant, leg3, x, 0.3, speed).wrench[:, :3]
    pressing = forces @ normal
    sideways = np.linalg.norm(forces - np.outer(pressing, normal), axis=1)
    assert pressing.min() >= 0.0
    assert np.all(sideways <= friction * pressing + 1e-9)
    assert pressing.max() < 300.0


def test_the_same_run_gives_the_same_forces_bit_for_bit(leg3: Robot) -> None:
    first, second = (
        press_and_slide(leg_on_floor(leg3, RIGID)[0], leg3, np.array([0.034, 0.0, 0.06]), 0.1, 0.05) for _ in "ab"
    )
    assert np.array_equal(first.wrench, second.wrench)


def test_weak_and_slow_actuators_on_damped_joints_hold_a_force_on_a_stiff_floor(leg3: Robot) -> None:
    inner, x = leg_on_floor(leg3, RIGID, joints=JointEffects(damping=11.46))
    held = pin.computeGeneralizedGravity(leg3.model, leg3.model.createData(), leg3.home)
    plant = ImperfectPlant(inner, Imperfections.p0_experiment4(), holding_torque=held)
    log = press_and_slide(plant, leg3, x, 1.0, 0.0)
    assert log.wrench[-1, 2] == pytest.approx(40.0, abs=0.5)
    assert np.ptp(log.wrench[-100:, 2]) < 0.05


# ---------------------------------------------------------------------- failing


def test_a_step_too_long_for_the_foot_names_the_longest_one(leg3: Robot) -> None:
    with pytest.raises(
        ConfigError, match=r"too long for K = 1e\+06 N/m and D = 10000 N s/m.* it must be below"
    ) as error:
        leg_on_floor(leg3, RIGID, 5e-4)
    longest = float(str(error.value).split("below ")[1].split(" s")[0])
    assert 1e-5 < longest < 1e-4
    period = 4.0 * longest  # just below works, just above does not
    x, _ = leg3.placement(leg3.home, "foot")
    scene = Scene((floor(x[2] - 0.02, RIGID),), contact="explicit")
    MujocoPlant(leg3, scene, period=0.99 * period, physics_step=0.99 * longest)
    with pytest.raises(ConfigError, match="too long"):
        MujocoPlant(leg3, scene, period=1.02 * period, physics_step=1.02 * longest)


@pytest.mark.parametrize("poison", [np.nan, 1e300])
def test_a_simulation_that_diverges_says_so(poison: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    b = bench([Ball("ball", 0.1, (0.0, 0.0, 0.1), 0.5, RIGID), floor(0.0, RIGID)])
    b.run(0.01)
    b.data.qvel[2] = poison
    with pytest.raises(RunFailedError, match="contacts diverged"):
        b.run(0.01)
    assert not list(tmp_path.iterdir())  # MuJoCo writes a log file when it meets such numbers itself


def test_shapes_without_a_law_are_refused() -> None:
    spec = mujoco.MjSpec()
    for name, kind in (("a", mujoco.mjtGeom.mjGEOM_ELLIPSOID), ("b", mujoco.mjtGeom.mjGEOM_SPHERE)):
        body = spec.worldbody.add_body()
        body.add_freejoint()
        body.add_geom(name=name, type=kind, size=[0.1, 0.1, 0.1])
    material = ContactMaterial.of(RIGID, 1.0)
    with pytest.raises(ConfigError, match="no explicit contact law between 'a' and 'b'; valid"):
        ExplicitContacts(spec.compile(), [ContactPair("a", "b", material)])


def test_a_link_capsule_needs_two_frames_that_move_together(leg3: Robot) -> None:
    with pytest.raises(ConfigError, match="must move together"):
        MujocoPlant(leg3, links=[LinkCapsule("thigh", "foot", 0.02)])
    with pytest.raises(ConfigError, match=r"end_margin must be below its length of 0\.275 m"):
        MujocoPlant(leg3, links=[LinkCapsule("shank", "foot", 0.02, end_margin=0.5)])
    with pytest.raises(ConfigError, match="radius > 0"):
        LinkCapsule("shank", "foot", 0.0)
