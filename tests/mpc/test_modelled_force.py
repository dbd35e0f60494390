"""The naive visco-elastic controller: the force of its model, whatever a sensor says."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.base import Result
from pliant.experiments.runner import run_case
from pliant.frozen import changed
from pliant.interfaces import Lookahead
from pliant.mpc.defaults import ClassicalMpc
from pliant.mpc.modelled_force import ModelledForceMpc
from pliant.mpc.registry import CONTROLLERS
from pliant.signals import Estimate, Reference, TaskReference
from pliant.studies.polishing import STUDY
from pliant.studies.polishing.paper_task import FRAME

from .problems import polishing_arm

NAIVE = "visco-elastic-mpc"


def pressing(controller: str, duration: float = 3.0, **changes: object) -> Result:
    config = merged(STUDY.case("ideal"), {"controller": controller, "preset": "tuned", "duration": duration})
    return run_case(STUDY, merged(config, {"task": {"circle": 2.5, "pressed": 2.0}, **changes}))


def force_error(result: Result) -> float:
    assert result.failure is None, result.failure
    return next(metric.value for metric in result.metrics if metric.name == "E_λ")


def test_the_measured_force_changes_nothing() -> None:
    """Torques bit for bit with a sensor that is off by 30 N; force feedback answers to it."""
    for name, same in ((NAIVE, True), ("force-feedback-mpc", False)):
        torques: list[np.ndarray] = []
        for bias in (0.0, 30.0):
            changes = {"controller": name, "task": {"reach": 0.02, "touch": 0.04}}
            made = STUDY.build(merged(STUDY.case("ideal"), changes))
            measurement, world = made.plant.init()
            filtered = made.estimator.init(measurement)
            estimate, filtered = made.estimator.step(measurement, filtered)
            source, state = made.source.init(estimate), made.controller.init(shifted(estimate, bias))
            for _ in range(80):
                reference, source = made.source.step(estimate, source)
                command, state = made.controller.step(shifted(estimate, bias), reference, state)
                measurement, world = made.plant.step(command, world)
                estimate, filtered = made.estimator.step(measurement, filtered)
            torques.append(command.torque)
        assert np.array_equal(*torques) == same, name


def shifted(estimate: Estimate, bias: float) -> Estimate:
    wrench = estimate.wrenches[FRAME] + np.array([0.0, 0.0, bias, 0.0, 0.0, 0.0])
    return changed(estimate, wrenches={**estimate.wrenches, FRAME: wrench})


def test_a_table_lower_than_believed_costs_its_stiffness_times_the_error() -> None:
    """1 mm at 1e4 N/m: 10 N, which the measured force would have told."""
    lower = {"table": {"height_error": 1e-3}}
    assert force_error(pressing(NAIVE)) < 5.0
    assert 7.0 < force_error(pressing(NAIVE, **lower)) < 15.0
    assert force_error(pressing("force-feedback-mpc", **lower)) < 2.0


def test_it_asks_for_no_force_sensor() -> None:
    entry = CONTROLLERS[NAIVE]
    assert not entry.needs(entry.default).wrench
    assert isinstance(entry.needs(entry.default).preview, Lookahead)


def test_another_model_is_refused() -> None:
    from pliant.robot import Robot, Tool

    with pytest.raises(ConfigError, match=r"dimension = 1, got 'classical'"):
        ModelledForceMpc(Robot.load("iiwa14", tool=Tool()), ClassicalMpc())


def test_contact_that_is_felt_says_where_the_surface_is() -> None:
    """The reference is 3 mm below the tool when its phase with contact begins. Felt, the surface is at the tool and
    presses with nothing; else it is at the reference, and its 1e4 N/m pull with 30 N."""
    robot = polishing_arm()
    config = merged(CONTROLLERS[NAIVE].default, {"frame": "tool"})
    controller = ModelledForceMpc(robot, config)
    position, R = robot.placement(robot.home, "tool")
    below = TaskReference("tool", position - 3e-3 * np.eye(3)[2], R)
    for felt, pull in ((True, 0.0), (False, 30.0)):
        zero = np.zeros(robot.n)
        estimate = Estimate(0.0, robot.home, zero, zero, zero, contacts={controller._frame: felt})
        command, _ = controller.step(estimate, Reference(0.0, (below,), phase="press"), controller.init(estimate))
        assert float(command.diagnostics["mpc/modelled_force"]) == pytest.approx(pull, abs=1e-6)
