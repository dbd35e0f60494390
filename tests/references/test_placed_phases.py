"""PlacedPhases one after the other: when each ends, what a change does, and until when."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pliant.errors import ConfigError, RunFailedError
from pliant.references.exploration.config import ExplorationConfig
from pliant.references.placed_phases import Ending, PhaseChange, PlacedPhase, PlacedPhases
from pliant.robot import Robot
from pliant.signals import Estimate, ImpedanceTuning, Reference, TaskReference

ROBOT = Robot.load("leg3")
HERE = ROBOT.placement(ROBOT.home, "foot")[0]
TUNING = ImpedanceTuning(np.full(3, 6000.0), np.full(3, 150.0), np.full(3, 0.025))
DOWN = np.array([0.0, 0.0, 8.0, 0.0, 0.0, 0.0])


def estimate(time: float, contact: bool = False, force: float = 0.0, q: Any = ROBOT.home) -> Estimate:
    zero = np.zeros(3)
    wrench = {"foot": np.array([5.0, 0.0, force, 0.0, 0.0, 0.0])}
    return Estimate(time, q, zero, zero, zero, wrench, {"foot": contact})


def placed(name: str, *endings: Ending, wrench: Any = DOWN, target: Any = HERE) -> PlacedPhase:
    return PlacedPhase(name, TaskReference("foot", target, wrench=wrench), endings)


def played(source: PlacedPhases, *estimates: Estimate) -> list[Reference]:
    state = source.init(estimates[0])
    found: list[Reference] = []
    for one in estimates:
        reference, state = source.step(one, state)
        found.append(reference)
    return found


def names(source: PlacedPhases, *estimates: Estimate) -> list[str]:
    return [reference.phase for reference in played(source, *estimates)]


LAST = placed("last", Ending(1.0))
LOWER = np.array([0.0, 0.05, 0.0]) + ROBOT.home  # the hip turned: the foot is elsewhere
GONE = float((HERE - ROBOT.placement(LOWER, "foot")[0])[2])


@pytest.mark.parametrize(
    ("ending", "before", "after"),
    [
        (Ending(0.5), estimate(3.499), estimate(3.5)),
        (Ending(contact=True), estimate(3.1, contact=False), estimate(3.2, contact=True)),
        (Ending(contact=False), estimate(3.1, contact=True), estimate(3.2, contact=False)),
        (Ending(force=6.0), estimate(3.1, force=5.9), estimate(3.2, force=6.1)),
        (Ending(0.5, contact=True), estimate(3.4, contact=True), estimate(3.6, contact=True)),
        (Ending(0.5, contact=True), estimate(3.6, contact=False), estimate(3.7, contact=True)),
        (Ending(reached=1e-3), estimate(3.1, q=LOWER), estimate(3.2)),
    ],
)
def test_a_phase_ends_when_all_of_its_condition_holds(ending: Ending, before: Estimate, after: Estimate) -> None:
    source = PlacedPhases(ROBOT, [placed("first", ending), LAST])
    start = estimate(3.0, contact=before.contacts["foot"], q=before.q)  # the loop's clock need not start at zero
    assert names(source, start, before, after) == ["first", "first", "last"]


def test_depth_is_along_the_wrench_from_where_the_phase_began() -> None:
    assert abs(GONE) > 1e-3
    wrench = np.copysign(1.0, GONE) * DOWN  # the foot goes against it
    for share, ends in ((1.01, "first"), (0.99, "last")):
        source = PlacedPhases(ROBOT, [placed("first", Ending(depth=share * abs(GONE)), wrench=wrench), LAST])
        assert names(source, estimate(0.0), estimate(0.1, q=LOWER)) == ["first", ends]
    backwards = PlacedPhases(ROBOT, [placed("first", Ending(depth=1e-6), wrench=-wrench), LAST])
    assert names(backwards, estimate(0.0), estimate(0.1, q=LOWER)) == ["first", "first"]


def test_one_of_several_conditions_is_enough_and_a_timeout_fails_or_goes_on() -> None:
    either = (Ending(force=100.0), Ending(0.2))
    assert names(PlacedPhases(ROBOT, [placed("first", *either), LAST]), estimate(0.0), estimate(0.2)) == [
        "first",
        "last",
    ]
    failing = PlacedPhases(ROBOT, [placed("search", Ending(force=100.0), Ending(0.2, fails=True)), LAST])
    with pytest.raises(RunFailedError, match=r"'search' did not end within 0\.2 s"):
        names(failing, estimate(0.0), estimate(0.2))


def test_the_last_phase_lasts() -> None:
    assert names(PlacedPhases(ROBOT, [LAST]), estimate(0.0), estimate(5.0)) == ["last", "last"]


def test_changes_hold_from_their_time_and_a_target_only_until_the_next_phase() -> None:
    up, whole = HERE + 0.01, ExplorationConfig()
    assert whole.reset
    changes = [
        PhaseChange(0.3, tuning={"force_max": np.full(3, 300.0)}, whole={"reset": False}),
        PhaseChange(0.1, target=up, wrench=2.0 * DOWN),
    ]
    source = PlacedPhases(ROBOT, [placed("first", Ending(0.5)), LAST], TUNING, whole, changes)
    times = (0.0, 0.1, 0.3, 0.5)
    told = played(source, *map(estimate, times))
    assert [reference.tasks[0].wrench[2] for reference in told] == [8.0, 16.0, 16.0, 8.0]
    assert [bool(np.all(reference.tasks[0].position == up)) for reference in told] == [False, True, True, False]
    bounds = [reference.tasks[0].tuning.force_max[0] for reference in told if reference.tasks[0].tuning is not None]
    assert bounds == [150.0, 150.0, 300.0, 300.0]
    assert [reference.tuning.reset for reference in told] == [True, True, False, False]


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(ConfigError, match="needs one at least"):
        PlacedPhases(ROBOT, [])
    with pytest.raises(ConfigError, match=r"'first'.*along its wrench, which is zero"):
        placed("first", Ending(force=3.0), wrench=np.zeros(6))
    with pytest.raises(ConfigError, match="no impedance at frame 'foot'"):
        PlacedPhases(ROBOT, [LAST], changes=[PhaseChange(0.1, tuning={"range": np.full(3, 0.01)})])
    with pytest.raises(ConfigError, match="no parameters"):
        PlacedPhases(ROBOT, [LAST], changes=[PhaseChange(0.1, whole={"reset": False})])
