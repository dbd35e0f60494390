"""The explicit contact law obeys mechanics: it converges, conserves, and fails loudly."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from pliant.errors import ConfigError, RunFailedError
from pliant.robot import Robot
from pliant.signals import Command
from pliant.simulation import Ball, Box, MujocoPlant, Scene, Surface, floor
from pliant.simulation.contact.explicit import ContactPair, ExplicitContacts
from pliant.simulation.contact.material import ContactMaterial
from tests.simulation.bench import FINE, RIGID, Bench, G, bench

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
