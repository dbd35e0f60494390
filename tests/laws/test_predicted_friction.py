"""The predicted contact slides as Coulomb says, sticks as a spring, dissipates, and steps stably however stiff it is.

A mass on three sliders under the compiled node. Baselines: the contact that sticks, a law that creeps, the explicit
step.
"""

from __future__ import annotations

import itertools

import numpy as np
import pinocchio as pin
import pytest

from pliant import _mpc

Vector = np.ndarray
MASS, DT = 3.0, 3e-3  # kg, s
FRICTION, NORMAL = 0.3, 50.0  # 1, N
LIMIT = FRICTION * NORMAL  # N
K, B = 1e4, 60.0  # N/m, N·s/m across the surface
STICKS = np.inf
TILTED = pin.exp3(np.array([0.4, -0.3, 0.8]))


class Slider:
    """3 kg on three prismatic joints along the world axes, weightless, moved as told against the contact."""

    def __init__(self, friction: float, axes: str = "world", dt: float = DT) -> None:
        still, none = np.eye(3), np.zeros((3, 3))
        chain = _mpc.Chain(
            np.tile(still, (3, 1, 1)),
            none,
            ["prismatic"] * 3,
            still,
            [0.0, 0.0, MASS],
            none,
            np.zeros((3, 3, 3)),
            gravity=[0.0, 0.0, 0.0],
            contact_rotation=TILTED if axes == "local" else still,
        )
        self.R = still if axes == "world" else TILTED  # R_world_contact
        self.dt = dt
        self.node = _mpc.Node(chain, _mpc.Model("force_feedback", 3, axes), dt)
        self.node.parameters.task_rotation = self.R if axes == "surface" else still
        self.node.parameters.stiffness, self.node.parameters.damping = (K, K, 3e3), (B, B, 70.0)
        self.node.parameters.sliding_friction = friction

    def moved(self, velocity: Vector, normal: float = NORMAL) -> Vector:
        """(k, 3) N in contact axes: the force at the start of each step, when moved with (k, 3) m/s in contact axes."""
        x = np.concatenate([np.zeros(3), self.R @ velocity[0], [0.0, 0.0, normal]])
        forces = [x[6:]]
        for now, after in itertools.pairwise(velocity):
            acceleration = (after - now) / self.dt
            x = self.node.calc(x, self.R @ (MASS * acceleration - forces[-1])).x_next
            forces.append(x[6:])
        return np.array(forces)


def steady(direction: float, speed: float, steps: int) -> Vector:
    """(steps, 3) m/s along the surface."""
    return np.tile(speed * np.array([np.cos(direction), np.sin(direction), 0.0]), (steps, 1))


@pytest.mark.parametrize("axes", ["local", "world", "surface"])
@pytest.mark.parametrize("direction", [0.0, 2.0])
def test_in_steady_sliding_the_force_is_the_limit_against_the_velocity(axes: str, direction: float) -> None:
    velocity = steady(direction, 0.2, 201)
    force = Slider(FRICTION, axes).moved(velocity)
    np.testing.assert_allclose(force[100:, :2], -LIMIT * velocity[100:, :2] / 0.2, atol=2e-3 * LIMIT)
    sticking = np.linalg.norm(Slider(STICKS, axes).moved(velocity)[:, :2], axis=1)
    assert sticking[200] == pytest.approx(2.0 * sticking[100])  # baseline: it grows without bound
    assert sticking[200] > 70.0 * LIMIT


def test_no_motion_takes_the_force_beyond_the_limit() -> None:
    """The damper neither: a circle with jerks of 30 m/s² on top, one step in two."""
    rng = np.random.default_rng(0)
    angle = 3.0 * DT * np.arange(700)
    velocity = 0.2 * np.stack([-np.sin(angle), np.cos(angle), 0.0 * angle], axis=1)
    velocity[::2, :2] += 0.1 * rng.uniform(-1.0, 1.0, velocity[::2, :2].shape)
    size = np.linalg.norm(Slider(FRICTION).moved(velocity)[:, :2], axis=1)
    assert size.max() < 1.005 * LIMIT
    assert size.max() > 0.95 * LIMIT  # it is reached
    assert np.linalg.norm(Slider(STICKS).moved(velocity)[:, :2], axis=1).max() > 50.0 * LIMIT


def test_on_a_circle_the_force_lags_by_what_the_bristle_bends() -> None:
    angle = 3.0 * DT * np.arange(1000)
    velocity = 0.2 * np.stack([-np.sin(angle), np.cos(angle), 0.0 * angle], axis=1)
    force = Slider(FRICTION).moved(velocity)[100:, :2]
    against = -np.einsum("ki,ki->k", force, velocity[100:, :2]) / (0.2 * np.linalg.norm(force, axis=1))
    lag = 3.0 * (LIMIT / (K * 0.2) - B / K)  # rad: turning rate times (bending over speed minus the damper's lead)
    assert np.arccos(against).max() < abs(lag) + 0.01
    np.testing.assert_allclose(np.linalg.norm(force, axis=1), LIMIT, rtol=5e-3)


def test_at_rest_it_is_a_spring() -> None:
    """Pulled by 20 µm and held for 3 s. Baseline: with a speed √(ẋ² + ε²) in its place the force creeps away."""
    pull, hold = steady(0.5, 2e-4, 34), np.zeros((1000, 3))
    velocity = np.vstack([np.zeros((1, 3)), pull, hold])
    force = Slider(FRICTION).moved(velocity)[:, :2]
    displacement = 34 * DT * pull[0, :2]
    np.testing.assert_allclose(force[-1], -K * displacement, rtol=5e-3)
    np.testing.assert_allclose(force[-1], force[40], atol=1e-12)
    creeping = -K * displacement
    for _ in hold:
        creeping = creeping / (1.0 + DT * K * 1e-3 / LIMIT)
    assert np.linalg.norm(creeping) < 0.2 * K * np.linalg.norm(displacement)


def test_pulling_back_and_forth_dissipates_the_same_at_any_frequency() -> None:
    """4 μ λ_n A per cycle. Baseline: what a contact that sticks dissipates, in its damper, grows with frequency."""
    amplitude = 0.02  # m

    def per_cycle(friction: float, frequency: float, dt: float = 5e-4) -> float:
        steps = round(1.0 / (frequency * dt))
        speed = 2.0 * np.pi * frequency * amplitude * np.cos(2.0 * np.pi * np.arange(2 * steps + 1) / steps)
        velocity = np.stack([speed, 0.0 * speed, 0.0 * speed], axis=1)
        force = Slider(friction, dt=dt).moved(velocity)[steps:, 0]
        return float(-np.sum(0.5 * (force[1:] + force[:-1]) * 0.5 * (speed[steps + 1 :] + speed[steps:-1])) * dt)

    slow, fast = per_cycle(FRICTION, 0.5), per_cycle(FRICTION, 2.0)
    assert 0.85 * 4.0 * LIMIT * amplitude < slow < 4.0 * LIMIT * amplitude
    assert fast == pytest.approx(slow, rel=0.02)
    assert per_cycle(STICKS, 2.0) > 3.0 * per_cycle(STICKS, 0.5)


def test_the_step_is_stable_where_explicit_euler_diverges() -> None:
    """K = 1e4 N/m at 0.5 m/s with a limit of 6 N: the bristle gives way 2.5 times within a step of 3 ms."""
    normal, speed = 20.0, 0.5
    force = Slider(FRICTION).moved(steady(0.0, speed, 60), normal)[:, 0]
    assert np.all(np.diff(force) <= 1e-9)  # from 0 down to the limit, without overshoot
    assert force[-1] == pytest.approx(-FRICTION * normal, rel=5e-3)
    explicit, largest = 0.0, 0.0
    for _ in range(60):
        explicit += DT * (-K * speed - K * speed / (FRICTION * normal) * explicit)
        largest = max(largest, abs(explicit))
    assert largest > 1e6


@pytest.mark.parametrize("normal", [200.0, 5.0, 0.0, -30.0])
def test_the_limit_follows_the_normal_force(normal: float) -> None:
    """Also where the predicted contact is lost: there the friction fades, it does not turn round."""
    force = Slider(FRICTION).moved(steady(0.0, 0.3, 200), normal)
    smooth = 0.5 * (normal + np.hypot(normal, 2.0))  # 1 N at zero
    assert force[-1, 0] == pytest.approx(-FRICTION * smooth, rel=1e-3)
    np.testing.assert_allclose(force[:, 2], normal)
