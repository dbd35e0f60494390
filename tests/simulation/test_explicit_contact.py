"""The explicit contact law obeys mechanics: it sticks, slides, converges, conserves, and fails loudly."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from pliant.errors import ConfigError, RunFailedError
from pliant.robot import Robot
from pliant.signals import Command
from pliant.simulation import (
    Ball,
    Box,
    MujocoPlant,
    Plane,
    Scene,
    Surface,
    floor,
)
from pliant.simulation.contact.explicit import (
    ContactPair,
    ContactState,
    ExplicitContacts,
    explicit_contacts,
)
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


# ---------------------------------------------------------------------- failing


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
