"""The compiled sum of half cosines against the same in Python."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

from pliant._references import superposed, turning
from pliant.references.planners.superposition import HalfCosine, MotionLimits, Superposition
from pliant.spatial import Array, skew


def in_python(plan: Superposition, time: float) -> tuple[list[float], list[float], list[float]]:
    """Position, velocity and acceleration."""
    position, velocity = list(plan.base), [0.0] * len(plan.base)
    acceleration = [0.0] * len(plan.base)
    for start, duration, way, _ in plan.pieces:
        if time <= start:
            continue
        angle = math.pi * min((time - start) / duration, 1.0)
        rate = math.pi / duration if angle < math.pi else 0.0
        cosine = math.cos(angle)
        share = 0.5 * (1.0 - cosine)
        speed, push = 0.5 * rate * math.sin(angle), 0.5 * rate * rate * cosine
        for axis, length in enumerate(way):
            position[axis] += share * length
            velocity[axis] += speed * length
            acceleration[axis] += push * length
    return position, velocity, acceleration


def test_it_is_its_twin() -> None:
    random, limits = np.random.default_rng(1), MotionLimits(0.3, 3.0)
    plan = Superposition((0.1, -0.2, 0.3))
    for tick in range(3000):
        time = 1e-3 * tick
        if tick % 170 == 20:
            plan = plan.retargeted(time, tuple(random.uniform(-0.3, 0.3, 3).tolist()), limits)
        plan = plan.folded(time)
        twin = in_python(plan, time)
        assert tuple(map(list, plan.at(time))) == twin
        position, *rates = superposed(plan.base, plan.pieces, time, 6)
        assert [position.tolist(), *[rate[:3].tolist() for rate in rates]] == list(twin)
        assert not np.array(rates)[:, 3:].any()
    assert len(plan.pieces) > 1
    assert in_python(plan, time + 1e-6) != twin, "another time"


def left_jacobian(r: npt.ArrayLike) -> Array:
    """J_l(r) (3, 3), with ω = J_l(r) ṙ. Source: Chirikjian, Stochastic Models, vol. 2, eq. 10.86."""
    angle = float(np.linalg.norm(r))
    cross = skew(r)
    if angle < 1e-4:
        return np.eye(3) + 0.5 * cross + cross @ cross / 6.0
    first, second = (1.0 - np.cos(angle)) / angle**2, (angle - np.sin(angle)) / angle**3
    return np.eye(3) + first * cross + second * cross @ cross


@pytest.mark.parametrize("size", [0.0, 1e-6, 0.3, 3.0])
def test_a_turn_is_its_twin(size: float) -> None:
    random = np.random.default_rng(2)
    base, way = (tuple((part * random.normal(size=3)).tolist()) for part in (size, max(size, 1e-3)))
    plan, step = Superposition(base, (HalfCosine(0.2, 0.7, way, way),)), 1e-4

    def spin(time: float) -> Array:
        r, rate, _ = in_python(plan, time)
        return left_jacobian(r) @ np.array(rate)

    for time in np.linspace(0.0, 1.0, 41).tolist():
        velocity, change = turning(plan.base, plan.pieces, time, step)
        np.testing.assert_allclose(velocity, spin(time), rtol=1e-12, atol=1e-14)
        np.testing.assert_allclose(change, (spin(time + step) - spin(time - step)) / (2.0 * step), atol=1e-10)
    r, rate, _ = in_python(plan, 0.5)
    if size > 0.1:
        velocity, _ = turning(plan.base, plan.pieces, 0.5, step)
        assert not np.allclose(velocity, left_jacobian(r).T @ np.array(rate)), "the right Jacobian"
    with pytest.raises(ValueError, match="three axes"):
        turning((0.0,), (), 0.5, step)


def test_pieces_that_do_not_fit_are_refused() -> None:
    piece = HalfCosine(0.0, 1.0, (1.0, 2.0), (1.0, 2.0))
    assert superposed((0.0, 0.0), (piece,), 2.0, 2)[0].tolist() == [1.0, 2.0]  # control
    with pytest.raises(ValueError, match="axes of its base"):
        superposed((0.0,), (piece,), 0.5, 2)
    with pytest.raises(ValueError, match="every axis"):
        superposed((0.0, 0.0), (piece,), 0.5, 1)
    with pytest.raises(ValueError, match="start, a duration"):
        superposed((0.0, 0.0), ((0.0, 1.0),), 0.5, 2)  # type: ignore[arg-type]
