"""Rotations: the moment J_l⁻¹(e) h is power-conjugate to the angular velocity; h itself is not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pliant.controllers import FractalImpedance, FrameTask
from pliant.robot import Robot
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import exp3, log3
from tests.rotations import left_jacobian_inverse

vectors = st.tuples(*[st.floats(-1.0, 1.0)] * 3).map(np.array)


def error_rate(e: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """ė of e = log(R_d Rᵀ) for a fixed target, by central differences."""
    step = 1e-5
    ahead, behind = (log3(exp3(e) @ exp3(sign * step * omega).T) for sign in (1.0, -1.0))
    return (ahead - behind) / (2 * step)


@given(vectors, vectors, vectors)
def test_the_moment_does_the_work_of_the_error_port(e: np.ndarray, h: np.ndarray, omega: np.ndarray) -> None:
    e = 2.5 * e / max(1.0, float(np.linalg.norm(e)))
    moment = left_jacobian_inverse(e) @ h
    assert moment @ omega == pytest.approx(-h @ error_rate(e, omega), abs=1e-7)


def test_the_plain_moment_misses_by_an_eighth_at_a_quarter_radian() -> None:
    """Baseline: m = h with unequal gains, worst axis of rotation."""
    e = 0.25 * np.array([1.0, 1.0, 1.0]) / np.sqrt(3.0)
    worst = 0.0
    for h in np.eye(3):
        rates = np.column_stack([error_rate(e, axis) for axis in np.eye(3)])
        worst = max(worst, float(np.linalg.norm(h + rates.T @ h)))
    assert 0.08 < worst < 0.16


@pytest.mark.parametrize("angle", [0.05, 0.25, 1.5])
def test_the_controller_applies_it(lwr4: Robot, angle: float) -> None:
    tuning = ImpedanceTuning(
        np.array([0, 0, 0, 300.0, 30.0, 3.0]),
        np.array([0, 0, 0, 100.0, 50.0, 20.0]),
        np.array([0.1, 0.1, 0.1, 2.0, 2.0, 2.0]),
        np.array([0.01, 0.01, 0.01, 0.2, 0.2, 0.2]),
    )
    controller = FractalImpedance(lwr4, FrameTask("flange", tuning, "ee"), 1e-3)
    q, zero = np.array(lwr4.home), np.zeros(lwr4.n)
    position, rotation = lwr4.placement(q, "flange")
    e = angle * np.array([1.0, -2.0, 0.5]) / np.linalg.norm([1.0, -2.0, 0.5])
    reference = Reference(0.0, (TaskReference("flange", position, exp3(e) @ rotation),))
    estimate = Estimate(0.0, q, zero, zero, zero)
    command, _ = controller.step(estimate, reference, controller.init(estimate))
    channels = command.diagnostics
    assert np.asarray(channels["ee/error"])[3:] == pytest.approx(e, abs=1e-9)
    h = np.asarray(channels["ee/force"])[3:]
    assert np.asarray(channels["ee/wrench"])[3:] == pytest.approx(left_jacobian_inverse(e) @ h, abs=1e-9)
    # The torque does that work in the joints: τ·v = −h·ė for any joint velocity.
    v = np.array([0.3, -0.2, 0.5, 0.1, -0.4, 0.2, 0.6])
    step = 1e-6
    ahead, behind = (exp3(e) @ rotation @ lwr4.placement(q + s * step * v, "flange")[1].T for s in (1.0, -1.0))
    e_rate = (log3(ahead) - log3(behind)) / (2 * step)
    assert (command.torque + command.clamped) @ v == pytest.approx(-h @ e_rate, abs=1e-6)
