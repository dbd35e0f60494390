"""The exponential step of the force beside explicit Euler, on a stiff contact and on one mass."""

from __future__ import annotations

import numpy as np
import pytest

from pliant import _mpc
from tests.twins.mpc_robots import catalogue_chain
from tests.twins.mpc_twin import Twin

from .kernel_problem import DT, polishing


def test_stiff_contact_needs_the_exponential_integrator() -> None:
    """K = 1e5 N/m, B = 30 N s/m at 3 ms: the exact step stays bounded in a roll-out, explicit Euler blows up."""
    robot = catalogue_chain("lwr4")
    solver, rest = polishing(robot)
    rest[14] = 20.0  # N
    solver.quasi_static(rest)
    hold = solver.us[0]
    node = _mpc.Node(robot.chain, _mpc.Model("force_feedback", 1, integrator="exponential"), DT)
    euler = Twin(robot, "force_feedback", 1, "world", DT, node.parameters)
    node.parameters.stiffness = 1e5
    node.parameters.damping = 30.0
    node.freeze(robot.home)
    peaks = []
    for step in (lambda x: node.calc(x, hold).x_next, lambda x: euler(x, hold)[0]):
        x, peak = rest.copy(), 0.0
        x[14] += 5.0  # N of imbalance sets it swinging
        for _ in range(60):
            x = step(x)
            peak = max(peak, abs(x[14]))
            if peak > 1e4:
                break
        peaks.append(peak)
    assert peaks[0] < 60.0
    assert peaks[1] > 1e3


def test_exponential_step_is_exact_for_one_mass() -> None:
    """A sliding mass on a visco-elastic contact is linear: λ and v after one step, whatever K dt² / m."""
    scipy_linalg = pytest.importorskip("scipy.linalg")
    mass, torque = 2.0, 3.0
    chain = _mpc.Chain(
        np.eye(3)[None],
        np.zeros((1, 3)),
        ["prismatic"],
        [[0.0, 0.0, 1.0]],
        [mass],
        np.zeros((1, 3)),
        np.zeros((1, 3, 3)),
        gravity=[0, 0, 0],
    )
    for stiffness, damping in ((1e3, 1e2), (1e5, 10.0), (1e6, 1e3)):
        node = _mpc.Node(chain, _mpc.Model("force_feedback", 1, integrator="exponential"), DT)
        node.parameters.stiffness = stiffness
        node.parameters.damping = damping
        node.freeze([0.0])
        v0, force0 = 0.05, 12.0
        # v̇ = (τ + λ)/m, λ̇ = −K v − B v̇, with the constant 1 as a third state
        rates = np.array(
            [[0, 1 / mass, torque / mass], [-stiffness, -damping / mass, -damping * torque / mass], [0, 0, 0]]
        )
        expected = scipy_linalg.expm(rates * DT) @ np.array([v0, force0, 1.0])
        x_next = node.calc(np.array([0.1, v0, force0]), np.array([torque])).x_next
        np.testing.assert_allclose(x_next[1:], expected[:2], rtol=1e-10)
