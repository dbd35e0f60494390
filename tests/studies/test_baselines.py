"""Baselines get what the stack gets: a search of their own, a damper for the spring, a model that may be wrong."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from pliant.configuration import merged
from pliant.controllers.registry import CONTROLLERS
from pliant.errors import ConfigError
from pliant.experiments.model_error import with_mass_error
from pliant.experiments.registry import get_study
from pliant.robot import Robot
from pliant.signals import Estimate, Reference, TaskReference
from pliant.wiring.registry import controllers

STACK = get_study("stack")


def test_every_compared_controller_has_a_search_on_the_plant_of_the_case() -> None:
    for case in ("figure8-gazebo", "figure8-hardware"):
        for controller in ("stack", "spring", "operational-space"):
            tuning = STACK.search(controller, case)
            (run,) = tuning.runs
            assert (run.case, run.controller) == (case, controller)
            merged(run, tuning.changes(tuning.start))  # possible
    with pytest.raises(ConfigError, match="has no search"):
        STACK.search("stack-paper")
    with pytest.raises(ConfigError, match="no case"):
        STACK.search("stack", "figure9")


def test_a_search_of_polishing_has_the_delay_of_its_case() -> None:
    polishing = get_study("polishing")
    for case, delay in (("tables-2-3-4", 0.0), ("tables-2-3-4-delayed", 5e-3)):
        runs = polishing.search("torque-feedback-mpc", case).runs
        assert {run.imperfections.computation_delay for run in runs} == {delay}


def test_links_are_off_by_their_own_share_and_the_true_robot_is_left_alone() -> None:
    robot = Robot.load("lwr4")
    before = [inertia.mass for inertia in robot.model.inertias]
    wrong = with_mass_error(robot, 0.2, np.random.default_rng(3))
    factors = np.array(
        [a.mass / b.mass for a, b in zip(list(wrong.model.inertias)[1:], list(robot.model.inertias)[1:], strict=True)]
    )
    assert [inertia.mass for inertia in robot.model.inertias] == before
    assert np.all((factors >= 0.8) & (factors <= 1.2))
    assert np.ptp(factors) > 0.05
    assert wrong.model.inertias[2].inertia == pytest.approx(factors[1] * robot.model.inertias[2].inertia)
    gravity = [pin.computeGeneralizedGravity(r.model, r.model.createData(), r.home) for r in (robot, wrong)]
    assert np.max(np.abs(gravity[0] - gravity[1])) > 0.5
    assert with_mass_error(robot, 0.0, np.random.default_rng(3)) is robot
    with pytest.raises(ConfigError, match="below 1"):
        with_mass_error(robot, 1.0, np.random.default_rng(3))


def test_a_damped_spring_brakes_and_an_undamped_one_does_not() -> None:
    robot = Robot.load("lwr4")
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.home)
    v = np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6, 0.7])
    entry = CONTROLLERS["spring"]
    torques = []
    for damping in (0.0, 3.0):
        spring = entry.build(robot, merged(entry.default, {"joint_damping": damping}), 1e-3)
        poses = [(task.frame, data.oMf[robot.frame_id(task.frame)].copy()) for task in spring.tasks]
        reference = Reference(0.0, tuple(TaskReference(f, pose.translation, pose.rotation) for f, pose in poses))
        estimate = Estimate(0.0, robot.home, v, np.zeros(7), np.zeros(7))
        command, _ = spring.step(estimate, reference, spring.init(estimate))
        torques.append(command.torque)
    assert torques[0] == pytest.approx(np.zeros(7), abs=1e-9)
    assert torques[1] == pytest.approx(-3.0 * v, abs=1e-9)


MODELLED = {"mpc", "operational-space"}
"""families that compute with the robot's masses"""


@pytest.mark.parametrize("name", ["stack", "polishing"])
def test_every_compared_controller_with_a_model_has_rows_with_wrong_masses(name: str) -> None:
    study = get_study(name)
    runs = [run for case in study.cases for run in study.runs(case, 1)]
    wrong = {run.controller for run in runs if run.model_mass_error == 0.2}
    assert wrong == {run.controller for run in runs if controllers()[run.controller].family in MODELLED}
