"""Robots, problems and random parameters that several tests of the predictive controllers share."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from pliant import _mpc
from pliant.mpc.chain import chain_from_robot
from pliant.mpc.config import Contact, MpcConfig
from pliant.mpc.costs import Costs, PhaseCosts, Term
from pliant.mpc.horizon import HorizonReference
from pliant.mpc.kernel import kernel_model, kernel_solver
from pliant.mpc.make_problem import problem_from_robot
from pliant.mpc.nodes import NodeParameters
from pliant.mpc.problem import MpcProblem
from pliant.robot import Robot, Tool
from pliant.spatial import Array

KINDS = ("force_feedback", "classical", "torque_feedback", "naive_viscoelastic", "free")
AXES = ("local", "world", "surface")


def polishing_arm() -> Robot:
    return Robot.load("iiwa14", locked={"A7": 0.0}, tool=Tool())


def config(
    kind: str = "force_feedback",
    dimension: int = 1,
    axes: str = "world",
    *,
    friction: float | None = None,
    **changes: object,
) -> MpcConfig:
    """A problem with every cost term on, in contact. Baumgarte's spring is off where the Python model has none."""
    costs = {name: Term(weight=1.0) for name in Costs.model_fields}
    contact = Contact.model_validate(
        {
            "dimension": dimension,
            "axes": axes,
            "friction": friction,
            "normal": (0.3, 0.2, 1.0),
            "baumgarte": (5.0 if dimension < 6 else 0.0, 10.0),
            "stiffness": (1e3,) * min(dimension, 3) + (20.0,) * max(dimension - 3, 0),
            "damping": (1e2,) * min(dimension, 3) + (0.5,) * max(dimension - 3, 0),
        }
    )
    values = {
        "kind": kind,
        "contact": contact,
        "costs": Costs.model_validate(costs),
        "phases": {"contact": PhaseCosts(contact=True)},
    }
    return MpcConfig.model_validate(values | changes)


def randomise(p: NodeParameters, model: pin.Model, rng: np.random.Generator) -> None:
    """Random weights and references in every node; unit-sized."""
    for name in (
        "state_weight",
        "control_weight",
        "torque_gravity_weight",
        "control_gravity_weight",
        "translation_weight",
        "rotation_weight",
        "velocity_weight",
        "force_weight",
        "force_rate_weight",
    ):
        values = getattr(p, name)
        values[...] = rng.uniform(0.1, 1.0, values.shape)
    for name in (
        "control_reference",
        "translation_reference",
        "velocity_reference",
        "force_reference",
        "anchor_translation",
    ):
        values = getattr(p, name)
        values[...] = rng.normal(size=values.shape)
    for node in range(len(p.rotation_reference)):
        p.rotation_reference[node] = pin.exp3(0.5 * rng.normal(size=3))
        p.state_reference[node, : model.nq] = random_posture(model, rng)


def random_posture(model: pin.Model, rng: np.random.Generator) -> Array:
    """(nq,) within one rad of neutral."""
    return np.array(pin.integrate(model, pin.neutral(model), rng.uniform(-1.0, 1.0, model.nv)))


def random_state(model: pin.Model, extra: int, rng: np.random.Generator) -> Array:
    """(nx,)."""
    return np.concatenate([random_posture(model, rng), rng.normal(size=model.nv), 3.0 * rng.normal(size=extra)])


def posed(
    robot: Robot, config: MpcConfig, offset: Array, force: float, phase: str = "circle"
) -> tuple[MpcProblem, _mpc.Chain, _mpc.Solver]:
    """A kernel solver whose task is to be `offset` (3,) m from home, pressing with `force` N in a phase."""
    problem, chain = problem_from_robot(robot, config), chain_from_robot(robot, config.frame)
    solver = kernel_solver(problem, chain, kernel_model(problem))
    position, R = robot.placement(robot.home, config.frame)
    count = config.horizon + 1
    wrench = np.tile([0.0, 0.0, force, 0.0, 0.0, 0.0], (count, 1))
    reference = HorizonReference(
        np.tile(position + offset, (count, 1)),
        np.tile(R, (count, 1, 1)),
        np.zeros((count, 6)),
        wrench,
        None,
        (phase,) * count,
    )
    problem.write_constants(solver.nodes)
    problem.write_phases(solver.nodes, reference.phase)
    problem.write_references(solver.nodes, reference, robot.home)
    solver.nodes.anchor_translation[...] = position
    return problem, chain, solver


def start_state(problem: MpcProblem, robot: Robot, rng: np.random.Generator, spread: float = 0.05) -> Array:
    """(nx,) near home, moving, pressing."""
    extra = {"force_feedback": 20.0 * np.ones(problem.m), "torque_feedback": np.zeros(robot.n)}
    q, v = robot.home + spread * rng.normal(size=robot.n), 0.1 * rng.normal(size=robot.n)
    return np.concatenate([q, v, extra.get(problem.config.kind, np.zeros(0))])
