"""The compiled node against the Python node on pinocchio: everything a node yields, also where frames differ."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from pliant import _mpc
from pliant.mpc.chain import chain_from_robot
from pliant.mpc.crocoddyl.node import PinocchioNode
from pliant.mpc.kernel import kernel_model
from pliant.mpc.make_problem import problem_from_robot
from pliant.mpc.nodes import copy_nodes
from pliant.robot import Robot

from .problems import AXES, KINDS, config, polishing_arm, random_state, randomise

RUNNING = (
    "cost",
    "x_next",
    "acceleration",
    "force",
    "force_rate",
    "fx",
    "fu",
    "Lx",
    "Lu",
    "Lxx",
    "Lxu",
    "Luu",
)
CASES = [
    case
    for case in itertools.product(KINDS, (1, 3, 6), AXES)
    if not (case[0] == "naive_viscoelastic" and case[1] == 6) and not (case[0] == "free" and case[1:] != (1, "world"))
]


def _arms() -> dict[str, Robot]:
    arm = polishing_arm()
    arm.model.armature = np.linspace(0.05, 0.2, arm.n)
    side = arm.with_frame("side", "flange", (0.03, -0.05, 0.08))
    return {"iiwa14": side, "lwr4": Robot.load("lwr4").with_frame("side", "flange", (0.03, 0.0, 0.1))}


ARMS = _arms()


@pytest.mark.parametrize(
    ("kind", "dimension", "axes", "friction"),
    [(*case, None) for case in CASES]
    + [("force_feedback", dimension, axes, 0.3) for dimension in (3, 6) for axes in AXES],
)
@pytest.mark.parametrize("name", list(ARMS))
def test_both_nodes_yield_the_same(name: str, kind: str, dimension: int, axes: str, friction: float | None) -> None:
    """The contact is at another frame than the placement costs, on the running and on the last node."""
    robot = ARMS[name]
    settings = config(kind, dimension, axes, friction=friction, frame="side")
    settings = settings.model_copy(update={"contact": settings.contact.model_copy(update={"frame": "flange"})})
    problem = problem_from_robot(robot, settings)
    chain = chain_from_robot(robot, "side", "flange")
    rng = np.random.default_rng(5)
    for terminal, active in ((False, True), (False, False), (True, True)):
        python = PinocchioNode(problem, terminal=terminal)
        kernel = _mpc.Node(chain, kernel_model(problem), settings.dt, terminal=terminal)
        randomise(python.parameters, problem.model, rng)
        problem.write_constants(python.parameters)
        python.parameters.contact_active[...] = active and problem.m > 0
        copy_nodes(python.parameters, kernel.parameters)
        x = random_state(problem.model, python.nx - 2 * robot.n, rng)
        u = 5.0 * rng.normal(size=robot.n)
        ours, theirs = kernel.calc_diff(x, u), python.evaluate(x, u)
        for quantity in ("cost", "Lx", "Lxx") if terminal else RUNNING:
            expected = np.asarray(getattr(theirs, quantity))
            scale = 1.0 + float(np.max(np.abs(expected), initial=0.0))
            np.testing.assert_allclose(
                getattr(ours, quantity), expected, atol=1e-11 * scale, rtol=0.0, err_msg=f"{quantity}, {active=}"
            )
