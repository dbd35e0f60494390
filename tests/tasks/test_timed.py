"""Timed lists: targets are reached when phases end, what is told from the contact counts from there, and forces change
by their profile."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.interfaces import Lookahead
from pliant.signals import Estimate
from pliant.studies.task.build_list import listed
from pliant.studies.task.study import study_of
from pliant.studies.task.timed import timed_source
from tests.tasks.lists import case_from, recorded
from tests.tasks.timed_lists import DOWN, PRESS, TIMED, places, said

UNTIL = "until = { any = [{ contact = true }, { timeout = 0.4 }] }\n"
SQUARE = {"times": (0.0, 0.2, 0.6), "wrench": ((0.0, 0.0, 5.0), (0.0, 0.0, 25.0), (0.0, 0.0, 10.0))}


def test_a_target_is_reached_at_rest_when_its_phase_ends(tmp_path: Path) -> None:
    case = case_from(tmp_path, TIMED + DOWN + "[[phase]]\ntarget = [0.6, 0.1, 0.1]\nduration = 1.0\n")
    found = said(case, 1.5)
    place, speed = places(found), np.array([np.linalg.norm(one.tasks[0].velocity) for one in found])
    np.testing.assert_allclose(place[0], [0.6, 0.0, 0.15], atol=1e-12)
    np.testing.assert_allclose(place[50], [0.6, 0.0, 0.1], atol=1e-12)
    np.testing.assert_allclose(place[-1], [0.6, 0.1, 0.1], atol=1e-4)
    assert speed[50] < 1e-9
    assert speed[25] > 0.1
    assert {one.phase for one in found} == {"down", "phase 2"}


def test_begin_via_and_arrive_shape_the_way(tmp_path: Path) -> None:
    text = DOWN + "begin = [0.6, 0.0, 0.2]\nvia = [[0.6, 0.05, 0.2]]\narrive = 0.4\n"
    place = places(said(case_from(tmp_path, TIMED + text), 0.5))
    for index, wanted in ((0, [0.6, 0.0, 0.2]), (20, [0.6, 0.05, 0.2]), (40, [0.6, 0.0, 0.1]), (49, [0.6, 0.0, 0.1])):
        np.testing.assert_allclose(place[index], wanted, atol=1e-12)


def test_what_is_told_from_the_contact_counts_from_where_the_tool_was(tmp_path: Path) -> None:
    """Beside its believed place; in the world's axes it would not move."""
    text = TIMED + DOWN + PRESS + "target = [0.0, 0.02, 0.0]\n"
    straight, beside = (said(case_from(tmp_path, text), 1.6, off)[-1].tasks[0].position for off in (0.0, 0.01))
    robot = listed(case_from(tmp_path, text)).robot
    start = listed(case_from(tmp_path, text)).start
    moved = robot.placement(start + 0.01 * np.eye(robot.n)[0], "tool")[0] - robot.placement(start, "tool")[0]
    np.testing.assert_allclose(beside - straight, moved, atol=1e-9)
    assert np.linalg.norm(moved) > 1e-3
    world = text.replace('"contact"', '"world"').replace("[0.0, 0.02, 0.0]", "[0.6, 0.02, 0.1]")
    fixed = [said(case_from(tmp_path, world), 1.6, off)[-1].tasks[0].position for off in (0.0, 0.01)]
    np.testing.assert_array_equal(*fixed)


def test_a_phase_ends_on_contact_and_a_run_that_feels_none_in_time_fails(tmp_path: Path) -> None:
    case = case_from(tmp_path, TIMED + DOWN.replace("duration = 0.5\n", UNTIL) + PRESS)
    assert [one.phase for one in said(case, 0.05, touching=True)] == ["press"] * 5
    with pytest.raises(Exception, match=r"'down' felt no contact"):
        said(case, 0.6)


def test_a_profile_is_the_force_over_the_time_of_its_phase(tmp_path: Path) -> None:
    base = case_from(tmp_path, TIMED + DOWN + PRESS)
    wanted = {
        "ramp": {0.0: 5.0, 0.1: 15.0, 0.2: 25.0, 0.4: 17.5, 0.9: 10.0},
        "step": {0.0: 5.0, 0.1: 5.0, 0.2: 25.0, 0.4: 25.0, 0.9: 10.0},
        "smooth": {0.0: 5.0, 0.1: 15.0, 0.2: 25.0, 0.4: 17.5, 0.9: 10.0},
    }
    for shape, values in wanted.items():
        changes = {"phase": {"press": {"wrench": None, "profile": {**SQUARE, "shape": shape}}}}
        found = said(merged(base, changes), 1.5)
        for time, force in values.items():
            told = found[50 + round(100 * time)].tasks[0].wrench
            np.testing.assert_allclose(told, [0.0, 0.0, force, 0.0, 0.0, 0.0], atol=1e-6)


def test_a_circle_keeps_its_radius_and_comes_to_rest(tmp_path: Path) -> None:
    turn = 'motion = { shape = "circle", size = [0.05, 0.0], period = 1.0, ramp = 0.2 }\nduration = 1.0\n'
    text = (
        DOWN
        + f'[[phase]]\nname = "turn"\n{turn}'
        + '[[phase]]\nmotion = { shape = "stop", ramp = 0.2 }\nduration = 0.5\n'
    )
    found = said(case_from(tmp_path, TIMED + text), 2.0)
    place = places(found)
    np.testing.assert_allclose(np.linalg.norm(place[50:150] - [0.65, 0.0, 0.1], axis=1), 0.05, atol=1e-12)
    np.testing.assert_allclose(place[50], [0.6, 0.0, 0.1], atol=1e-12)
    assert place[60, 1] > 0.0  # it sets out along y of its frame
    speed = np.array([one.tasks[0].velocity[:3] for one in found])
    assert np.linalg.norm(speed[149]) == pytest.approx(2.0 * np.pi * 0.05, rel=1e-6)
    np.testing.assert_allclose(speed[151], speed[149], atol=0.1)  # no jump at the end of the circle
    assert np.abs(speed[171:]).max() < 1e-9
    np.testing.assert_allclose(np.diff(place[50:], axis=0), 0.01 * 0.5 * (speed[50:-1] + speed[51:]), atol=2e-4)


def test_a_curve_of_no_motion_holds_the_target(tmp_path: Path) -> None:
    text = DOWN + '[[phase]]\nmotion = { shape = "hold" }\nduration = 0.5\n'
    np.testing.assert_allclose(places(said(case_from(tmp_path, TIMED + text), 1.0))[50:], [[0.6, 0.0, 0.1]] * 50)


def test_free_tracks_know_a_circle(tmp_path: Path) -> None:
    text = 'robot = "panda"\ncontroller = "stack"\n[[phase]]\nduration = 0.3\n'
    text += 'tracks.flange = { shape = "circle", size = [0.05, 0.0], ramp = 0.1 }\n'
    made = listed(case_from(tmp_path, text))
    assert made.tracked is not None
    place = np.array([made.tracked.at(t, t).tasks[0].position for t in np.linspace(0.0, 0.3, 30)])
    centre = made.robot.placement(made.robot.home, "flange")[0]
    np.testing.assert_allclose(np.linalg.norm(place - centre, axis=1), 0.05, atol=1e-9)


def test_the_preview_says_what_will_be_said(tmp_path: Path) -> None:
    case = merged(case_from(tmp_path, TIMED + DOWN + PRESS), {"phase": {"press": {"wrench": None, "profile": SQUARE}}})
    made, found = listed(case), said(case, 1.2)
    source, nothing = timed_source(case, made.robot, made.start, Lookahead(100, 0.01)), np.zeros(made.robot.n)
    estimate = Estimate(0.0, made.start, nothing, nothing, nothing)
    preview = source.step(estimate, source.init(estimate))[0].preview
    assert preview is not None
    assert preview.phase[:50] == ("down",) * 50
    np.testing.assert_allclose(preview.position[:50], places(found)[:50], atol=1e-9)
    np.testing.assert_allclose(preview.wrench, [one.tasks[0].wrench for one in found[:101]], atol=1e-9)


@pytest.mark.study
@pytest.mark.parametrize("tilt", [0.0, 25.0])
def test_a_force_across_a_tilted_plane_is_held_as_on_a_level_one(tmp_path: Path, tilt: float) -> None:
    """Axes and believed surface follow from the wrench; pressed upright on the same plane it slides and errs more."""
    s, c = np.sin(np.radians(tilt)), np.cos(np.radians(tilt))
    turned = f"frame = {{ xyz = [0.6, 0.0, 0.1], rpy = [0, {tilt}, 0] }}\n"
    height = 0.015 / c if tilt else 0.015
    scene = (
        f"scene.table = {{ shape = 'plane', pose = {{ xyz = [0.6, 0.0, {0.1 - height}], rpy = [0, {tilt}, 0] }} }}\n"
    )
    start = TIMED.replace("rpy = [180, 0, 180]", f"rpy = [180, {-tilt}, 180]").replace(
        "xyz = [0.6, 0.0, 0.15]", f"xyz = [{0.6 + 0.05 * s}, 0.0, {0.1 + 0.05 * c}]"
    )
    timing = "timing = { sensing_delay = 0.0, computation_delay = 0.0 }\n"
    press = '[[phase]]\nname = "press"\nwrench = [0, 0, 20]\nduration = 1.0\nsettle = 0.5\n'
    first = DOWN.replace("target = [0.6, 0.0, 0.1]", turned + "target = [0.0, 0.0, 0.0]")
    case_from(tmp_path, start + timing + scene + first + press)
    study = study_of(str(tmp_path / "task.toml"))
    log = recorded(study, merged(study.case("task"), {"duration": 1.5}), 1e-3)
    found = {metric.name: metric.value for metric in study.metrics(study.case("task"), log)}
    assert found["press/force_rms"] < 0.5
    assert found["press/contact_breaks"] == 0.0
    force = log["truth/tool/wrench"][-200:, :3].mean(axis=0)
    np.testing.assert_allclose(force, 20.0 * np.array([s, 0.0, c]), atol=0.6)
