"""The preview of a list of targets: what it says of a later time is what is then said."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.errors import ConfigError
from pliant.interfaces import Lookahead
from pliant.references.placed_phases import Ending, PhaseChange, PlacedPhase, PlacedPhases
from pliant.references.planners.harmonic_planner import HarmonicPlanner, PlannerLimits
from pliant.references.planners.superposition import MotionLimits
from pliant.references.schedule import LatestReference
from pliant.robot import Robot
from pliant.signals import Estimate, Reference, TaskReference
from pliant.spatial import exp3

ROBOT = Robot.load("panda")
HERE, TURNED = ROBOT.placement(ROBOT.home, "flange")
LIMITS = PlannerLimits(MotionLimits(0.4, 4.0), MotionLimits(2.0, 20.0))
H = 4e-3


def all_placed(rng: np.random.Generator, oriented: bool) -> list[PlacedPhase]:
    """Targets that follow one another before the last one is reached, too."""
    found: list[PlacedPhase] = []
    for number in range(4):
        rotation = TURNED @ exp3(rng.uniform(-0.4, 0.4, 3)) if oriented else None
        wrench = np.concatenate([rng.uniform(-9.0, 9.0, 3), np.zeros(3)])
        task = TaskReference("flange", HERE + rng.uniform(-0.1, 0.1, 3), rotation, wrench=wrench)
        ending = Ending(H * round(rng.uniform(0.05, 0.5) / H))
        found.append(PlacedPhase(f"placed {number}", task, (ending, Ending(contact=True))))
    return found


def played(source: HarmonicPlanner, seconds: float) -> list[Reference]:
    zero, found, state = np.zeros(ROBOT.n), list[Reference](), None
    for tick in range(round(seconds / H)):
        estimate = Estimate(3.0 + tick * H, ROBOT.home, zero, zero, zero)
        state = source.init(estimate) if state is None else state
        reference, state = source.step(estimate, state)
        found.append(reference)
    return found


def planner(seed: int, lookahead: Lookahead | None) -> HarmonicPlanner:
    rng = np.random.default_rng(seed)
    changes = [
        PhaseChange(H * round(rng.uniform(0.0, 1.0) / H), target=HERE + rng.uniform(-0.1, 0.1, 3)) for _ in range(2)
    ]
    inner = PlacedPhases(ROBOT, all_placed(rng, bool(seed % 2)), changes=changes)
    return HarmonicPlanner(inner, ROBOT.placement, LIMITS, lookahead=lookahead)


@pytest.mark.parametrize("seed", range(4))
def test_a_preview_says_what_is_said_later(seed: int) -> None:
    """To rounding, through ends of phases, changes, and targets that come before the last one is reached."""
    nodes, every = 12, 4
    ahead = Lookahead(nodes, every * H, 3 * H)
    found = played(planner(seed, ahead), 1.6)
    ignorant = straight = 0.0
    for tick in range(0, len(found) - (nodes * every + 3), 11):
        preview = found[tick].preview
        assert preview is not None
        assert (preview.rotation is None) == (seed % 2 == 0)
        for node in range(0, nodes + 1, 4):
            later = found[tick + 3 + node * every]
            task = later.tasks[0]
            assert preview.time[node] == pytest.approx(later.time, abs=1e-9)
            np.testing.assert_allclose(preview.position[node], task.position, atol=1e-7)
            np.testing.assert_allclose(preview.velocity[node], task.velocity, atol=1e-5)
            np.testing.assert_array_equal(preview.wrench[node], task.wrench)
            assert preview.phase[node] == later.phase
            if preview.rotation is not None:
                np.testing.assert_allclose(preview.rotation[node], task.rotation, atol=1e-7)
            now = found[tick].tasks[0]
            guess = now.position + (later.time - found[tick].time) * now.velocity[:3]
            ignorant = max(ignorant, float(np.abs(guess - task.position).max()))
            straight = max(straight, float(np.abs(now.wrench - task.wrench).max()))
    assert ignorant > 1e-2  # going on as now does not foresee that
    assert straight > 1.0


def test_a_preview_changes_nothing_of_what_is_said() -> None:
    with_one, without = (played(planner(1, ahead), 1.2) for ahead in (Lookahead(10, 0.02), None))
    for one, other in zip(with_one, without, strict=True):
        np.testing.assert_array_equal(one.tasks[0].position, other.tasks[0].position)
        np.testing.assert_array_equal(one.tasks[0].velocity, other.tasks[0].velocity)


def test_a_preview_is_made_where_one_is_due_and_is_then_that_of_each_tick() -> None:
    always, rarely = (played(planner(1, Lookahead(10, 0.02, H, every)), 1.2) for every in (0.0, 3 * H))
    made = [tick for tick, reference in enumerate(rarely) if reference.preview is not None]
    assert made == list(range(0, len(rarely), 3))
    for tick, reference in enumerate(always):
        assert reference.preview is not None  # control
        if tick in made:
            ours = rarely[tick].preview
            assert ours is not None
            np.testing.assert_array_equal(ours.position, reference.preview.position)
            np.testing.assert_array_equal(ours.velocity, reference.preview.velocity)


def test_a_phase_that_only_contact_ends_goes_on_and_a_failure_is_not_foreseen() -> None:
    first = TaskReference("flange", HERE)
    last = PlacedPhase("last", TaskReference("flange", HERE + 0.1), (Ending(1.0),))
    for endings in ((Ending(contact=True),), (Ending(contact=True), Ending(0.1, fails=True))):
        source = PlacedPhases(ROBOT, [PlacedPhase("first", first, endings), last])
        zero = np.zeros(ROBOT.n)
        state = source.init(Estimate(0.0, ROBOT.home, zero, zero, zero))
        assert source.coming(state, 100.0) == []


def test_a_preview_needs_a_source_that_knows_what_is_coming() -> None:
    box = LatestReference(Reference(0.0, (TaskReference("flange", HERE),)))
    with pytest.raises(ConfigError, match="next references are known, and those of LatestReference are not"):
        HarmonicPlanner(box, ROBOT.placement, lookahead=Lookahead(3, 0.01))
