"""The polishing task in reduced form: shorter runs of the same loop."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from pliant import loop
from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.runner import run_case
from pliant.signals import Tick
from pliant.simulation import MujocoPlant
from pliant.simulation.imperfections.config import Imperfections
from pliant.studies.polishing import STUDY
from pliant.studies.polishing.config import PolishingConfig
from pliant.telemetry.summary import Metric

pytestmark = pytest.mark.study
THREE = ("force-feedback-mpc", "torque-feedback-mpc", "classical-mpc")


def _config(**changes: object) -> PolishingConfig:
    return merged(STUDY.case("ideal"), {"duration": 4.5, **changes})


@cache
def _ideal(controller: str, friction: float = 0.25, step: float = 5e-4, found: bool = False) -> dict[str, Metric]:
    config = _config(controller=controller, table={"friction": friction}, physics_step=step, task={"found": found})
    result = run_case(STUDY, config)
    assert result.failure is None
    return {metric.name: metric for metric in result.metrics}


def test_force_feedback_presses_and_draws() -> None:
    found = _ideal("force-feedback-mpc")
    assert found["E_λ"].value <= 0.5
    assert found["E_P"].value <= 1.0
    assert found["t_break"].value == 0.0
    assert found["first contact peak"].value <= 15.0
    assert found["KKT reached"].value >= 99.9


@pytest.mark.parametrize("controller", ["classical-mpc", "torque-feedback-mpc"])
def test_the_others_run_it_too_and_lose_to_unmodelled_friction(controller: str) -> None:
    """Without table friction their rigid contact is exact; with it only measured force helps ([FFMPC] sec. VI-C)."""
    assert _ideal(controller)["t_break"].value == 0.0
    assert _ideal(controller)["KKT reached"].value >= 99.9
    assert _ideal(controller)["E_λ"].value > 4.0 * _ideal("force-feedback-mpc")["E_λ"].value
    assert _ideal(controller, friction=0.0)["E_λ"].value < 0.2


def test_contact_is_found_without_a_timetable() -> None:
    found, scheduled = _ideal("force-feedback-mpc", found=True), _ideal("force-feedback-mpc")
    assert found["E_λ"].value <= 0.5
    assert found["E_λ"].value == pytest.approx(scheduled["E_λ"].value, rel=0.2)


def test_one_iteration_per_solve_tracks_as_well_as_eight() -> None:
    result = run_case(STUDY, _config(control={"max_iterations": 1}))
    found = {metric.name: metric.value for metric in result.metrics}
    assert found["E_λ"] == pytest.approx(_ideal("force-feedback-mpc")["E_λ"].value, rel=0.05)
    assert found["iterations"] <= 1.0


def test_half_the_physics_step_changes_little() -> None:
    coarse, fine = (_ideal("force-feedback-mpc", step=step) for step in (5e-4, 2.5e-4))
    for name in ("E_λ", "E_P"):
        assert fine[name].value == pytest.approx(coarse[name].value, rel=0.02)


@pytest.mark.parametrize("controller", THREE)
def test_the_residual_is_reached_in_a_noisy_loop(controller: str) -> None:
    """Noise of [FFMPC] on every sensor, imperfect actuation, 8 iterations: KKT 1e-4 in 99.9 % of the solves."""
    imperfections = Imperfections.p3(computation_delay=0.0).model_dump()
    experiment = STUDY.build(_config(controller=controller, preset="paper", imperfections=imperfections, seed=3))
    residuals: list[float] = []
    torques: list[float] = []

    def watch(tick: Tick) -> None:
        residuals.append(float(tick.command.diagnostics["mpc/kkt"]))
        torques.append(float(np.max(np.abs(tick.command.torque) / experiment.robot.torque_limit)))

    outcome = loop.run(
        experiment.plant,
        experiment.estimator,
        experiment.source,
        experiment.controller,
        range(3500),
        [watch],
    )
    assert outcome.failure is None
    assert np.mean(np.array(residuals[::2]) <= 1e-4) >= 0.999
    assert max(torques) <= 1.0


def test_the_same_run_twice_is_the_same() -> None:
    torques: list[list[np.ndarray]] = []
    for _ in range(2):
        experiment = STUDY.build(_config())
        seen: list[np.ndarray] = []
        loop.run(
            experiment.plant,
            experiment.estimator,
            experiment.source,
            experiment.controller,
            range(1300),
            [lambda tick, seen=seen: seen.append(tick.command.torque)],
        )
        torques.append(seen)
    np.testing.assert_array_equal(torques[0], torques[1])


def test_wrong_times_and_controllers_are_refused() -> None:
    with pytest.raises(ConfigError, match="reach, touch, pressed, circle and stop must increase"):
        STUDY.build(_config(task={"reach": 1.0, "touch": 0.5}))
    with pytest.raises(ConfigError, match="did you mean 'classical-mpc'"):
        STUDY.build(_config(controller="clasical-mpc"))
    with pytest.raises(ConfigError, match="unknown key"):
        STUDY.build(_config(control={"contact": {"stifness": [1e3]}}))


def test_every_channel_has_a_unit() -> None:
    experiment = STUDY.build(_config())
    names = {channel.name for channel in experiment.channels}
    estimate, _ = experiment.estimator.step(
        (measurement := experiment.plant.init()[0]), experiment.estimator.init(measurement)
    )
    reference, _ = experiment.source.step(estimate, experiment.source.init(estimate))
    command, _ = experiment.controller.step(estimate, reference, experiment.controller.init(estimate))
    assert set(command.diagnostics) == names
    assert all(channel.unit for channel in experiment.channels)


def test_what_nobody_knows_of_the_tool_is_added_to_it() -> None:
    made = STUDY.build(_config(unknown_mass=0.5))
    assert isinstance(made.plant, MujocoPlant)
    known, heavier = made.robot, made.plant.robot
    masses = [sum(inertia.mass for inertia in robot.model.inertias) for robot in (known, heavier)]
    assert masses[1] - masses[0] == pytest.approx(0.5)


def test_times_that_do_not_increase_are_refused() -> None:
    with pytest.raises(ConfigError, match="reach, touch, pressed, circle and stop must increase"):
        STUDY.build(_config(task={"reach": 1.0, "touch": 1.0}))


def test_the_grid_of_contact_models_is_whole() -> None:
    """Those whose damping is below 3 ms times the stiffness; of the grid that is tried, none is."""
    assert len(STUDY.runs("stiffness", 1)) == 16 * 4
