"""Parameters changed while it runs: the force bound holds at every tick, and the ledger stays balanced."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from pliant.controllers import FrameTask, Law, Stack
from pliant.controllers.energy_ledger import TOTALS
from pliant.robot import Robot
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference
from pliant.spatial import Array, exp3

PERIOD = 1e-3


def random_tuning(rng: np.random.Generator, axes: int) -> ImpedanceTuning:
    """Any valid parameters that a period of 1 ms allows, incompatible ones clipped as a user interface would."""
    scale = np.array([15000.0] * 3 + [300.0] * 3)[:axes]
    stiffness = scale * 10.0 ** rng.uniform(-2.0, 0.0, axes)
    reach = np.array([0.05] * 3 + [0.6] * 3)[:axes] * rng.uniform(0.2, 1.0, axes)
    force_max = np.array([150.0] * 3 + [100.0] * 3)[:axes] * rng.uniform(0.1, 1.0, axes)
    return ImpedanceTuning(stiffness, force_max, reach)


def targets(robot: Robot, t: float, tunings: tuple[ImpedanceTuning, ImpedanceTuning]) -> Reference:
    position, rotation = robot.placement(robot.home, "flange")
    elbow, _ = robot.placement(robot.home, "elbow")
    moved = position + np.array([0.08 * np.sin(3 * t), 0.05 * np.sin(2 * t), 0.05 * np.sin(5 * t)])
    turned = exp3([0.2 * np.sin(2 * t), 0.0, 0.3 * np.sin(3 * t)]) @ rotation
    ee = TaskReference("flange", moved, turned, tuning=tunings[0])
    return Reference(t, (ee, TaskReference("elbow", elbow, tuning=tunings[1])))


def simulate(
    robot: Robot, law: Law, change_every: int, seconds: float, seed: int, period: float = PERIOD
) -> list[dict[str, Array]]:
    """Undamped arm without gravity in pinocchio, four substeps per period."""
    rng = np.random.default_rng(seed)
    tunings = (random_tuning(rng, 6), random_tuning(rng, 3))
    stack = Stack(robot, [FrameTask("flange", tunings[0], "ee"), FrameTask("elbow", tunings[1])], period, law=law)
    model = robot.model.copy()
    model.gravity.linear = np.zeros(3)
    data = model.createData()
    q, v, zero, state, log = np.array(robot.home), np.zeros(robot.n), np.zeros(robot.n), None, []
    for tick in range(round(seconds / period)):
        if tick % change_every == 0:
            tunings = (random_tuning(rng, 6), random_tuning(rng, 3))
        estimate = Estimate(tick * period, q, v, zero, zero)
        state = stack.init(estimate) if state is None else state
        command, state = stack.step(estimate, targets(robot, tick * period, tunings), state)
        limit = np.concatenate([tunings[0].force_max, tunings[1].force_max])
        row = {name: np.array(value) for name, value in command.diagnostics.items()}
        log.append(row | {"limit": limit, "v": v, "torque": command.torque})
        for _ in range(4):
            v = v + pin.aba(model, data, q, v, command.torque) * period / 4
            q = q + v * period / 4
    return log


def forces(log: list[dict[str, Array]]) -> Array:
    return np.array([np.concatenate([row["ee/force"], row["elbow/force"]]) for row in log])


@pytest.mark.parametrize(("change_every", "seed"), [(250, 0), (20, 1), (1, 2)])
def test_the_force_bound_holds_at_every_tick(lwr4: Robot, change_every: int, seed: int) -> None:
    log = simulate(lwr4, Law.CAPPED, change_every, 3.0, seed)
    limits = np.array([row["limit"] for row in log])
    assert np.all(np.abs(forces(log)) <= limits * (1 + 1e-12))
    assert np.all(np.abs([row["torque"] for row in log]) <= lwr4.torque_limit)
    assert np.abs([row["v"] for row in log]).max() < 15.0  # rad/s, though nothing damps it but the attractor


def test_a_plain_spring_runs_away_under_the_same_changes(lwr4: Robot) -> None:
    """Baseline."""
    log = simulate(lwr4, Law.SPRING, 20, 3.0, 1)
    assert np.abs([row["v"] for row in log[-500:]]).max() > 40.0


def test_the_corrected_stack_law_breaks_the_force_bound(lwr4: Robot) -> None:
    """Baseline."""
    log = simulate(lwr4, Law.STACK_CORRECTED, 20, 1.0, 1)
    limits = np.array([row["limit"] for row in log])
    assert np.any(np.abs(forces(log)) > 1.2 * limits)


def test_the_ledger_balances_and_books_what_tuning_injects(lwr4: Robot) -> None:
    log = simulate(lwr4, Law.CAPPED, 20, 1.0, 5)
    total = {name: np.array([row[f"energy/{name}"] for row in log]) for name in TOTALS}
    gone = total["delivered"] + total["dissipated"] + total["stored"] - total["stored"][0]
    left = total["supplied"] + total["tuning"] - gone
    assert np.abs(left).max() < 1e-9
    assert np.abs(total["tuning"]).max() > 0.1
    margins = np.array([np.concatenate([row["ee/storage_margin"], row["elbow/storage_margin"]]) for row in log])
    assert margins.min() > -0.15  # J, the debt of stiffnesses that rose by more than the accounts held


def test_the_ledger_agrees_with_the_work_in_the_joints(lwr4: Robot) -> None:
    """`delivered` is booked from errors and references; ∫τ·v reached the joints: the same to first order."""
    off = []
    for period in (1e-3, 5e-4):
        log = simulate(lwr4, Law.CAPPED, 10**9, 1.0, 7, period)
        torque, v = np.array([row["torque"] for row in log]), np.array([row["v"] for row in log])
        work = np.cumsum(np.einsum("ij,ij->i", torque[:-1], 0.5 * (v[:-1] + v[1:]))) * period
        booked = np.array([row["energy/delivered"] - row["energy/clamped"] for row in log])[1:]
        assert np.abs(booked).max() > 0.5
        off.append(np.abs(booked - work).max())
    assert off[1] < 0.75 * off[0]
    assert off[0] < 0.2


def test_a_margin_of_a_plain_spring_goes_below_zero(lwr4: Robot) -> None:
    """Baseline: sampling makes an undamped spring create energy, and the ledger shows it."""
    log = simulate(lwr4, Law.SPRING, 10**9, 2.0, 7)
    assert min(float(row["ee/storage_margin"].min()) for row in log) < -0.1
