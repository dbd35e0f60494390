"""A peg in a hole that stands elsewhere than believed, and things that `truth` moves."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from pliant import run
from pliant.axis_modes import AxisModes
from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.signals import TaskReference
from pliant.spatial import exp3
from pliant.studies.task.build_list import listed
from pliant.studies.task.config import TaskCase
from pliant.studies.task.listed import frame_of, placed_phases_of
from pliant.studies.task.measure_list import on_silent_axes, within
from pliant.studies.task.study import study_of
from pliant.studies.task.true_scene import true_scene

SHIFT = (0.003, -0.002, 0.001)  # m
LONG_ENOUGH = 5.0  # s: the task is done after 3 s and then rests until its timeouts, 11 s, are over


def peg(**things: Any) -> TaskCase:
    study = study_of("insert-peg")
    return merged(study.case("insert-peg"), {"truth": {"things": {"hole": things}}} if things else {})


def test_truth_moves_a_thing_along_its_own_axes_and_turns_it_about_its_place() -> None:
    case = merged(peg(shift=SHIFT, tilt=5.0, axis=(0.0, 1.0, 0.0)), {"scene": {"hole": {"pose": {"rpy": (90, 0, 0)}}}})
    believed, true = case.scene["hole"], true_scene(case)["hole"]
    R = believed.pose.rotation
    np.testing.assert_allclose(np.array(true.pose.xyz) - believed.pose.xyz, R @ SHIFT, atol=1e-12)
    turn = exp3(np.array([0.0, math.radians(5.0), 0.0]))
    np.testing.assert_allclose(true.pose.rotation, R @ turn, atol=1e-9)
    assert true.model_dump(exclude={"pose"}) == believed.model_dump(exclude={"pose"})
    assert np.abs(true.pose.rotation - turn @ R).max() > 0.05  # the control: the same turn about the world's axis


def test_each_value_is_one_draw_a_seed_and_a_random_axis_lies_across() -> None:
    drawn = peg(
        shift=({"uniform": (-1.0, 1.0)},) * 3,
        tilt={"uniform": (1.0, 9.0)},
        friction={"choice": (0.1, 0.4)},
        damping=7.0,
    )
    found = [true_scene(merged(drawn, {"seed": seed}))["hole"] for seed in range(6)]
    places = np.array([one.pose.xyz for one in found])
    assert len({tuple(place) for place in places.tolist()}) == 6
    assert len(set((places[0] - drawn.scene["hole"].pose.xyz).tolist())) == 3  # each axis has a draw of its own
    assert {one.friction for one in found} == {0.1, 0.4}
    assert {one.damping for one in found} == {7.0}
    for one in found:
        R = one.pose.rotation
        assert 1.0 - 1e-9 < math.degrees(math.acos(R[2, 2])) < 9.0 + 1e-9  # the whole tilt leans the axis
    assert true_scene(merged(drawn, {"seed": 3}))["hole"] == found[3]


def test_nothing_that_a_controller_is_told_depends_on_where_the_hole_is() -> None:
    def told(case: TaskCase) -> tuple[Any, ...]:
        made = listed(case)
        all_placed = placed_phases_of(case, made.robot, made.robot.placement(made.start, frame_of(case))[1])
        return made.parameters, made.duration, [placed.task.position.tolist() for placed in all_placed]

    here, there = peg(), peg(shift=SHIFT, tilt=3.0, stiffness=5e4)
    assert told(here) == told(there)
    assert true_scene(here)["hole"] != true_scene(there)["hole"]
    turned = merged(here, {"scene": {"hole": {"pose": {"xyz": (0.56, 0.0, 0.15)}}}})
    assert told(here) != told(turned)  # the control: what is believed


@pytest.mark.parametrize(
    ("things", "message"),
    [
        ({"hola": {"tilt": 1.0}}, "truth.things: there is no thing 'hola' in the scene; valid: 'hole'"),
        ({"hole": {"mass": 1.0}}, "truth.things.hole.mass: the thing is fixed to the world"),
    ],
)
def test_what_is_not_there_or_cannot_move_is_refused(things: dict[str, Any], message: str) -> None:
    study = study_of("insert-peg")
    with pytest.raises(ConfigError, match=message):
        study.build(merged(study.case("insert-peg"), {"truth": {"things": things}}))


def test_things_belong_to_a_list_of_phases() -> None:
    study = study_of("wipe")
    with pytest.raises(ConfigError, match=r"truth\.things belongs to a task of"):
        merged(study.case("wipe"), {"truth": {"things": {"part": {"tilt": 1.0}}}})


def test_side_forces_are_those_of_the_axes_on_which_nothing_is_asked_for() -> None:
    R = exp3(np.array([0.2, -0.5, 0.3]))
    modes = AxisModes(("force", "motion", "force", "motion", "force", "free"), R)
    task = TaskReference("tool", np.zeros(3), wrench=np.concatenate([R @ [0.0, 0.0, 8.0], np.zeros(3)]), modes=modes)
    local = np.array([[3.0, 90.0, 70.0, 50.0, -0.5, 40.0], [-4.0, 0.0, 0.0, 0.0, 0.2, 0.0]])
    world = np.hstack([local[:, :3] @ R.T, local[:, 3:] @ R.T])
    found = on_silent_axes(task, world)
    assert found["side_force_max"] == (pytest.approx(4.0), "N")
    assert found["side_moment_max"] == (pytest.approx(0.5), "N·m")
    assert on_silent_axes(TaskReference("tool", np.zeros(3)), world) == {}


GIVES_WAY = ("force", "force", "force", "force", "force", "motion")


def side_force(modes: tuple[str, ...]) -> float:
    """N, mean across the hole's axis while the peg rests in a hole that is 2 mm beside where it is believed."""
    hole = {"shift": (0.0014, -0.0014, 0.0), "tilt": 0.0}
    changed: dict[str, Any] = {"phase.insert.modes": modes, "phase.rest.modes": modes}
    made = run(
        "insert-peg",
        truth={"imperfections": "none", "things": {"hole": hole}},
        timing={"sensing_delay": 0.0, "computation_delay": 0.0},
        duration=LONG_ENOUGH,
        **changed,
    )
    assert made.failure is None, made.failure
    assert made.log.phases()[-1][0] < LONG_ENOUGH - 1.0
    inside = within(made.log, made.log.time("measurement/q"), "rest", 0.5)
    return float(np.linalg.norm(made.log["truth/tool/wrench"][inside, :2], axis=1).mean())


@pytest.mark.study
def test_a_peg_that_gives_way_rests_without_force_on_its_sides() -> None:
    assert side_force(GIVES_WAY) < 1.0
    assert side_force(("motion", "motion", "force", "motion", "motion", "motion")) > 2.0  # the control: it is held


@pytest.mark.study
@pytest.mark.parametrize(("controller", "seed"), [("haptic", 0), ("offset-free-mpc", 1)])
def test_an_imperfect_arm_puts_the_peg_into_a_hole_that_is_elsewhere(controller: str, seed: int) -> None:
    """Of the seeds of `benchmarks/insertion.py`, one each."""
    made = run("insert-peg", seed=seed, controller=controller, duration=LONG_ENOUGH)
    assert made.failure is None, made.failure
    begun, last = made.log.phases()[-1]
    assert last == "rest"
    assert begun < LONG_ENOUGH - 1.0
    assert made.metrics["insert/side_force_max"].value < 15.0
