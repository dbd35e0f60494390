"""Compensation around the predictive problem: what is sent, what is remembered, what is refused."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pliant.configuration import merged
from pliant.environment import Environment
from pliant.errors import ConfigError, SignalError
from pliant.mpc import CONTROLLERS, Compensation, ForceFeedbackMpc, MpcController, OffsetFreeMpc
from pliant.mpc.config import Bounds
from pliant.signals import Estimate
from tests.twins.mpc_step.compensation import Compensator

from .test_controller import ROBOT, _estimate, _reference

PERIOD = 1e-3


def believing(estimate: Estimate, disturbance: float = 0.0, **changes: object) -> Estimate:
    return replace(estimate, disturbance=np.full(ROBOT.n, disturbance), **changes)


def controller(**compensation: object) -> MpcController:
    return MpcController(ROBOT, merged(ForceFeedbackMpc(), {"compensation": compensation}), PERIOD)


def steps(made: MpcController, estimates: list[Estimate], **reference: object) -> list[np.ndarray]:
    state, torques = made.init(estimates[0]), []
    for estimate in estimates:
        command, state = made.step(estimate, _reference(estimate.time, **reference), state)
        torques.append(command.torque)
    return torques


def test_the_disturbance_is_taken_out_of_the_torque() -> None:
    """Solve in ũ, send u = ũ − d̂."""
    plain = steps(controller(), [_estimate()])[0]
    compensated = steps(controller(disturbance=True), [believing(_estimate(), 1.5)])[0]
    np.testing.assert_allclose(compensated, plain - 1.5, atol=1e-12)
    assert np.abs(steps(controller(), [believing(_estimate(), 1.5)])[0] - plain).max() == 0.0  # baseline: not asked


def test_a_disturbance_that_is_not_finite_keeps_the_last_one() -> None:
    good, bad = believing(_estimate(), 1.5), believing(_estimate(PERIOD), float("nan"))
    torques = steps(controller(disturbance=True), [good, bad])
    assert np.isfinite(torques).all()
    np.testing.assert_array_equal(torques[0], torques[1])


def compensator(**compensation: object) -> Compensator:
    """The readable one, which the compiled step agrees with (`test_step.py`)."""
    made = controller(**compensation)
    return Compensator(made.config.compensation, made.problem, made.chain, PERIOD)


def test_an_average_passes_a_constant_and_stops_what_rings() -> None:
    """The mean over 4 ms has zeros at 250 and 500 Hz; baseline: without it the ringing passes."""
    seen: dict[str, list[float]] = {"averaged": [], "bare": []}
    start = _estimate()
    for name, part in (("averaged", compensator(averaging=4e-3)), ("bare", compensator())):
        state = part.init(start)
        for tick in range(40):
            wanted = np.full(ROBOT.n, 5.0 + np.cos(0.5 * np.pi * tick))
            sent, state = part.send(wanted, state)
            seen[name].append(float(sent[0]))
    np.testing.assert_allclose(seen["averaged"][8:], 5.0, atol=1e-12)
    assert np.ptp(seen["bare"][8:]) == pytest.approx(2.0)


@given(st.lists(st.floats(-80.0, 80.0), min_size=12, max_size=12), st.floats(-50.0, 50.0))
def test_every_torque_is_within_the_limits(offsets: list[float], disturbance: float) -> None:
    made = controller(disturbance=True, averaging=4e-3, computation_delay=5e-3)
    estimates = [
        believing(_estimate(PERIOD * k, ROBOT.home + 0.01 * offset), disturbance) for k, offset in enumerate(offsets)
    ]
    torques = np.array(steps(made, estimates, offset=0.5))
    assert np.isfinite(torques).all()
    assert (np.abs(torques) <= ROBOT.torque_limit + 1e-12).all()


def test_torques_under_way_are_kept_in_order() -> None:
    made = controller(sensing_delay=1e-3, computation_delay=2e-3)
    start = _estimate()
    state = made.init(replace(start, torque_sent=np.full(ROBOT.n, 7.0)))
    assert len(state.commands) == 4  # three under way, and the one that acted at the reading
    np.testing.assert_array_equal(state.commands[0], 7.0)
    sent = []
    for tick in range(6):
        command, state = made.step(_estimate(PERIOD * tick), _reference(PERIOD * tick, offset=0.02 * tick), state)
        sent.append(command.torque)
    for kept, was in zip(state.commands, sent[-4:], strict=True):
        np.testing.assert_array_equal(kept, was)


def test_the_lead_is_the_delay_and_half_the_average() -> None:
    assert controller().delays.lead == 0.0
    assert controller(sensing_delay=1e-3).delays.lead == 0.0  # readings are late, commands are not
    assert controller(computation_delay=5e-3).delays.lead == pytest.approx(5e-3)
    assert controller(computation_delay=5e-3, averaging=4e-3).delays.lead == pytest.approx(7e-3)


def test_the_force_shift_integrates_in_contact_only() -> None:
    made = controller(force_integral=10.0, force_shift_max=3.0)
    state = made.init(_estimate(force=20.0))
    shifts = []
    for tick in range(400):
        estimate = _estimate(PERIOD * tick, force=20.0)
        command, state = made.step(estimate, _reference(PERIOD * tick, phase="circle", force=50.0), state)
        shifts.append(command.diagnostics["mpc/force_shift"])
    assert shifts[8] == pytest.approx(10.0 * 30.0 * 8e-3, rel=0.2)  # k_i ∫ e, one solve every 2 ms
    assert shifts[-1] == 3.0  # the bound
    command, state = made.step(_estimate(0.4, force=0.0), _reference(0.4, phase="circle", force=50.0), state)
    assert command.diagnostics["mpc/force_shift"] == 0.0


def test_the_estimated_stiffness_replaces_the_assumed_one_within_its_range() -> None:
    made = MpcController(ROBOT, OffsetFreeMpc(), PERIOD)
    believed = {"tool": Environment(5e3, 100.0, 10.0, 10.0)}
    state = made.init(_estimate())
    _, state = made.step(believing(_estimate(), environments=believed), _reference(), state)
    assert (state.nodes.stiffness == 5e3).all()
    assert (state.contact.stiffness == 5e3).all()
    stiff = {"tool": Environment(1e9, 100.0, 10.0, 10.0)}
    _, state = made.step(believing(_estimate(2e-3), environments=stiff), _reference(2e-3), state)
    assert (state.nodes.stiffness == made.problem.stiffness_max).all()
    assert made.problem.stiffness_max > 1e5
    _, state = made.step(believing(_estimate(4e-3)), _reference(4e-3), state)  # nothing is known any more
    assert (state.nodes.stiffness == OffsetFreeMpc().contact.stiffness[0]).all()
    assert (state.contact.stiffness == OffsetFreeMpc().contact.stiffness[0]).all()


@pytest.mark.parametrize(
    ("used", "environment", "expected"),
    [
        (True, Environment(5e3, 80.0, 10.0, 15.0), 80.0),
        (False, Environment(5e3, 80.0, 10.0, 15.0), 100.0),
        (True, Environment(5e3, 80.0, 10.0, 17.0), 100.0),  # more than a fifth uncertain
        (True, Environment(5e3, 80.0, 10.0, math.inf), 100.0),
        (True, Environment(2e4, 80.0, 10.0, 1.0), 100.0),  # K times 1 ms is a quarter of it
    ],
)
def test_the_estimated_damping_is_used_where_it_is_known(used: bool, environment: Environment, expected: float) -> None:
    config = merged(OffsetFreeMpc(), {"compensation": {"environment_damping": used}})
    made = MpcController(ROBOT, config, PERIOD)
    known = believing(_estimate(), environments={"tool": environment})
    _, state = made.step(known, _reference(), made.init(_estimate()))
    assert (state.nodes.damping == expected).all()
    assert (state.contact.damping == expected).all()


def test_torque_bounds_are_those_of_what_is_sent() -> None:
    config = merged(ForceFeedbackMpc(bounds=Bounds(torque=True)), {"compensation": {"disturbance": True}})
    made = MpcController(ROBOT, config, PERIOD)
    _, state = made.step(believing(_estimate(), 4.0), _reference(), made.init(_estimate()))
    np.testing.assert_allclose(state.nodes.torque_upper[0], ROBOT.torque_limit + 4.0)
    np.testing.assert_allclose(state.nodes.torque_lower[0], 4.0 - ROBOT.torque_limit)


def test_bad_input_is_named() -> None:
    with pytest.raises(ConfigError, match="whole multiple of the control period"):
        controller(computation_delay=1.5e-3)
    with pytest.raises(ConfigError, match="between = 'riccati'"):
        merged(ForceFeedbackMpc(), {"between": "riccati", "compensation": {"averaging": 4e-3}})
    made = controller(disturbance=True)
    with pytest.raises(SignalError, match="MomentumObserver"):
        made.step(_estimate(), _reference(), made.init(_estimate()))
    assert CONTROLLERS["offset-free-mpc"].default.compensation != Compensation()


def test_the_prediction_takes_the_oldest_torques_first_and_averages_the_newest() -> None:
    """What is under way acts in its order; beyond it, means of the last wanted torques with the newest repeated."""
    made = compensator(averaging=3e-3)
    seen: list[tuple[list[np.ndarray], np.ndarray]] = []

    class Spy:
        def ahead(self, x: np.ndarray, torques: list[np.ndarray], acting: np.ndarray, touching: bool) -> np.ndarray:
            seen.append((torques, acting))
            return x

    made._prediction = Spy()  # type: ignore[assignment]
    one = np.ones(ROBOT.n)
    state = replace(made.init(_estimate()), commands=(1.0 * one, 2.0 * one), wanted=(3.0 * one, 6.0 * one, 12.0 * one))
    made.ahead(np.zeros(2 * ROBOT.n), 0.5 * one, True, state)
    ((torques, acting),) = seen
    assert acting == pytest.approx(1.5 * one)
    assert [float(torque[0]) for torque in torques] == pytest.approx([2.5, (6.0 + 12.0 + 12.0) / 3.0 + 0.5])
