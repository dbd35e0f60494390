"""What a description must obey, and how its weights reach the nodes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from pliant.errors import ConfigError, RobotError, ShapeError
from pliant.mpc.config import Contact, MpcConfig
from pliant.mpc.costs import Costs, PhaseCosts, Term
from pliant.mpc.defaults import ClassicalMpc, ForceFeedbackMpc, TorqueFeedbackMpc
from pliant.mpc.make_problem import problem_from_model, problem_from_robot
from pliant.mpc.registry import CONTROLLERS
from pliant.robot import Robot, Tool

from .problems import config, polishing_arm

# ---------------------------------------------------------------------- values


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"weight": -1.0}, "greater than or equal to 0"),
        ({"weight": float("nan")}, "finite"),
        ({"activation": (1.0, -2.0)}, "must not be negative"),
        ({"wieght": 1.0}, "Extra inputs"),
    ],
)
def test_wrong_terms_are_refused(values: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        Term.model_validate(values)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"contact": {"stiffness": (0.0,)}}, "stiffness must be above zero"),
        ({"contact": {"damping": (-1.0,)}}, "damping must be above zero"),
        ({"contact": {"stiffness": (1e3, 1e3)}}, "has 2 entries, the contact has 1"),
        ({"contact": {"dimension": 2}}, "1, 3 or 6"),
        ({"bounds": {"friction": 0.5}}, "dimension 3 or 6"),
        ({"contact": {"dimension": 3, "friction": 0.0}}, "greater than 0"),
        ({"contact": {"dimension": 3, "friction": -0.3}}, "greater than 0"),
        ({"contact": {"friction": 0.3}}, r"contact\.friction needs a contact of dimension 3 or 6, got 1"),
        (
            {"kind": "classical", "contact": {"dimension": 3, "friction": 0.3}},
            "of kind 'force_feedback', got.*'classical'",
        ),
        (
            {"contact": {"dimension": 3, "friction": 0.3, "integrator": "exponential"}},
            r"contact\.friction needs contact\.integrator = 'euler', got 'exponential'",
        ),
        ({"horizon": 0}, "greater than or equal to 1"),
        ({"kind": "torque_feedback", "between": "riccati"}, "use 'hold'"),
    ],
)
def test_wrong_problems_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        MpcConfig.model_validate(changes)


def test_activations_must_fit_the_residual() -> None:
    costs = Costs(translation=Term(weight=1.0, activation=(1.0,) * 4))
    with pytest.raises(ConfigError, match=r"translation \(phase 'free'\).* has 3 components, got 4 activations"):
        problem_from_robot(polishing_arm(), MpcConfig(costs=costs))


def test_stiffness_outside_the_integrators_range_is_refused() -> None:
    robot = polishing_arm()
    with pytest.raises(ConfigError, match=r"K dt < B.*K = 100000, B = 100.*'exponential'"):
        problem_from_robot(robot, ForceFeedbackMpc(contact=Contact(stiffness=(1e5,), damping=(1e2,))))
    problem_from_robot(robot, ForceFeedbackMpc(contact=Contact(stiffness=(1e5,), integrator="exponential")))
    with pytest.raises(ConfigError, match="K at most"):
        problem_from_robot(robot, ForceFeedbackMpc(contact=Contact(stiffness=(1e8,), integrator="exponential")))


@given(K=st.floats(1e2, 2e5), B=st.floats(1.0, 5e3), dt=st.floats(5e-4, 1e-2), mass=st.floats(0.5, 20.0))
def test_the_range_is_that_of_a_stable_step(K: float, B: float, dt: float, mass: float) -> None:
    """One mass against the visco-elastic contact, eq. 24: accepted exactly where its step matrix contracts."""
    step = np.array([[1.0, dt / mass], [-K * dt, 1.0 - B * dt / mass]])
    stable = float(np.abs(np.linalg.eigvals(step)).max()) < 1.0
    accepted = K * dt < B and B * dt < 2.0 * mass + 0.5 * K * dt**2
    margin = min(abs(K * dt - B) / B, abs(B * dt - 2.0 * mass - 0.5 * K * dt**2) / mass)
    assert accepted == stable or margin < 1e-6


def test_a_posture_of_another_size_is_refused() -> None:
    model = pin.buildSampleModelHumanoid()
    settings = config("classical", 3).model_copy(update={"frame": model.frames[-1].name})
    with pytest.raises(ShapeError, match=f"{model.nq} entries"):
        problem_from_model(model, settings, np.zeros(3))
    with pytest.raises(RobotError, match="has no frame 'tool'"):
        problem_from_model(model, config(), pin.neutral(model))


# ---------------------------------------------------------------------- weights


def test_weights_follow_the_cost_convention() -> None:
    """Activations are squared; the last node's weight is multiplied by dt unless the term says otherwise."""
    term = Term(weight=2.0, activation=(3.0, 1.0), terminal=5.0)
    weights = term.along(horizon=3, size=4, dt=0.01, name="x")
    np.testing.assert_allclose(weights[:3], np.tile([18.0, 2.0, 2.0, 2.0], (3, 1)))
    np.testing.assert_allclose(weights[3], 0.01 * 5.0 * np.array([9.0, 1.0, 1.0, 1.0]))
    arm = Term(weight=1.0, activation=(4.0, 3.0, 2.0)).along(1, 2, 0.01, "x", per_joint=True)
    np.testing.assert_allclose(arm[0], [16.0, 9.0])  # a list for a longer arm
    growing = Term(weight=5.0, per_node=2.0, terminal_times_dt=False)
    np.testing.assert_allclose(growing.along(4, 1, 0.01, "x")[:, 0], [0.0, 2.0, 4.0, 5.0, 5.0])


def test_published_weights_arrive_in_the_nodes() -> None:
    problem = problem_from_robot(polishing_arm(), ForceFeedbackMpc())
    nodes = problem.nodes()
    problem.write_phases(nodes, ["track"] * 3 + ["circle"] * 3)
    np.testing.assert_allclose(nodes.state_weight[0, :6], 0.02 * np.array([400, 400, 400, 100, 100, 100]))
    np.testing.assert_allclose(nodes.state_weight[0, 6:], 0.02 * 4.0)
    np.testing.assert_allclose(nodes.translation_weight[:, 0], [0.0, 2.0, 4.0, 150.0, 150.0, 150.0])
    np.testing.assert_allclose(nodes.translation_weight[:, 2], [0.0, 2.0, 4.0, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(nodes.force_weight[:, 0], [0.01] * 5 + [0.05 * 3e-3])
    np.testing.assert_allclose(nodes.velocity_weight[-1], 1.0 * 3e-3)
    np.testing.assert_allclose(nodes.force_rate_weight[0], 6e-7)
    assert nodes.contact_active.tolist() == [False] * 3 + [True] * 3
    rigid = problem_from_robot(polishing_arm(), TorqueFeedbackMpc()).weights["track"]
    np.testing.assert_allclose(rigid["translation_weight"][:, 0], [0.0, 5.0, 10.0, 12.0, 12.0, 12.0])
    np.testing.assert_allclose(rigid["control_gravity_weight"][0], 1e-9)
    classical = problem_from_robot(polishing_arm(), ClassicalMpc()).weights["contact"]
    np.testing.assert_allclose(classical["translation_weight"], 2.0)


def test_friction_of_the_contact_is_not_that_of_the_cone() -> None:
    sliding = problem_from_robot(polishing_arm(), config("force_feedback", 3, friction=0.3))
    assert sliding.nodes().sliding_friction.tolist() == [0.3] * 6
    assert np.all(np.isinf(sliding.nodes().friction))
    bounded = problem_from_robot(polishing_arm(), config("force_feedback", 3, bounds={"friction": 0.5}))
    assert np.all(np.isinf(bounded.nodes().sliding_friction))
    assert bounded.nodes().friction.tolist() == [0.5] * 6


def test_an_unknown_phase_lists_the_known_ones() -> None:
    problem = problem_from_robot(polishing_arm(), ForceFeedbackMpc())
    with pytest.raises(ConfigError, match=r"phase 'circel'.*did you mean 'circle'"):
        problem.write_phases(problem.nodes(), ["circel"] * 6)


def test_a_phase_may_have_its_own_terms() -> None:
    costs = Costs(rotation=Term(weight=1.0), force=Term(weight=2.0))
    own = PhaseCosts(contact=True, rotation=Term(weight=7.0)).over(costs)
    assert own.rotation.weight == 7.0
    assert own.force.weight == 2.0


@pytest.mark.parametrize(("dimension", "axes"), [(1, "surface"), (3, "local"), (6, "world")])
def test_wrenches_are_projected_on_the_contact_axes(dimension: int, axes: str) -> None:
    problem = problem_from_robot(polishing_arm(), config("force_feedback", dimension, axes))
    rng = np.random.default_rng(2)
    wrench, R = rng.normal(size=6), pin.exp3(rng.normal(size=3))
    frame = {"world": np.eye(3), "local": R, "surface": problem.R_world_surface}[axes]
    R = problem.contact_axes(R, None)
    turned = np.concatenate([frame.T @ wrench[:3], frame.T @ wrench[3:]])
    expected = {1: turned[2:3], 3: turned[:3], 6: turned}[dimension]
    np.testing.assert_allclose(problem.in_contact_axes(wrench, R), expected)
    stacked = problem.in_contact_axes(np.tile(wrench, (4, 1)), np.tile(R, (4, 1, 1)))
    np.testing.assert_allclose(stacked, np.tile(expected, (4, 1)))


def test_bounds_reach_the_nodes() -> None:
    settings = ForceFeedbackMpc(bounds={"torque": True, "force_max": 80.0})  # type: ignore[arg-type]
    robot = polishing_arm()
    nodes = problem_from_robot(robot, settings).nodes()
    np.testing.assert_allclose(nodes.torque_upper, np.tile(robot.torque_limit, (6, 1)))
    assert nodes.force_lower.min() == 0.0
    assert nodes.force_upper.max() == 80.0


def test_the_controllers_are_offered_with_units() -> None:
    kinds = ("force-feedback", "offset-free", "torque-feedback", "classical", "visco-elastic")
    assert set(CONTROLLERS) == {f"{kind}-mpc" for kind in kinds}
    for name in ("dt", "period", "time_budget", "torque_bandwidth", "fallback_damping"):
        extra = MpcConfig.model_fields[name].json_schema_extra
        assert isinstance(extra, dict)
        assert extra["unit"]
    entry, arm = CONTROLLERS["classical-mpc"], Robot.load("iiwa14", tool=Tool())
    with pytest.raises(ConfigError, match="at least the control period"):
        entry.build(arm, entry.default, 5e-3)
