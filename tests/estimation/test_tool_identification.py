"""Tool identification: exact without noise, honest about its uncertainty, and it refuses poses that say nothing."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pliant.errors import ConfigError, RobotError, ShapeError, SignalError
from pliant.estimation import CarriedMass, WrenchEstimator, excitation, identification_poses, identify_tool
from pliant.estimation.identification_poses import _smallest_singular_value
from pliant.robot import Robot
from pliant.signals import Measurement
from pliant.spatial import exp3

G = np.array([0.0, 0.0, -9.81])
MASS, CENTER = 0.73, np.array([0.02, -0.01, 0.09])
BIAS = np.array([1.5, -2.0, 0.7, 0.05, 0.02, -0.04])
NOISE = np.array([0.3] * 3 + [0.02] * 3)  # N, N·m


def turns(count: int, seed: int) -> np.ndarray:
    return np.array([exp3(w) for w in np.random.default_rng(seed).uniform(-2.0, 2.0, (count, 3))])


def read(R: np.ndarray, mass: float = MASS, center: np.ndarray = CENTER, bias: np.ndarray = BIAS) -> np.ndarray:
    weight = mass * np.einsum("nji,j->ni", R, G)
    return np.hstack([weight, np.cross(center, weight)]) + bias


@given(st.floats(0.05, 20.0), st.integers(0, 1000))
def test_exact_without_noise(mass: float, seed: int) -> None:
    draw = np.random.default_rng(seed)
    center, bias, R = draw.normal(0.0, 0.1, 3), draw.normal(0.0, 3.0, 6), turns(8, seed)
    found = identify_tool(read(R, mass, center, bias), R, condition_limit=1e3)
    assert found.mass == pytest.approx(mass, rel=1e-9)
    np.testing.assert_allclose(found.center, center, atol=1e-8)
    np.testing.assert_allclose(found.bias, bias, atol=1e-8)


def standardised_errors(rows_per_pose: int, common: float) -> np.ndarray:
    """Errors over their standard uncertainty, (runs, 10), each pose read `rows_per_pose` times.

    Args:
        rows_per_pose: rows handed to the fit for each pose.
        common: share of the variance that the rows of a pose have in common.
    """
    draw, errors = np.random.default_rng(5), []
    for run in range(250):
        poses = turns(8, run)
        R = np.repeat(poses, rows_per_pose, axis=0)
        shared = np.repeat(draw.normal(size=(8, 6)), rows_per_pose, axis=0)
        own = draw.normal(size=(R.shape[0], 6))
        found = identify_tool(read(R) + NOISE * (math.sqrt(common) * shared + math.sqrt(1.0 - common) * own), R)
        error = [found.mass - MASS, *(found.first_moment - MASS * CENTER), *(found.bias - BIAS)]
        errors.append(np.array(error) / [found.mass_std, *found.first_moment_std, *found.bias_std])
    return np.array(errors)


def test_uncertainty_is_honest() -> None:
    errors = standardised_errors(rows_per_pose=1, common=1.0)
    # Student's t with 20 and 18 degrees of freedom: variance ν/(ν − 2), and 67 % within one standard uncertainty
    np.testing.assert_allclose(np.mean(errors**2, axis=0), 20 / 18, atol=0.3)
    assert np.mean(np.abs(errors) < 1.0) == pytest.approx(0.67, abs=0.03)
    assert np.mean(np.abs(errors) < 3.0) > 0.985


def test_uncertainty_would_be_too_small_with_every_sample_as_a_row() -> None:
    """Baseline: samples of one pose share its error, and counting each on its own hides that."""
    errors = standardised_errors(rows_per_pose=20, common=0.5)
    assert np.mean(np.abs(errors) < 1.0) < 0.45


def test_center_has_the_uncertainty_that_it_shows() -> None:
    draw, errors = np.random.default_rng(1), []
    for run in range(250):
        R = turns(10, run)
        found = identify_tool(read(R) + NOISE * draw.normal(size=(10, 6)), R)
        errors.append((found.center - CENTER) / found.center_std)
    assert np.mean(np.abs(errors) < 1.0) == pytest.approx(0.67, abs=0.05)


def test_poses_that_do_not_excite_are_refused() -> None:
    upright = np.array([exp3([0.0, 0.0, angle]) for angle in np.linspace(0.0, 3.0, 8)])  # turns about gravity only
    with pytest.raises(ConfigError, match=r"condition number inf.*three clearly different directions"):
        identify_tool(read(upright), upright)
    nodding = np.array([exp3([angle, 0.0, 0.0]) for angle in np.linspace(-0.05, 0.05, 8)])
    with pytest.raises(ConfigError, match="condition number"):
        identify_tool(read(nodding), nodding)
    assert excitation(turns(8, 0)) < 5.0


def test_no_tool_has_no_center() -> None:
    R = turns(8, 0)
    noise = np.random.default_rng(0).normal(size=(8, 6)) * NOISE
    found = identify_tool(read(R, mass=0.0) + noise, R)
    assert found.center is None
    assert found.carried().mass == 0.0
    assert np.all(np.abs(found.bias - BIAS) < 3.5 * found.bias_std)


def test_what_is_found_makes_the_contact_wrench_vanish_in_free_space(lwr4: Robot) -> None:
    poses = identification_poses(lwr4, "flange", 6)
    R = np.array([lwr4.placement(q, "flange")[1] for q in poses])
    found = identify_tool(read(R), R)
    zero = np.zeros(lwr4.n)
    for q in np.random.default_rng(2).uniform(lwr4.position_lower, lwr4.position_upper, (5, lwr4.n)):
        reading = read(lwr4.placement(q, "flange")[1][None])[0]
        m = Measurement(0.0, q, zero, zero, zero, {"flange": reading})
        left = {}
        for name, carried in {"found": found.carried(), "no bias": CarriedMass(MASS, tuple(CENTER))}.items():
            estimator = WrenchEstimator(lwr4, {"flange": carried})
            left[name] = np.max(np.abs(estimator.step(m, estimator.init(m))[0].wrenches["flange"]))
        assert left["found"] < 1e-8
        assert left["no bias"] > 1.0  # baseline


@pytest.mark.parametrize(("name", "frame"), [("lwr4", "flange"), ("iiwa14", "flange"), ("leg3", "foot")])
def test_chosen_poses_excite_and_keep_the_limits(name: str, frame: str) -> None:
    robot = Robot.load(name)
    poses = identification_poses(robot, frame, 8, lowest=-10.0)
    assert poses.shape == (8, robot.n)
    assert np.all(poses >= robot.position_lower)
    assert np.all(poses <= robot.position_upper)
    np.testing.assert_array_equal(poses[0], robot.home)
    chosen = excitation([robot.placement(q, frame)[1] for q in poses])
    draw = np.random.default_rng(0)
    near_home = robot.home + draw.uniform(-0.1, 0.1, (8, robot.n))
    assert chosen < 3.0
    assert excitation([robot.placement(q, frame)[1] for q in near_home]) > 10.0  # baseline


def test_bad_input_is_named(lwr4: Robot) -> None:
    R = turns(8, 0)
    with pytest.raises(ConfigError, match="at least 4 poses, got 3"):
        identify_tool(read(R[:3]), R[:3])
    with pytest.raises(ShapeError, match=r"\(N, 6\)"):
        identify_tool(read(R), R[:5])
    with pytest.raises(SignalError, match="finite"):
        identify_tool(read(R) * np.nan, R)
    with pytest.raises(ConfigError, match="let more joints move"):
        identification_poses(lwr4, "flange", 6, joints=1, share=0.02)
    with pytest.raises(ConfigError, match="share"):
        identification_poses(lwr4, "flange", 6, share=0.0)
    with pytest.raises(RobotError, match="no frame"):
        identification_poses(lwr4, "flang")


@pytest.mark.parametrize(("name", "frame", "rows"), [("ur5e", "flange", 6), ("leg3", "foot", 3)])
def test_a_robot_that_can_turn_its_tool_freely_is_measured_in_all_six_directions(
    name: str, frame: str, rows: int
) -> None:
    robot = Robot.load(name)
    data, index = robot.model.createData(), robot.frame_id(frame)
    q = robot.home + 0.1
    J = pin.computeFrameJacobian(robot.model, data, q, index, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    least = float(np.linalg.svd(J[:rows], compute_uv=False)[-1])
    assert _smallest_singular_value(robot, robot.model.createData(), q, index) == pytest.approx(least, rel=1e-9)
