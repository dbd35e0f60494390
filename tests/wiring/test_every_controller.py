"""Any controller runs any task: every name on a case of each study, and what it is told there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pliant import loop
from pliant.configuration import merged
from pliant.controllers.step_limit import DEFAULT_SHARE
from pliant.entries import Believed
from pliant.experiments.base import Experiment
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_case
from pliant.robot import Robot
from pliant.signals import Tick
from pliant.wiring.registry import controllers, find_controller

TICKS = 100
CASES = (("stack", "figure8-hardware"), ("haptic", "floor"), ("polishing", "tables-2-3-4-delayed"))


def wired(study: str, case: str, controller: str, **changes: Any) -> Experiment:
    found = get_study(study)
    return found.build(merged(found.case(case), {"controller": controller, "duration": 0.5, **changes}))


@pytest.mark.parametrize("name", list(controllers()))
@pytest.mark.parametrize(("study", "case"), CASES)
def test_every_controller_runs_a_case_of_every_study(study: str, case: str, name: str) -> None:
    made = wired(study, case, name)
    seen: list[Tick] = []
    outcome = loop.run(
        made.plant, made.estimator, made.source, made.controller, range(TICKS), [seen.append], made.robot
    )
    assert outcome.failure is None
    torques = np.array([tick.command.torque for tick in seen])
    assert np.isfinite(torques).all()
    assert np.all(np.abs(torques) <= made.robot.torque_limit + 1e-9)
    assert np.any(torques)  # it does something
    exceeded = np.array([tick.command.diagnostics["step_limit/exceeded"] for tick in seen[1:]])
    steps = np.abs(np.diff(torques, axis=0)) / made.robot.torque_limit
    assert np.all(steps.max(axis=1) <= DEFAULT_SHARE * (1.0 + exceeded) + 1e-9)
    assert exceeded.any() <= ("stack" in name)  # only an account that cannot pay may go further
    entry = controllers()[name]
    said = any("does not regulate a force" in text for text in made.warnings)
    assert said == (study != "stack" and not entry.regulates_force)
    units = {channel.name for channel in made.channels}
    assert set(seen[-1].command.diagnostics) <= units  # every channel has its unit


@pytest.mark.parametrize(("study", "case"), [("polishing", "tables-2-3-4-delayed"), ("stack", "figure8-plain")])
def test_a_preview_in_between_two_solves_would_change_nothing(study: str, case: str) -> None:
    """Torques bit for bit; baseline: without any preview they differ."""
    torques: list[np.ndarray] = []
    for every in (None, 0.0, np.inf):
        made = wired(study, case, "offset-free-mpc")
        lookahead = made.controller.needs.preview
        assert lookahead is not None
        assert lookahead.every > made.plant.period
        source = next(part for part in _within(made.source) if hasattr(part, "lookahead"))
        source.lookahead = replace(lookahead, every=lookahead.every if every is None else every)
        seen: list[Tick] = []
        loop.run(made.plant, made.estimator, made.source, made.controller, range(120), [seen.append], made.robot)
        torques.append(np.array([tick.command.torque for tick in seen]))
    np.testing.assert_array_equal(torques[0], torques[1])
    assert np.abs(torques[0] - torques[2]).max() > 1e-6


def _within(part: Any) -> Iterator[Any]:
    while part is not None:
        yield part
        part = getattr(part, "inner", None)


@pytest.mark.parametrize("name", list(controllers()))
def test_a_controller_is_told_what_it_needs(name: str) -> None:
    """On the study that is furthest from its own, from the first tick on."""
    study, case = ("stack", "figure8-hardware") if "mpc" in name or "haptic" in name else CASES[2]
    made = wired(study, case, name)
    seen: list[Tick] = []
    loop.run(made.plant, made.estimator, made.source, made.controller, range(3), [seen.append], made.robot)
    entry, tick = controllers()[name], seen[-1]
    needs, filtered = made.controller.needs, entry.needs(entry.default)
    if needs.preview is not None:
        assert tick.reference.preview is not None
        first = tick.reference.time + needs.preview.lead
        wanted = first + needs.preview.step * np.arange(needs.preview.nodes + 1)
        assert tick.reference.preview.time == pytest.approx(wanted)
    if needs.wrench or filtered.wrench:
        assert tick.reference.tasks[0].frame in tick.estimate.wrenches
    if needs.disturbance != "none":
        assert tick.estimate.disturbance is not None
    if needs.posture:
        assert tick.reference.posture is not None


@pytest.mark.study
@pytest.mark.parametrize(
    ("controller", "holds"), [("haptic", True), ("force-feedback-mpc", True), ("stack", False), ("haptic-hold", False)]
)
def test_who_regulates_a_force_holds_it_and_who_does_not_does_not(controller: str, holds: bool) -> None:
    """40 N with the leg on a rigid floor: predictive control was made for another study."""
    study = get_study("haptic")
    result = run_case(study, merged(study.case("floor"), {"controller": controller, "duration": 1.4}))
    assert result.failure is None
    error = next(metric.value for metric in result.metrics if metric.name == "hold, rms")
    assert (error < 1.0) == holds
    assert (error < 5.0) == holds  # baselines are far off, not just beside


def test_parameters_of_another_controller_are_refused_with_the_valid_ones() -> None:
    study = get_study("haptic")
    config = merged(study.case("floor"), {"controller": "offset-free-mpc", "control": {"horizn": 3}})
    with pytest.raises(Exception, match=r"unknown key 'horizn'.*did you mean 'horizon'"):
        study.build(config)


@pytest.mark.parametrize(("delay", "gain"), [(0.0, 45.0), (6e-3, 0.18 / 7e-3)])
def test_a_late_loop_regulates_force_more_slowly(delay: float, gain: float) -> None:
    """At 45 /s and 7 ms the loop oscillates and loses contact."""
    entry, robot = find_controller("haptic"), Robot.load("leg3")
    believed = Believed(frames=("foot",), period=1e-3, presses="foot", computation_delay=delay)
    assert entry.suggest(robot, entry.default, believed).exploration.gain == pytest.approx(gain)
