"""Damping of a motion against that of its reference: it takes energy at one rate in each direction and of self-motion,
and free axes have none."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from pliant.axis_modes import AxisModes
from pliant.controllers import FrameTask, Stack
from pliant.controllers.damping import Damping
from pliant.errors import ConfigError
from pliant.rigid_body import mass_matrix
from pliant.robot import Robot, Tool
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import Array, exp3

RATE = 50.0  # 1/s
ARM = Robot.load("panda", tool=Tool())
MODEL, DATA = ARM.model, ARM.model.createData()
J = np.array(
    pin.computeFrameJacobian(MODEL, DATA, ARM.home, ARM.frame_id("tool"), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
)
M = mass_matrix(MODEL, DATA, ARM.home)
LIFT = np.linalg.solve(M, J.T) @ np.linalg.inv(J @ np.linalg.solve(M, J.T))  # (7, 6): joints' motion of least energy


def damped(v: Array, wanted: Array, rate: float = RATE, oriented: bool = True, modes: AxisModes | None = None) -> Array:
    """Torque at the target, (n,), where nothing but the damping acts. Args: wanted: (6,) velocity of the reference."""
    position, rotation = ARM.placement(ARM.home, "tool")
    tuning = ImpedanceTuning(np.full(6, 2500.0), np.full(6, 100.0), np.full(6, 0.06))
    stack = Stack(ARM, [FrameTask("tool", tuning, label="ee")], 1e-3, damping=Damping(motion_damping=rate))
    zero = np.zeros(ARM.n)
    estimate = Estimate(0.0, ARM.home, v, zero, zero)
    task = TaskReference("tool", position, rotation if oriented else None, wanted, modes=modes)
    return stack.step(estimate, Reference(0.0, (task,)), stack.init(estimate))[0].torque


@pytest.mark.parametrize(("oriented", "rows"), [(True, 6), (False, 3)])
def test_each_direction_of_the_motion_is_slowed_down_at_the_same_rate(oriented: bool, rows: int) -> None:
    """J M⁻¹ τ = rate · (ẋ_d − ẋ), whatever the self-motion, but for δ² = 4e-4 /kg near singularities; one number for
    all axes is the control."""
    rng = np.random.default_rng(0)
    part, off = J[:rows], []
    for _ in range(20):
        v, wanted = 0.02 * rng.normal(size=ARM.n), 0.02 * rng.normal(size=6)
        way = wanted[:rows] - part @ v
        torque = damped(v, wanted, oriented=oriented)
        np.testing.assert_allclose(part @ np.linalg.solve(M, torque), RATE * way, atol=0.02 * RATE * np.abs(way).max())
        assert torque @ v - torque @ (LIFT[:, :rows] @ wanted[:rows]) < 0.0  # power taken from the difference
        plain = part @ np.linalg.solve(M, part.T @ way)
        off.append(np.abs(plain * (way @ plain) / (plain @ plain) - way).max() / np.abs(way).max())
    assert max(off) > 0.3


def test_a_motion_as_the_reference_asks_for_and_free_axes_are_left_alone() -> None:
    rng = np.random.default_rng(1)
    axes = AxisModes(("motion", "motion", "free", "free", "free", "free"), exp3(np.array([0.4, -0.3, 0.6])))
    for _ in range(20):
        v = LIFT @ (0.02 * rng.normal(size=6))
        assert np.abs(damped(v, J @ v)).max() < 0.05  # δ² = 4e-4 /kg
        free = J @ v + np.concatenate([axes.rotation[:, 2], rng.normal(size=3)])
        assert np.abs(damped(v, free, modes=axes)).max() < 0.05
        assert np.abs(damped(v, free)).max() > 1.0  # the control
        assert np.abs(damped(v, np.zeros(6), rate=0.0)).max() < 1e-12


def test_self_motion_is_slowed_down_at_the_rate_and_moves_no_frame() -> None:
    """τ = −rate · M v where J v = 0: a damping of the frame alone, which gives nothing there, is the control."""
    rng = np.random.default_rng(2)
    inner = np.linalg.svd(J)[2][6]
    for _ in range(5):
        v = 0.3 * rng.normal() * inner
        torque = damped(v, np.zeros(6))
        np.testing.assert_allclose(torque, -RATE * M @ v, atol=1e-9)
        assert np.abs(J @ np.linalg.solve(M, torque)).max() < 1e-9
        assert np.abs(RATE * J.T @ np.linalg.solve(J @ np.linalg.solve(M, J.T), J @ v)).max() < 1e-9


@pytest.mark.parametrize("value", [-1.0, np.inf, np.nan])
@pytest.mark.parametrize("name", ["joint_damping", "motion_damping"])
def test_what_no_damper_has_is_refused(name: str, value: float) -> None:
    wrong: dict[str, Any] = {name: value}
    with pytest.raises(ConfigError, match=f"{name} must be finite and not negative"):
        Damping(**wrong)
