"""The controller as a part of the loop: finite and bounded whatever happens, warm, honest about itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from pliant.errors import ConfigError, PliantError, SignalError
from pliant.mpc import ClassicalMpc, ForceFeedbackMpc, MpcConfig, MpcController, TorqueFeedbackMpc
from pliant.mpc.diagnostics import CHANNELS, SOURCE_CODES, STATUS_CODES
from pliant.signals import Estimate, Reference, TaskReference
from pliant.spatial import Array

from .problems import polishing_arm

ROBOT = polishing_arm()
THREE = [ForceFeedbackMpc(), ClassicalMpc(), TorqueFeedbackMpc()]


def _gravity(q: Array) -> Array:
    return np.array(pin.computeGeneralizedGravity(ROBOT.model, ROBOT.model.createData(), q))


def _estimate(time: float = 0.0, q: Array | None = None, force: float = 0.0) -> Estimate:
    q = ROBOT.home if q is None else q
    wrench = np.array([0.0, 0.0, force, 0.0, 0.0, 0.0])
    return Estimate(time, q, np.zeros(6), _gravity(ROBOT.home), np.zeros(6), {"tool": wrench}, {"tool": force > 1.0})


def _reference(time: float = 0.0, offset: float = 0.0, phase: str = "track", force: float = 0.0) -> Reference:
    position, R = ROBOT.placement(ROBOT.home, "tool")
    wrench = np.array([0.0, 0.0, force, 0.0, 0.0, 0.0])
    return Reference(time, (TaskReference("tool", position + offset * np.eye(3)[0], R, wrench=wrench),), phase=phase)


@pytest.mark.parametrize("settings", THREE, ids=lambda c: c.kind)
def test_at_rest_on_target_it_holds_the_robot_up(settings: MpcConfig) -> None:
    controller = MpcController(ROBOT, settings)
    command, _ = controller.step(_estimate(), _reference(), controller.init(_estimate()))
    np.testing.assert_allclose(command.torque, _gravity(ROBOT.home), atol=1e-3)
    np.testing.assert_array_equal(command.clamped, 0.0)


@pytest.mark.parametrize("settings", THREE, ids=lambda c: c.kind)
def test_pressing_needs_the_torque_of_the_force(settings: MpcConfig) -> None:
    """In contact at the wanted force, at rest: τ = g(q) − Jᵀλ."""
    controller = MpcController(ROBOT, settings)
    J = pin.computeFrameJacobian(
        ROBOT.model, ROBOT.model.createData(), ROBOT.home, ROBOT.frame_id("tool"), pin.LOCAL_WORLD_ALIGNED
    )
    wanted = _gravity(ROBOT.home) - 30.0 * J[2]
    estimate = replace(_estimate(force=30.0), torque=wanted)
    command, _ = controller.step(estimate, _reference(phase="circle", force=30.0), controller.init(estimate))
    np.testing.assert_allclose(command.torque, wanted, atol=5e-2)
    np.testing.assert_allclose(command.diagnostics["mpc/predicted_force"], 30.0, atol=0.5)


def test_it_solves_every_period_and_holds_in_between() -> None:
    controller = MpcController(ROBOT, ForceFeedbackMpc())
    state = controller.init(_estimate())
    torques = []
    for tick in range(6):
        q = ROBOT.home + 1e-3 * tick
        command, state = controller.step(_estimate(1e-3 * tick, q), _reference(1e-3 * tick, 0.01), state)
        torques.append(command.torque)
    for tick in range(5):
        same = bool(np.array_equal(torques[tick], torques[tick + 1]))
        assert same == (tick % 2 == 0)


def test_feedback_between_solves_follows_the_state() -> None:
    held, fed = (MpcController(ROBOT, ForceFeedbackMpc(between=between)) for between in ("hold", "riccati"))
    moved = ROBOT.home + np.array([0.0, 0.002, 0.0, 0.0, 0.0, 0.0])
    answers = []
    for controller in (held, fed):
        _, state = controller.step(_estimate(), _reference(), controller.init(_estimate()))
        answers.append(controller.step(_estimate(1e-3, moved), _reference(1e-3), state)[0].torque)
    fresh = MpcController(ROBOT, ForceFeedbackMpc())
    exact = fresh.step(_estimate(1e-3, moved), _reference(1e-3), fresh.init(_estimate(1e-3, moved)))[0].torque
    before = held.step(_estimate(), _reference(), held.init(_estimate()))[0].torque
    np.testing.assert_array_equal(answers[0], before)
    assert np.linalg.norm(answers[1] - exact) < 0.1 * np.linalg.norm(answers[0] - exact)


def test_torque_feedback_sends_the_filtered_torque() -> None:
    """[FFMPC] eq. 15: τ_0 + ε (τ_1 − τ_0), ε = T_mpc/dt, not the raw w."""
    controller = MpcController(ROBOT, TorqueFeedbackMpc())
    state = controller.init(_estimate())
    command, state = controller.step(_estimate(), _reference(offset=0.02), state)
    xs, us = state.xs, state.us
    tau_0, tau_1 = xs[0, 12:], xs[1, 12:]
    np.testing.assert_allclose(command.torque, tau_0 + 2.0 / 3.0 * (tau_1 - tau_0))
    assert np.linalg.norm(us[0] - tau_0) > 1.2 * np.linalg.norm(command.torque - tau_0)


def test_channels_are_the_same_in_every_command() -> None:
    controller = MpcController(ROBOT, ForceFeedbackMpc())
    state = controller.init(_estimate())
    good, state = controller.step(_estimate(), _reference(), state)
    broken, state = controller.step(replace(_estimate(0.002), q=np.full(6, np.nan)), _reference(0.002), state)
    assert set(good.diagnostics) == set(broken.diagnostics) == set(CHANNELS) == set(controller.channels)
    for name in CHANNELS:
        assert np.shape(good.diagnostics[name]) == np.shape(broken.diagnostics[name])
    assert good.diagnostics["mpc/status"] == STATUS_CODES["converged"]
    assert good.diagnostics["mpc/kkt"] <= 1e-4
    np.testing.assert_allclose(good.diagnostics["mpc/predicted_path"][0], ROBOT.placement(ROBOT.home, "tool")[0])


def test_without_a_solution_it_follows_the_plan_then_holds_with_damping() -> None:
    controller = MpcController(ROBOT, ForceFeedbackMpc())
    estimate = replace(_estimate(), v=np.full(6, 0.1))
    _, state = controller.step(estimate, _reference(offset=0.02), controller.init(estimate))
    plan = state.us
    sources = []
    for tick in range(1, 25):
        blind = replace(_estimate(1e-3 * tick), q=np.full(6, np.nan))
        command, state = controller.step(blind, _reference(1e-3 * tick, 0.02), state)
        assert np.isfinite(command.torque).all()
        sources.append(command.diagnostics["mpc/source"])
        if tick < 15:
            np.testing.assert_allclose(command.torque, plan[tick // 3])
    assert sources[0] == SOURCE_CODES["plan"]  # between two solves
    assert SOURCE_CODES["old plan"] in sources
    assert sources[-1] == SOURCE_CODES["gravity and damping"]
    np.testing.assert_allclose(command.torque, _gravity(ROBOT.home) - 5.0 * 0.1)
    command, state = controller.step(_estimate(0.030), _reference(0.030), state)
    assert command.diagnostics["mpc/source"] == SOURCE_CODES["plan"]


def test_a_plan_has_no_torque_for_a_time_before_it() -> None:
    """Baseline: for a time after its start it has one."""
    controller = MpcController(ROBOT, ForceFeedbackMpc())
    for shift, source in ((0.002, "old plan"), (-0.004, "gravity and damping"), (-0.3, "gravity and damping")):
        _, state = controller.step(_estimate(1.0), _reference(1.0, 0.02), controller.init(_estimate(1.0)))
        blind = replace(_estimate(1.0 + shift), v=np.full(6, np.nan))
        command, _ = controller.step(blind, _reference(1.0 + shift, 0.02), state)
        assert command.diagnostics["mpc/source"] == SOURCE_CODES[source]


@pytest.mark.parametrize("what", ["q", "v", "torque", "wrenches"])
@pytest.mark.parametrize("settings", THREE, ids=lambda c: c.kind)
@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
def test_no_nan_leaves_it(settings: MpcConfig, what: str, bad: float) -> None:
    controller = MpcController(ROBOT, settings)
    state = controller.init(_estimate())
    values = {"tool": np.full(6, bad)} if what == "wrenches" else np.full(6, bad)
    for tick in range(20):
        estimate = _estimate(1e-3 * tick)
        estimate = replace(estimate, **{what: values}) if tick >= 3 else estimate
        command, state = controller.step(estimate, _reference(1e-3 * tick, 0.01), state)
        assert np.isfinite(command.torque).all()
        assert np.all(np.abs(command.torque) <= ROBOT.torque_limit)
        assert np.isfinite(command.clamped).all()


def test_what_the_limits_take_is_visible() -> None:
    weak = polishing_arm()
    weak.model.upperEffortLimit = np.full(6, 20.0)
    controller = MpcController(weak, ForceFeedbackMpc())
    command, _ = controller.step(_estimate(), _reference(), controller.init(_estimate()))
    assert np.max(np.abs(command.torque)) == 20.0
    np.testing.assert_allclose(command.torque + command.clamped, _gravity(ROBOT.home), atol=1e-3)


def test_missing_signals_are_named() -> None:
    controller = MpcController(ROBOT, ForceFeedbackMpc())
    with pytest.raises(SignalError, match="contact wrench of frame 'tool'"):
        controller.init(replace(_estimate(), wrenches={}))
    with pytest.raises(PliantError, match="6 entries"):
        controller.init(replace(_estimate(), q=np.zeros(7)))
    state = controller.init(_estimate())
    with pytest.raises(ConfigError, match="no costs for phase 'polish'"):
        controller.step(_estimate(), _reference(phase="polish"), state)


def test_a_reference_without_phases_follows_the_contact_that_is_felt() -> None:
    controller = MpcController(ROBOT, ForceFeedbackMpc())
    state = controller.init(_estimate())
    free, state = controller.step(_estimate(), _reference(phase=""), state)
    touching, state = controller.step(_estimate(0.002, force=5.0), _reference(0.002, phase=""), state)
    assert free.diagnostics["mpc/contact_nodes"] == 0
    assert touching.diagnostics["mpc/contact_nodes"] == 6


def test_a_task_without_orientation_leaves_it_free() -> None:
    """Baseline: with the orientation the same start costs a turning torque."""
    start = ROBOT.home + np.array([0.0, 0.0, 0.0, 0.0, 0.3, 0.0])
    position, R = ROBOT.placement(start, "tool")
    home_R = ROBOT.placement(ROBOT.home, "tool")[1]
    torques = {}
    for name, rotation in {"free": None, "met": R, "wanted": home_R}.items():
        controller = MpcController(ROBOT, ForceFeedbackMpc(posture="start"))
        reference = Reference(0.0, (TaskReference("tool", position, rotation),), phase="track")
        torques[name] = controller.step(_estimate(q=start), reference, controller.init(_estimate(q=start)))[0].torque
    np.testing.assert_allclose(torques["free"], torques["met"], atol=1e-3)
    assert np.max(np.abs(torques["wanted"] - torques["met"])) > 0.1


def test_torque_bounds_are_planned_with_instead_of_clamped() -> None:
    """Baseline: without bounds the same wish is cut off by the clamp."""
    weak = polishing_arm()
    limit = np.abs(_gravity(ROBOT.home)) + 5.0
    weak.model.upperEffortLimit = limit
    taken = {}
    for bounded in (False, True):
        controller = MpcController(weak, ForceFeedbackMpc.model_validate({"bounds": {"torque": bounded}}))
        command, state = controller.step(_estimate(), _reference(offset=0.2), controller.init(_estimate()))
        taken[bounded] = float(np.max(np.abs(command.clamped)))
        assert np.all(np.abs(command.torque) <= limit)
        if bounded:
            assert np.max(np.abs(state.us) - limit) < 1e-3
    assert taken[True] < 1e-3
    assert taken[False] > 1.0
