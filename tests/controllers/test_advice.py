"""Advice: what it warns of really happens, and what it calls safe is safe."""

from __future__ import annotations

from collections import deque

import numpy as np
import pinocchio as pin
import pytest

from pliant.controllers.advice import advise, advise_damping, sentences, smallest_inertia
from pliant.controllers.presets import STIFF_STACK, TABLE_I_SIMULATION
from pliant.controllers.profiles import ForceProfile
from pliant.robot import Robot
from pliant.signals import ImpedanceTuning
from tests.laws.impedance_strategies import run_mass


def tuning_of(omega_T: float, mass: float, period: float) -> ImpedanceTuning:
    K_0 = mass * (omega_T / period) ** 2
    return ImpedanceTuning(np.array([K_0]), np.array([K_0 * 0.02]), np.array([0.02]), np.array([0.01]))


@pytest.mark.parametrize(("omega_T", "safe"), [(0.1, True), (0.35, True), (0.8, False)])
def test_the_sampling_rule_tells_a_mass_that_settles_from_one_that_does_not(omega_T: float, safe: bool) -> None:
    mass, period = 1.5, 1e-3
    tuning = tuning_of(omega_T, mass, period)
    rules = {advice.rule for advice in advise(tuning, period, mass, speed=0.0)}
    assert rules == (set() if safe else {"sampling"})
    run = run_mass(ForceProfile.of(tuning), mass=mass, start=0.005, seconds=2.0, account=False)
    assert (np.abs(run.error[-200:]).max() < 2e-4) == safe


@pytest.mark.parametrize(("omega_T", "settles"), [(0.35, True), (0.8, True), (1.2, False)])
def test_with_the_account_it_settles_beyond_the_rule_but_not_far(omega_T: float, settles: bool) -> None:
    run = run_mass(ForceProfile.of(tuning_of(omega_T, 1.5, 1e-3)), mass=1.5, start=0.005, seconds=2.0)
    assert (np.abs(run.error[-200:]).max() < 2e-4) == settles


def test_the_safe_value_is_the_border() -> None:
    advice = advise(tuning_of(0.8, 2.0, 1e-3), 1e-3, 2.0, speed=0.0)[0]
    assert (advice.value, advice.limit) == pytest.approx((0.8, 0.4))
    assert "safe: stiffness ≤ 3.2e+05" in advice.message
    assert advise(tuning_of(0.3999, 2.0, 1e-3), 1e-3, 2.0, speed=0.0) == []


def test_slow_actuators() -> None:
    tuning = ImpedanceTuning(np.array([6000.0]), np.array([150.0]), np.array([0.1]))
    omega = np.sqrt(6000.0 / 1.5)
    assert advise(tuning, 1e-3, 1.5, torque_bandwidth=2 * omega) == []
    (advice,) = advise(tuning, 1e-3, 1.5, torque_bandwidth=2 * np.pi * 8.0)
    assert advice.rule == "actuator"
    assert (advice.value, advice.limit) == pytest.approx((omega, 2 * np.pi * 8.0))


def test_a_sharp_knee_leaks_what_is_said(lwr4: Robot) -> None:
    """An error that grows at a constant speed: past the knee, the sampled force absorbs less than is stored."""
    ee = TABLE_I_SIMULATION.frame_tasks()[0].tuning
    inertia = smallest_inertia(lwr4, "flange")
    found = [advice for advice in advise(ee, 1e-3, inertia) if advice.rule == "knee"]
    assert [advice.axis for advice in found] == [0, 1, 2]
    assert found[0].value == pytest.approx(125.0 * 0.5 * 1e-3, rel=0.01)  # ΔF v T_s
    profile = ForceProfile.of(ee)
    leaks = []
    for offset in np.linspace(0.0, 0.5e-3, 11):
        x = offset + 0.5e-3 * np.arange(30)[:, None] * np.ones(6)
        work = (profile.force(x[:-1]) * np.diff(x, axis=0)).sum(axis=0)
        linear = 0.5 * 5000.0 * 0.5e-3 * 5e-3  # what the linear part loses to sampling as well
        leaks.append(float((profile.energy(x[-1]) - profile.energy(x[0]) - work)[0]) - linear)
    assert 0.4 * found[0].value < np.mean(leaks) < 0.7 * found[0].value
    assert max(leaks) < 1.1 * found[0].value


def test_the_default_stack_is_safe_at_1_kHz_and_not_at_100_Hz(lwr4: Robot) -> None:
    for task in STIFF_STACK.frame_tasks():
        inertia = smallest_inertia(lwr4, task.frame)[: task.axes]
        assert advise(task.tuning, 1e-3, inertia) == []
        slow = sentences(advise(task.tuning, 1e-2, inertia))
        assert task.label != "ee" or any(text.startswith("axis 0, 1, 2: stiffness 20000") for text in slow)


def test_the_smallest_inertia_is_a_bound_that_is_reached(lwr4: Robot) -> None:
    q, model = np.array(lwr4.home), lwr4.model
    inertia = smallest_inertia(lwr4, "flange", q)
    data = model.createData()
    J = pin.computeFrameJacobian(model, data, q, lwr4.frame_id("flange"), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    rest = pin.aba(model, data, q, np.zeros(7), np.zeros(7)).copy()
    felt = []
    for direction in np.random.default_rng(0).standard_normal((500, 3)):
        f = direction / np.linalg.norm(direction)
        a = J[:3] @ (pin.aba(model, data, q, np.zeros(7), J[:3].T @ f) - rest)
        felt.append(1.0 / float(f @ a))
    assert min(felt) >= inertia[0] * (1 - 1e-9)
    assert min(felt) <= inertia[0] * 1.05


def test_a_damping_that_the_loop_is_too_late_for_is_named() -> None:
    """v̇ = −d v(t − T): grows above d T = π/2 and decays below, and the warning says which."""

    def last(d: float, late: float, dt: float = 1e-4) -> float:
        delayed = deque([1.0] * round(late / dt))
        v = 1.0
        for _ in range(round(200 * late / dt)):
            delayed.append(v)
            v -= dt * d * delayed.popleft()
        return max(map(abs, delayed))

    late = 7e-3
    for turn, word in ((1.7, "is unstable"), (1.4, "makes it swing")):
        (text,) = advise_damping(turn / late, late)
        assert word in text
        assert (last(turn / late, late) > 1.0) == (word == "is unstable")
    assert advise_damping(0.4 / late, late) == ()
    assert advise_damping(0.0, late) == ()
