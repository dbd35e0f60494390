"""Tasks that are lists of phases: the studies' cases as files, how phases end, what is drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_case
from pliant.robot import Robot
from pliant.studies.task.build_list import listed
from pliant.studies.task.listed import changes_of, placed_phases_of, scene_of
from pliant.studies.task.measure_list import measured_list
from pliant.studies.task.study import study_of
from tests.tasks.lists import FIRST, PHASES, case_from, recorded


@pytest.mark.study
@pytest.mark.parametrize(
    ("study", "case", "task", "duration"),
    [
        ("stack", "figure8-plain", "figure8-plain", 0.3),
        ("stack", "figure8-gazebo", "figure8-plain", 0.3),
        ("stack", "figure8-wall", "figure8-plain", 2.5),
        ("stack", "figure8-hardware", "figure8-hardware", 0.3),
        ("stack", "figure8-pushed", "figure8-hardware", 0.3),
        ("stack", "line-hardware", "line-hardware", 0.3),
        ("stack", "line-pushed", "line-hardware", 0.3),
        ("stack", "line-slow", "line-hardware", 0.3),
        ("stack", "rest-plain", "rest-plain", 0.3),
        ("stack", "singular", "singular", 0.3),
        ("stack", "calibration", "figure8-plain", 2.4),
        ("haptic", "floor", "floor", 0.8),
        ("haptic", "floor-noise", "floor", 0.75),
        ("haptic", "floor-actuator", "floor", 0.75),
        ("haptic", "box-tip", "box-tip", 1.3),
        ("haptic", "box-top", "box-top", 0.75),
        ("haptic", "box-shank", "box-top", 0.1),
        ("haptic", "ball", "ball", 0.7),
        ("haptic", "ball-free", "ball-free", 0.7),
        ("haptic", "ball-unreachable", "ball", 0.7),
        ("haptic", "ball-actuator", "ball", 0.7),
        ("haptic", "delay", "delay", 0.75),
        ("haptic", "target-sequence", "target-sequence", 1.6),
        ("haptic", "parameters", "parameters", 0.75),
        ("haptic", "experiment-4", "experiment-4", 0.1),
        ("haptic", "target-stream", "target-stream", 1.9),
        ("haptic", "online", "online", 1.6),
        ("haptic", "random", "random", 0.8),
    ],
)
def test_a_case_of_a_study_is_a_task_file(study: str, case: str, task: str, duration: float) -> None:
    """The same motion and torques, tick by tick; with another force or gain they would not be."""
    ours, theirs = study_of(task), get_study(study)
    mine, yours = ours.case(case), theirs.case(case)
    first = mine.phase[0].model_dump(exclude_none=True)
    changes: dict[str, Any] = {"duration": duration}
    if mine.phase[0].tracks:  # the posture is solved for as long as the phase is
        changes["phase"] = [{**first, "duration": duration}]
    one = recorded(ours, merged(mine, changes), mine.simulation.period)
    other = recorded(theirs, merged(yours, {"duration": duration}), mine.simulation.period)
    assert len(one["truth/q"]) > 50
    np.testing.assert_allclose(one["truth/q"], other["truth/q"], atol=1e-7)
    np.testing.assert_allclose(one["command/torque"], other["command/torque"], atol=1e-4)
    frame = "foot" if study == "haptic" else "flange"
    np.testing.assert_allclose(one[f"reference/{frame}/position"], other[f"reference/{frame}/position"], atol=1e-9)
    if study == "haptic":
        touches = [name for name in ("foot", "shank") if f"truth/{name}/wrench" in other]
        felt = max(np.abs(other[f"truth/{name}/wrench"]).max() for name in touches)
        assert felt > 1.0 or duration < 0.5
        for name in touches:
            np.testing.assert_allclose(one[f"truth/{name}/wrench"], other[f"truth/{name}/wrench"], atol=1e-3)


@pytest.mark.parametrize(
    ("study", "case", "task"),
    [
        ("stack", "figure8-pushed", "figure8-hardware"),
        ("stack", "line-pushed", "line-hardware"),
        ("stack", "rest-plain", "rest-plain"),
        ("haptic", "box-shank", "box-top"),
    ],
)
def test_pushes_and_parts_that_touch_are_those_of_the_study(study: str, case: str, task: str) -> None:
    """What the first tenths of a second do not show; each seed draws other pushes."""
    ours, theirs, drawn = study_of(task), get_study(study), set[Any]()
    for seed in (0, 1):
        one, other = (each.build(merged(each.case(case), {"seed": seed})).plant for each in (ours, theirs))
        assert one.pushes == other.pushes
        assert one.links == other.links
        drawn.add((seed, one.pushes, one.links))
        assert one.pushes or one.links
    assert len({pushes for _, pushes, _ in drawn}) == (2 if study == "stack" else 1)


@pytest.mark.study
def test_phases_end_by_what_is_felt_and_the_force_is_held(tmp_path: Path) -> None:
    text = PHASES + FIRST + 'until = { any = [{ force = 15.0 }, { timeout = 2.0 }] }\n[[phase]]\nname = "hold"\n'
    case_from(tmp_path, text + "settle = 0.2\nduration = 0.5\n")
    study = study_of(str(tmp_path / "task.toml"))
    case = study.case("task")
    log = recorded(study, merged(case, {"duration": 2.0}), 1e-3)
    (begin, first), (later, second) = log.phases()
    assert (begin, first, second) == (0.0, "down", "hold")
    assert 0.1 < later < 1.9  # the force ended it, not the timeout
    found = {metric.name: metric for metric in measured_list(case, listed(case), log)}
    assert found["hold/force_rms"].value < 0.5
    assert found["hold/contact_breaks"].value == 0.0


@pytest.mark.study
def test_a_timeout_that_fails_is_a_failed_run(tmp_path: Path) -> None:
    text = PHASES + FIRST.replace("0.017", "0.1") + "until = { any = [{ force = 50.0 }, { timeout = 0.3 }] }\n"
    case_from(tmp_path, text)
    study = study_of(str(tmp_path / "task.toml"))
    failed = run_case(study, study.case("task")).failure
    assert failed is not None
    assert "'down' did not end within 0.3 s" in failed
    goes_on = study.case("task").model_copy(
        update={"phase": (study.case("task").phase[0].model_copy(update={"otherwise": "next"}),)}
    )
    later = run_case(study, goes_on).failure
    assert later is not None
    assert later.startswith("no contact: frame")  # the run went on to its end


def test_numbers_are_in_the_axes_of_the_phases_frame(tmp_path: Path) -> None:
    """A quarter turn about z: what is x there is the world's y; what a phase leaves out is as before."""
    frame = "frame = { xyz = [0.1, 0.0, 0.0], rpy = [0, 0, 90] }\n"
    text = FIRST.replace("[0.1, 0.0, 0.017]", "[0.02, 0.0, 0.1]").replace("[0, 0, 20]", "[7, 0, 0]")
    case = case_from(tmp_path, PHASES + text + frame + "duration = 1.0\n[[phase]]\nduration = 1.0\n")
    first, second = placed_phases_of(case, Robot.load("leg3"), np.eye(3))
    for placed in (first, second):
        np.testing.assert_allclose(placed.task.position, [0.1, 0.02, 0.1], atol=1e-12)
        np.testing.assert_allclose(placed.task.wrench[:3], [0.0, 7.0, 0.0], atol=1e-12)
        assert placed.task.rotation is None


def test_events_are_drawn_by_the_seed_and_are_for_the_controller_that_they_name() -> None:
    case = study_of("box-tip").case("box-tip-harder")
    times = [changes_of(merged(case, {"seed": seed}))[0].time for seed in range(20)]
    assert len(set(times)) == 20
    assert min(times) >= 1.0
    assert max(times) <= 2.8
    np.testing.assert_array_equal(changes_of(case)[0].tuning["force_max"], np.full(3, 120.0))
    assert not changes_of(merged(case, {"controller": "haptic-hold"}))[0].tuning


def test_things_stand_where_the_scene_says() -> None:
    floor, box = scene_of(study_of("box-tip").case("box-tip")).things
    assert (floor.name, floor.surface.friction, floor.surface.friction_moving) == ("floor", 0.5, 0.3)
    assert (box.name, box.surface.stiffness) == ("box", 1e6)
