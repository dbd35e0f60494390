"""The compiled sum of half cosines against the same in Python."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pliant._references import superposed
from pliant.references.planners.superposition import HalfCosine, MotionLimits, Superposition


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


def test_pieces_that_do_not_fit_are_refused() -> None:
    piece = HalfCosine(0.0, 1.0, (1.0, 2.0), (1.0, 2.0))
    assert superposed((0.0, 0.0), (piece,), 2.0, 2)[0].tolist() == [1.0, 2.0]  # control
    with pytest.raises(ValueError, match="axes of its base"):
        superposed((0.0,), (piece,), 0.5, 2)
    with pytest.raises(ValueError, match="every axis"):
        superposed((0.0, 0.0), (piece,), 0.5, 1)
    with pytest.raises(ValueError, match="start, a duration"):
        superposed((0.0, 0.0), ((0.0, 1.0),), 0.5, 2)  # type: ignore[arg-type]
