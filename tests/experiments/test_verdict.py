"""Runs that reached their end and are failures all the same, in whatever study."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_case
from pliant.experiments.verdict import StartNotes, physical_verdict
from pliant.robot import Robot
from pliant.signals import Command, Estimate, Measurement, Reference, TaskReference, Tick, Truth
from pliant.telemetry.recorder import Recorder


def tick(k: int, excess: np.ndarray, asked: float, felt: float, believed: bool = False) -> Tick:
    zero, wrench = np.zeros(7), np.zeros(6)
    pressing = np.array([0.0, 0.0, asked, 0.0, 0.0, 0.0])
    truth_wrench = np.array([0.0, 0.0, felt, 0.0, 0.0, 0.0])
    t = 1e-2 * k
    truth = Truth(t, zero, zero, zero, wrenches={"flange": truth_wrench}, limit_excess=excess)
    estimate = Estimate(t, zero, zero, zero, zero, {"flange": wrench + 2.0}, {"flange": believed})
    task = TaskReference("flange", np.zeros(3), wrench=pressing)
    return Tick(Measurement(t, zero, zero, zero, zero), estimate, Reference(t, (task,)), Command(t, zero, zero), truth)


def verdict(robot: Robot, ticks: list[Tick]) -> str | None:
    with Recorder(None) as recorder:
        for one in ticks:
            recorder(one)
    return physical_verdict(recorder.log(), robot)


def test_a_joint_beyond_its_limit_is_named_with_size_and_time(iiwa14: Robot) -> None:
    rest, beyond = np.zeros(7), np.zeros(7)
    beyond[6] = np.deg2rad(3.2)
    found = verdict(iiwa14, [tick(k, beyond if 12 <= k < 20 else rest, 0.0, 0.0) for k in range(30)])
    assert found is not None
    assert found.startswith("joint limit passed: A7 by 3.2°, first at t = 0.12 s (more than 1°")
    within = np.full(7, np.deg2rad(0.9))
    assert verdict(iiwa14, [tick(k, within, 0.0, 0.0) for k in range(30)]) is None


@pytest.mark.parametrize(("asked", "felt", "fails"), [(20.0, 0.0, True), (20.0, 3.0, False), (0.0, 0.0, False)])
def test_a_force_was_asked_for_and_nothing_touched(iiwa14: Robot, asked: float, felt: float, fails: bool) -> None:
    ticks = [tick(k, np.zeros(7), asked, felt if k == 10 else 0.0) for k in range(20)]
    found = verdict(iiwa14, ticks)
    assert found == ("no contact: frame flange should press with 20 N and the robot touched nothing" if fails else None)


def test_contact_in_free_air_at_the_start_is_a_note_and_a_real_one_is_not() -> None:
    rest = np.zeros(7)
    for felt, believed, count in ((0.0, True, 1), (5.0, True, 0), (0.0, False, 0)):
        notes = StartNotes()
        notes(tick(0, rest, 0.0, felt, believed))
        notes(tick(1, rest, 0.0, 0.0, True))  # later it is a contact like any other
        assert len(notes.sentences or ()) == count


def test_a_log_without_truth_says_nothing(iiwa14: Robot) -> None:
    with Recorder(None) as recorder:
        one = tick(0, np.zeros(7), 20.0, 0.0)
        recorder(Tick(one.measurement, one.estimate, one.reference, one.command, None))
    assert physical_verdict(recorder.log(), iiwa14) is None


def test_a_study_takes_the_verdict_and_keeps_the_numbers() -> None:
    """Any study's run goes through it: a leg that has no time to reach the floor has touched nothing."""
    study = get_study("haptic")
    config = study.case("floor")
    short = config.model_copy(
        update={"duration": 0.05, "steps": (config.steps[0].model_copy(update={"force": (0, 0, 20)}),)}
    )
    result = run_case(study, short)
    assert result.failure is not None
    assert result.failure.startswith("no contact: frame foot should press with 20 N")
    assert result.metrics
