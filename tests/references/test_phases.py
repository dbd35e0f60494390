"""A task in phases: by timetable, and by contact that is found."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.errors import ConfigError
from pliant.interfaces import Lookahead
from pliant.references.phases import PhasedSource, PhaseState, TaskPhase
from pliant.references.trajectories.shapes import circle
from pliant.references.trajectories.trajectory import Hold
from pliant.references.trajectories.waypoints import Waypoints, wrench_steps
from pliant.robot import Robot
from pliant.signals import Estimate, Reference

ROBOT = Robot.load("iiwa14")
FRAME = "flange"
START = ROBOT.placement(ROBOT.home, FRAME)[0]
BELOW = START - np.array([0.0, 0.0, 0.02])


def _source(found: bool, lookahead: Lookahead | None = None) -> PhasedSource:
    phases = (
        TaskPhase("track", Waypoints([0.0, 0.1], [START, BELOW]), duration=0.1, ends_on_contact=found),
        TaskPhase(
            "ramp", Hold(np.zeros(3)), "touch", wrench_steps([0.0, 0.1], [5.0, 50.0], shape="ramp"), 0.1, touches=True
        ),
        TaskPhase("circle", circle(np.zeros(3), 0.05, 3.0), "touch", wrench_steps([0.0], [50.0]), touches=True),
    )
    return PhasedSource(ROBOT, FRAME, phases, np.eye(3), lookahead)


def _estimate(time: float, touching: bool = False, q: np.ndarray | None = None) -> Estimate:
    zero = np.zeros(7)
    return Estimate(time, ROBOT.home if q is None else q, zero, zero, zero, contacts={FRAME: touching})


def _run(source: PhasedSource, until: float, touch_from: float = np.inf) -> list[Reference]:
    state: PhaseState = source.init(_estimate(0.0))
    found = []
    for tick in range(round(until / 1e-3)):
        reference, state = source.step(_estimate(1e-3 * tick, 1e-3 * tick >= touch_from), state)
        found.append(reference)
    return found


def test_the_timetable_is_kept() -> None:
    phases = [reference.phase for reference in _run(_source(found=False), 0.3)]
    assert phases == ["track"] * 100 + ["ramp"] * 100 + ["circle"] * 100


def test_contact_that_is_found_starts_the_next_phase() -> None:
    references = _run(_source(found=True), 0.4, touch_from=0.15)
    assert [reference.phase for reference in references] == ["track"] * 150 + ["ramp"] * 100 + ["circle"] * 150
    assert references[150].tasks[0].wrench[2] == pytest.approx(5.0)
    assert references[200].tasks[0].wrench[2] == pytest.approx(27.5)
    never = _run(_source(found=True), 0.4)
    assert {reference.phase for reference in never} == {"track"}
    np.testing.assert_allclose(never[-1].tasks[0].position, BELOW)


def test_the_circle_starts_where_contact_was_made() -> None:
    moved = ROBOT.home + 0.01
    here = ROBOT.placement(moved, FRAME)[0]
    source = _source(found=True)
    state = source.init(_estimate(0.0))
    _, state = source.step(_estimate(0.0), state)
    ramp, state = source.step(_estimate(0.001, True, moved), state)
    np.testing.assert_allclose(ramp.tasks[0].position, here)
    later, state = source.step(_estimate(0.101, True), state)
    np.testing.assert_allclose(later.tasks[0].position, here, atol=1e-9)
    assert later.phase == "circle"
    assert np.linalg.norm(here - START) > 1e-3  # else the test would prove nothing


def test_each_node_of_the_preview_has_the_phase_of_its_time() -> None:
    lookahead = Lookahead(nodes=5, step=0.003)
    references = _run(_source(found=False, lookahead=lookahead), 0.25)
    for tick, reference in enumerate(references):
        assert reference.preview is not None
        np.testing.assert_allclose(reference.preview.time, 1e-3 * tick + 0.003 * np.arange(6))
        later = [references[tick + 3 * k] for k in range(6) if tick + 3 * k < len(references)]
        assert reference.preview.phase[: len(later)] == tuple(entry.phase for entry in later)
        forces = [entry.tasks[0].wrench[2] for entry in later]
        np.testing.assert_allclose(reference.preview.wrench[: len(later), 2], forces, atol=1e-9)
    unknown = _run(_source(found=True, lookahead=lookahead), 0.1)[-1].preview
    assert unknown is not None
    assert set(unknown.phase) == {"track"}


@pytest.mark.parametrize("period", [1e-3, 0.7e-3])
def test_a_preview_that_is_looked_at_now_and_then_is_made_then(period: float) -> None:
    """It is the one of a source that makes it in every tick; baseline: that one has one in every tick."""
    always = _source(found=True, lookahead=Lookahead(5, 0.003, 0.002))
    rarely = _source(found=True, lookahead=Lookahead(5, 0.003, 0.002, every=0.002))
    states, looks = [source.init(_estimate(0.0)) for source in (always, rarely)], []
    times = [period * tick for tick in range(200)] + [0.05 + period * tick for tick in range(5)]  # the clock goes back
    for time in times:
        estimate = _estimate(time, time > 0.08)
        (whole, states[0]), (part, states[1]) = (
            source.step(estimate, state) for source, state in zip((always, rarely), states, strict=True)
        )
        assert whole.preview is not None
        np.testing.assert_array_equal(whole.tasks[0].position, part.tasks[0].position)
        if part.preview is not None:
            looks.append(time)
            np.testing.assert_array_equal(part.preview.position, whole.preview.position)
            np.testing.assert_array_equal(part.preview.wrench, whole.preview.wrench)
            assert part.preview.phase == whole.preview.phase
    assert looks[0] == 0.0
    late = np.diff(looks[:-5])
    assert (late >= 0.002 - 1e-9).all()
    assert (late < 0.002 + period).all()
    assert times[200] in looks  # where the clock went back
    assert len(looks) < 0.6 * len(times)


def test_wrong_tasks_are_refused() -> None:
    with pytest.raises(ConfigError, match="different names"):
        PhasedSource(ROBOT, FRAME, [TaskPhase("a", Hold(START)), TaskPhase("a", Hold(START))], np.eye(3))
    with pytest.raises(ConfigError, match="above zero"):
        TaskPhase("a", Hold(START), duration=0.0)
