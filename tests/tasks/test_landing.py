"""Phases that go towards a contact land gently where the file does not say how."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from pliant import run
from pliant.errors import ConfigError
from pliant.experiments.choice import chosen
from pliant.experiments.origins import origins
from pliant.references.placed_phases import Ending, PlacedPhase, PlacedPhases
from pliant.signals import TaskReference
from pliant.studies.task.build_list import build_list, listed
from pliant.studies.task.config import TaskCase, case_of
from pliant.studies.task.landing import Touch, gentle
from pliant.studies.task.study import of_value
from pliant.tasks.task import Task
from tests.references.test_placed_phases import DOWN, HERE, ROBOT, estimate, played
from tests.tasks.tilted import tilted_task

FORCE = 25.0  # N
STEP = 1e-5  # s


def met(touch: Touch, mass: float, late: float, speed: float) -> float:
    """N, largest on a mass that meets a spring and damper: driven at its speed for so long, then left alone."""
    x, v, peak = 0.0, speed, 0.0
    for tick in range(int((late + 2.0 * math.pi * math.sqrt(mass / touch.stiffness)) / STEP)):
        fade = min(x / touch.transition, 1.0) if touch.transition else 1.0
        force = fade * (touch.stiffness * x + touch.damping * v)
        peak = max(peak, force)
        if tick * STEP >= late:
            v -= STEP * force / mass
        x += STEP * v
    return peak


def left_swing(stiffness: float, mass: float, press: float) -> float:
    """Share of the force by which a mass on its spring swings after the force was built up evenly."""
    x, v, swing = 0.0, 0.0, 0.0
    for tick in range(int((press + 2.0 * math.pi * math.sqrt(mass / stiffness)) / STEP)):
        share = min(tick * STEP / press, 1.0)
        v += STEP * (share - stiffness * x) / mass
        x += STEP * v
        swing = max(swing, abs(stiffness * x - 1.0)) if share == 1.0 else 0.0
    return swing


@pytest.mark.parametrize("seed", range(6))
def test_a_mass_that_lands_gently_keeps_to_the_force(seed: int) -> None:
    rng = np.random.default_rng(seed)
    stiffness, mass, late = 10.0 ** rng.uniform(3.0, 5.0), rng.uniform(0.5, 8.0), rng.uniform(0.0, 0.01)
    hard = Touch(stiffness, rng.uniform(0.0, 0.9) * math.sqrt(stiffness * mass))
    speed, _ = gentle(hard, mass, 0.0, FORCE)
    assert met(hard, mass, 0.0, speed) <= 1.01 * FORCE
    spring = Touch(stiffness, 0.0)
    assert met(spring, mass, 0.0, 1.5 * speed) > 1.3 * FORCE  # the control
    driven, _ = gentle(spring, mass, late, FORCE)
    assert met(spring, mass, late, driven) == pytest.approx(FORCE, rel=0.01)


def test_a_damper_that_fades_in_lets_one_land_faster() -> None:
    at_once, fading = Touch(1e3, 1e3), Touch(1e3, 1e3, 1e-3)
    assert gentle(at_once, 0.5, 0.0, FORCE)[0] == FORCE / 1e3
    speed, _ = gentle(fading, 0.5, 0.0, FORCE)
    assert speed > 0.1
    assert met(fading, 0.5, 0.0, speed) == pytest.approx(FORCE, rel=0.1)
    assert met(at_once, 0.5, 0.0, speed) > 4.0 * FORCE  # the control


def test_a_force_built_up_within_a_period_leaves_no_swing() -> None:
    _, press = gentle(Touch(2e4, 100.0), 4.0, 0.0, FORCE)
    assert left_swing(2e4, 4.0, press) < 0.01
    assert left_swing(2e4, 4.0, 0.5 * press) > 0.5  # the control


def built_up(touching: list[bool], press: float = 0.1) -> list[float]:
    """N of the reference, a tenth of `press` apart, of a phase whose force is built up."""
    task = TaskReference("foot", HERE, wrench=DOWN)
    source = PlacedPhases(
        ROBOT, [PlacedPhase("before", TaskReference("foot", HERE), (Ending(0.5),)), _landing(task, press)]
    )
    ticks = [estimate(0.0), *(estimate(0.5 + 0.1 * press * k, touches) for k, touches in enumerate(touching))]
    return [float(reference.tasks[0].wrench[2]) for reference in played(source, *ticks)[1:]]


def _landing(task: TaskReference, press: float) -> PlacedPhase:
    return PlacedPhase("down", task, (Ending(9.0),), press)


def test_a_force_is_built_up_from_the_first_contact_on() -> None:
    forces = built_up([False, False, *[True] * 3, False, *[True] * 9])
    assert forces[:2] == [8.0, 8.0]  # who looks for the surface by the force sees all of it
    np.testing.assert_allclose(forces[3:12], 8.0 * np.arange(1, 10) / 10.0)
    assert forces[2] == pytest.approx(0.02 * 8.0)
    assert forces[12:] == pytest.approx([8.0] * 3)
    assert built_up([True] * 5) == [8.0] * 5  # what begins in contact has landed
    assert built_up([False, True, True], press=0.0) == [8.0] * 3


def presses(controller: str, **more: Any) -> Task:
    """25 N on a plane 50 mm below the tool, at 5 ms."""
    task = tilted_task(0.0, controller, late=True, gap=0.05)
    down = {**task.phase[0].model_dump(by_alias=True), "wrench": (0.0, 0.0, FORCE)}
    down["until"] = {"any": [{"force": 0.8 * FORCE}, {"timeout": 3.0}]}
    hold = {"name": "hold", "duration": 0.4}
    return Task.model_validate({**task.model_dump(by_alias=True), "planner": {}, "phase": [down, hold], **more})


def highest(task: Task) -> float:
    """N, largest force of a run that did not fail."""
    made = run(task)
    assert made.failure is None, made.failure
    return float(np.linalg.norm(made.log["truth/tool/wrench"][:, :3], axis=1).max())


@pytest.mark.study
def test_operational_space_lands_gently_and_at_the_planners_speed_it_does_not() -> None:
    assert highest(presses("operational-space")) < 1.15 * FORCE
    assert highest(presses("operational-space", landing="off")) > 2.0 * FORCE  # the control


def _case(**more: Any) -> TaskCase:
    return case_of(presses("operational-space", **more), "land")


def test_what_the_file_says_is_not_replaced() -> None:
    landing = listed(_case()).landings["down"]
    assert 0.03 < landing.speed < 0.1
    assert "hold" not in listed(_case()).landings  # it goes nowhere
    assert listed(_case(landing="off")).landings == {}
    nowhere = {**_case().phase[0].model_dump(by_alias=True), "frame": "world", "target": (0.75, 0.05, -0.1)}
    assert listed(_case(scene={}, phase=[nowhere])).landings == {}  # nothing to land on
    slower = listed(_case(scene={"plane": {"shape": "plane", "stiffness": 2e5}})).landings["down"]
    assert slower.speed < 0.5 * landing.speed
    said = {**_case().phase[0].model_dump(by_alias=True), "limit": {"speed": 0.15}, "press": 0.0}
    source: Any = build_list(_case(phase=[said])).source
    placed = source.inner.phases[0]
    assert (placed.task.modes.speed, placed.press) == (0.15, 0.0)


def test_it_is_said_what_lands_gently() -> None:
    task = presses("operational-space")
    study = of_value(task, "land")
    told = study.about(study.case("land"))["landing"]
    assert "phase 'down' goes at most" in told
    assert "kg that meet 'plane' (2e+04 N/m) are to press with 25 N at most" in told
    choice = chosen(task, None, {}, {})
    rows = {row.key: row for row in origins(choice, None)}
    assert rows["phase.down.limit.speed"].origin == "suggested"
    assert rows["phase.down.press"].unit == "s"
    hurried = {**task.phase[0].model_dump(by_alias=True), "until": None, "duration": 0.5}
    (text,) = build_list(_case(phase=[hurried])).warnings
    assert "phase 'down' may last 0.5 s, and takes" in text
    with pytest.raises(ConfigError, match="landing belongs to a task of"):
        chosen("wipe", None, {}, {"landing": "off"})
