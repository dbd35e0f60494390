"""Rotations: group laws, the neighbourhood of π, and the Jacobian by finite differences."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pliant.errors import ConfigError, ShapeError, SignalError
from pliant.spatial import as_vector, exp3, frame_with_z_along, log3, quaternion, quaternions, rpy, skew
from tests.rotations import left_jacobian_inverse

directions = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda d: math.hypot(*d) > 1e-2)


@given(directions, st.floats(0.0, math.pi - 1e-9))
def test_log_undoes_exp(direction: tuple[float, float, float], angle: float) -> None:
    w = np.array(direction) / np.linalg.norm(direction) * angle
    np.testing.assert_allclose(log3(exp3(w)), w, atol=1e-8)


@given(directions, st.floats(math.pi - 1e-7, math.pi))
def test_log_near_pi_still_gives_the_rotation(direction: tuple[float, float, float], angle: float) -> None:
    R = exp3(np.array(direction) / np.linalg.norm(direction) * angle)
    e = log3(R)
    assert abs(np.linalg.norm(e) - angle) < 1e-6
    np.testing.assert_allclose(exp3(e), R, atol=1e-7)


def test_exp_and_log_agree_with_pinocchio() -> None:
    w = np.array([0.4, -1.2, 0.7])
    np.testing.assert_allclose(exp3(w), pin.exp3(w), atol=1e-14)
    np.testing.assert_allclose(log3(pin.exp3(w)), w, atol=1e-14)


@pytest.mark.parametrize("e", [[1e-6, 2e-6, -1e-6], [0.3, -0.2, 0.5], [1.5, 1.9, -0.7]])
def test_left_jacobian_inverse_is_the_derivative_of_log(e: list[float]) -> None:
    step = 1e-6
    columns = [
        (log3(exp3(step * axis) @ exp3(e)) - log3(exp3(-step * axis) @ exp3(e))) / (2 * step) for axis in np.eye(3)
    ]
    np.testing.assert_allclose(left_jacobian_inverse(e), np.array(columns).T, atol=1e-8)


@given(directions)
def test_surface_frame_has_its_normal_as_z(direction: tuple[float, float, float]) -> None:
    R = frame_with_z_along(direction)
    np.testing.assert_allclose(R[:, 2], np.array(direction) / np.linalg.norm(direction), atol=1e-9)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(R) == pytest.approx(1.0)


def test_quaternions_have_the_bits_of_pinocchio() -> None:
    rng = np.random.default_rng(0)
    sizes = np.repeat([0.0, 1e-9, 0.1, 1.0, 2.0, math.pi - 1e-9, math.pi], 50)  # each entry is the largest somewhere
    axes = rng.standard_normal((len(sizes), 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    rotations = np.array([exp3(size * axis) for size, axis in zip(sizes, axes, strict=True)])
    wanted = [[q.w, q.x, q.y, q.z] for q in map(pin.Quaternion, rotations)]
    np.testing.assert_array_equal(quaternions(rotations), wanted)
    np.testing.assert_array_equal([quaternion(R) for R in rotations], wanted)
    assert set(np.argmax(np.abs(wanted), axis=1)) == {0, 1, 2, 3}
    rotations[3, 1, 1] = math.nan
    assert np.isnan(quaternion(rotations[3])).all()
    found = quaternions(rotations)
    assert np.isnan(found[3]).all()
    assert np.isfinite(np.delete(found, 3, axis=0)).all()


def test_rpy_and_skew() -> None:
    np.testing.assert_allclose(rpy(math.pi, 0.0, math.pi), np.diag([-1.0, 1.0, -1.0]), atol=1e-12)
    np.testing.assert_allclose(skew([1, 2, 3]) @ [4, 5, 6], np.cross([1, 2, 3], [4, 5, 6]))


def test_vectors_are_checked_and_read_only() -> None:
    vector = as_vector(2.0, 3, "gain")
    assert vector.tolist() == [2.0, 2.0, 2.0]
    with pytest.raises(ValueError, match="read-only"):
        vector[0] = 1.0
    with pytest.raises(ShapeError, match="gain must have 3 entries"):
        as_vector([1.0, 2.0], 3, "gain")
    with pytest.raises(SignalError, match="gain must be finite"):
        as_vector([1.0, float("nan"), 2.0], 3, "gain")
    with pytest.raises(ConfigError, match="length above zero"):
        frame_with_z_along([0.0, 0.0, 0.0])


@pytest.mark.parametrize("angle", [3e-6, 9e-5, 0.99e-4, 1.01e-4, 1e-3])
def test_small_turns_are_rotations_to_double_precision(angle: float) -> None:
    """Below and above the angle at which the series takes over."""
    w = angle * np.array([0.36, -0.48, 0.8])
    np.testing.assert_allclose(exp3(w), pin.exp3(w), rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(exp3(w) @ exp3(w).T, np.eye(3), rtol=0.0, atol=1e-12)
