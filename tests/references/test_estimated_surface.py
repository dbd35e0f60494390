"""References turned onto the surface that is felt."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pliant.environment import EstimatedSurface
from pliant.errors import ConfigError
from pliant.references.estimated_surface import OnEstimatedSurface, turned
from pliant.signals import Estimate, Preview, Reference, TaskReference
from pliant.spatial import Array, exp3
from pliant.surfaces import PlaneSurface, SphereSurface, SurfaceGeometry

SURFACES: tuple[SurfaceGeometry, ...] = (
    PlaneSurface(np.array([0.5, 0.0, 0.1]), exp3(np.array([0.3, -0.2, 0.0]))),
    SphereSurface(np.array([0.5, 0.0, -0.1]), np.eye(3), radius=0.2),
)
ANGLES = st.tuples(*[st.floats(-0.1, 0.1)] * 3)
ZERO = np.zeros(7)


def on(surface: SurfaceGeometry, count: int = 4) -> Reference:
    """A task 15 mm over a surface that presses 20 N along its normal, with a preview along a line."""
    uv = np.array([[0.01 * k, 0.003 * k] for k in range(count)])
    top = surface.top()
    places, normals = surface.chart(top, surface.tangent(top, (1.0, 0.0, 0.0)), uv)
    axes = np.array([axes_of(normal) for normal in normals])
    position, wrench = places + 0.015 * normals, np.concatenate([20.0 * normals, np.zeros((count, 3))], axis=1)
    velocity = np.concatenate([0.05 * axes[:, :, 0], np.zeros((count, 3))], axis=1)
    task = TaskReference("tool", position[0], axes[0], velocity[0], velocity[0], wrench[0], None, axes[0])
    ahead = Preview(np.arange(float(count)), position, axes, velocity, wrench, task_rotation=axes)
    return Reference(0.0, (task,), None, "follow", ahead)


def axes_of(normal: Array) -> Array:
    x = np.cross([0.0, 1.0, 0.0], normal)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(normal, x), normal])


@given(turn=ANGLES, which=st.integers(0, 1))
def test_a_turned_reference_is_on_the_turned_surface(turn: tuple[float, float, float], which: int) -> None:
    """Height, direction of the force and axes are on the moved surface what they were on the believed one."""
    surface, R = SURFACES[which], exp3(np.array(turn))
    pivot = surface.top() + np.array([0.02, 0.01, 0.0])
    reference = turned(on(surface), R, pivot, "tool")
    moved = surface.moved(0.0, turn, pivot)
    task, ahead = reference.tasks[0], reference.preview
    assert ahead is not None
    assert ahead.task_rotation is not None
    for position, wrench, axes, velocity in [
        (task.position, task.wrench, task.task_rotation, task.velocity),
        *zip(ahead.position, ahead.wrench, ahead.task_rotation, ahead.velocity, strict=True),
    ]:
        near = moved.near(position)
        assert near.distance == pytest.approx(0.015, abs=1e-9)
        np.testing.assert_allclose(wrench[:3], 20.0 * near.normal, atol=1e-9)
        np.testing.assert_allclose(axes[:, 2], near.normal, atol=1e-9)
        assert velocity[:3] @ near.normal == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(ahead.position[0], task.position)
    np.testing.assert_allclose(ahead.rotation[0], task.rotation)


def test_other_frames_stay() -> None:
    reference = on(SURFACES[0])
    other = turned(reference, exp3(np.array([0.1, 0.0, 0.0])), np.zeros(3), "elbow")
    np.testing.assert_array_equal(other.tasks[0].position, reference.tasks[0].position)


class Still:
    def init(self, estimate: Estimate) -> None:
        return None

    def step(self, estimate: Estimate, state: None) -> tuple[Reference, None]:
        return on(SURFACES[0]), None


def felt_at(time: float, turn: Array | None) -> Estimate:
    if turn is None:
        return Estimate(time, ZERO, ZERO, ZERO, ZERO)
    felt = EstimatedSurface(np.array([0.5, 0.0, 0.1]), turn, np.array([0.0, 0.0, 1.0]), 0.1)
    return Estimate(time, ZERO, ZERO, ZERO, ZERO, surfaces={"tool": felt})


def test_the_turn_is_continuous_and_arrives() -> None:
    source, turn = OnEstimatedSurface(Still(), "tool", memory=0.1), np.array([0.05, -0.03, 0.0])
    state = source.init(felt_at(0.0, None))
    reference, state = source.step(felt_at(0.0, None), state)
    before = reference.tasks[0]
    np.testing.assert_array_equal(before.position, on(SURFACES[0]).tasks[0].position)
    assert not np.any(reference.diagnostics["surface/turn"])  # nothing is known yet
    for k in range(1, 1001):
        last = reference.tasks[0].wrench
        reference, state = source.step(felt_at(1e-3 * k, turn), state)
        assert np.linalg.norm(reference.tasks[0].wrench - last) < 20.0 * 0.06 * 1e-3 / 0.1
    np.testing.assert_allclose(reference.diagnostics["surface/turn"], turn, rtol=1e-3)
    moved = SURFACES[0].moved(0.0, turn, (0.5, 0.0, 0.1))
    np.testing.assert_allclose(reference.tasks[0].wrench[:3], 20.0 * moved.normal(before.position), atol=1e-3)


def test_a_time_constant_must_be_above_zero() -> None:
    with pytest.raises(ConfigError, match="time constant"):
        OnEstimatedSurface(Still(), "tool", memory=0.0)
