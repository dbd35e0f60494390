"""Springs at the joints' limits: bounded, they keep joints off their stops, and give out no more than they took in."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import pytest

from pliant.controllers.joint_limits import JointLimits, JointLimitsConfig, with_joint_limits
from pliant.interfaces import Controller
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Reference
from pliant.simulation import JointEffects, MujocoPlant

MARGIN = np.deg2rad(10.0)


@dataclass(frozen=True)
class Constant(Controller[None]):
    """Sends a torque, whatever happens."""

    torque: np.ndarray

    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, reference: Reference, state: None) -> tuple[Command, None]:
        return Command(estimate.time, self.torque, np.zeros_like(self.torque), {"own": 1.0}), None


def seen(q: np.ndarray, time: float = 0.0) -> Estimate:
    zero = np.zeros_like(q)
    return Estimate(time, q, zero, zero, zero)


def motions(robot: Robot, random: np.random.Generator, steps: int) -> np.ndarray:
    """(steps, n) joints that go in and out of their margins at up to 2 rad/s, turned round at random."""
    upper = robot.position_upper
    q, v, found = upper - 1.2 * MARGIN, np.zeros(robot.n), []
    accelerate = np.zeros(robot.n)
    for k in range(steps):
        if k % int(random.integers(5, 60)) == 0:
            accelerate = random.uniform(-20.0, 20.0, robot.n)
        v = np.clip(v + 1e-3 * accelerate, -2.0, 2.0)
        v = np.where((q > upper) & (v > 0), -v, np.where((q < upper - 1.5 * MARGIN) & (v < 0), -v, v))
        q = q + 1e-3 * v
        found.append(q)
    return np.array(found)


def given_out(robot: Robot, path: np.ndarray, guarded: bool) -> float:
    """Largest energy that a joint's spring has given out, less what it took in, since the joint came near, J."""
    limits = JointLimits(Constant(np.zeros(robot.n)), robot)
    state, net, worst = limits.init(seen(path[0])), np.zeros(robot.n), 0.0
    for before, q in itertools.pairwise(path):
        command, state = limits.step(seen(before), Reference(0.0), state)
        torque, depth = command.torque, np.maximum(before - (robot.position_upper - MARGIN), 0.0)
        if not guarded:  # baseline: the plain spring, sampled
            torque = -np.minimum(limits.stiffness * depth, limits.torque_max)
        net = np.where(depth > 0.0, net + torque * (q - before), 0.0)
        worst = max(worst, float(net.max()))
    return worst


@pytest.mark.parametrize("seed", range(4))
def test_over_any_drawn_motion_a_spring_gives_out_no_more_than_it_took_in(iiwa14: Robot, seed: int) -> None:
    path = motions(iiwa14, np.random.default_rng(seed), 3000)
    assert given_out(iiwa14, path, guarded=True) < 2e-3
    assert given_out(iiwa14, path, guarded=False) > 0.1  # J


def test_a_pushed_joint_stays_off_its_stop_and_without_the_springs_does_not(iiwa14: Robot) -> None:
    push = np.zeros(7)
    push[1] = 60.0  # N·m; the springs give up to 160

    def excess(controller: Controller[object]) -> tuple[float, float]:
        effects = JointEffects(damping=5.0, compensation="gravity")
        plant = MujocoPlant(iiwa14, joints=effects)
        measurement, world = plant.init()
        state = controller.init(seen(measurement.q))
        for _ in range(1500):
            command, state = controller.step(seen(measurement.q, measurement.time), Reference(0.0), state)
            measurement, world = plant.step(command, world)
        truth = plant.truth(world)
        return float(truth.limit_excess.max()), float(iiwa14.position_upper[1] - measurement.q[1])

    with_springs, room = excess(with_joint_limits(Constant(push), iiwa14, JointLimitsConfig()))
    assert with_springs == 0.0
    assert room == pytest.approx((1.0 - 60.0 / 160.0) * MARGIN, rel=0.05)  # K x = 60 N·m
    assert excess(with_joint_limits(Constant(push), iiwa14, None))[0] > 0.0


def test_torques_stay_within_the_limits_and_the_controllers_own_goes_first(iiwa14: Robot) -> None:
    q = np.array(iiwa14.position_upper)
    for own in (-iiwa14.torque_limit, iiwa14.torque_limit, np.zeros(7)):
        limits = JointLimits(Constant(own), iiwa14)
        command, _ = limits.step(seen(q), Reference(0.0), limits.init(seen(q)))
        assert np.all(np.abs(command.torque) <= iiwa14.torque_limit)
        assert np.all(command.torque <= own)  # the spring pushes back, towards smaller angles
        np.testing.assert_allclose(command.torque + command.clamped, own - 0.5 * iiwa14.torque_limit)
        assert command.diagnostics["own"] == 1.0
        np.testing.assert_allclose(command.diagnostics["joint_limits/torque"], command.torque - own)


def test_away_from_the_limits_nothing_changes(iiwa14: Robot) -> None:
    own = np.arange(7.0)
    limits = JointLimits(Constant(own), iiwa14)
    command, _ = limits.step(seen(iiwa14.home), Reference(0.0), limits.init(seen(iiwa14.home)))
    np.testing.assert_array_equal(command.torque, own)
    assert command.diagnostics["energy/joint_limits"] == 0.0


def test_the_stored_energy_is_the_integral_of_the_spring_also_beyond_its_largest_torque(lwr4: Robot) -> None:
    """J, against a sum of min(K x, F) dx: in the linear part, and where a joint stands beyond its limit."""
    spring = JointLimits(Constant(np.zeros(lwr4.n)), lwr4, JointLimitsConfig(margin=MARGIN))
    F, K = spring.torque_max, spring.stiffness
    for share in (0.4, 1.7):
        depth = share * F / K
        x = (np.arange(20_000) + 0.5)[:, None] * depth / 20_000
        integral = np.sum(np.minimum(K * x, F), axis=0) * depth / 20_000
        q = lwr4.position_upper - MARGIN + depth
        channels = spring.step(seen(q), Reference(0.0, ()), spring.init(seen(q)))[0].diagnostics
        assert channels["energy/joint_limits"] == pytest.approx(float(integral.sum()), rel=1e-6)


def test_margins_that_would_overlap_end_in_the_middle(lwr4: Robot) -> None:
    spring = JointLimits(Constant(np.zeros(lwr4.n)), lwr4, JointLimitsConfig(margin=50.0))
    half = 0.5 * (lwr4.position_upper - lwr4.position_lower)
    np.testing.assert_allclose(spring.stiffness, spring.torque_max / half, rtol=1e-12)
    middle = 0.5 * (lwr4.position_upper + lwr4.position_lower)
    command, _ = spring.step(seen(middle), Reference(0.0, ()), spring.init(seen(middle)))
    np.testing.assert_allclose(command.torque, 0.0, atol=1e-9)
