"""Tasks that are lists of phases: the studies' cases as files, what is refused, what is drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pliant import loop
from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_case
from pliant.robot import Robot
from pliant.simulation import random_pushes
from pliant.studies.task.build_list import listed
from pliant.studies.task.config import TaskCase, case_of
from pliant.studies.task.listed import changes_of, scene_of, stages_of
from pliant.studies.task.measure_list import measured_list
from pliant.studies.task.study import study_of
from pliant.studies.task.world import pushes_of
from pliant.tasks import load_task
from pliant.telemetry.log import Log
from pliant.telemetry.recorder import Recorder


def recorded(study: Any, case: Any, period: float) -> Log:
    """The log of a run in memory."""
    wired, recorder = study.build(case), Recorder(None)
    ticks = range(round(case.duration / period))
    loop.run(wired.plant, wired.estimator, wired.source, wired.controller, ticks, [recorder])
    return recorder.log()


@pytest.mark.study
@pytest.mark.parametrize(
    ("study", "case", "task", "variant", "duration"),
    [
        ("stack", "figure8-plain", "figure8", "figure8", 0.3),
        ("stack", "figure8-gazebo", "figure8", "figure8-gazebo", 0.3),
        ("stack", "figure8-wall", "figure8", "figure8-wall", 2.5),
        ("stack", "line-hardware", "line", "line", 0.3),
        ("haptic", "floor", "floor", "floor", 0.8),
        ("haptic", "box-tip", "push-box", "push-box", 1.3),
        ("stack", "figure8-hardware", "figure8-hardware", "figure8-hardware", 0.3),
        ("stack", "line-slow", "line", "line-slow", 0.3),
        ("haptic", "ball", "ball", "ball", 0.7),
        ("haptic", "target-sequence", "target-sequence", "target-sequence", 1.6),
    ],
)
def test_a_case_of_a_study_is_a_task_file(study: str, case: str, task: str, variant: str, duration: float) -> None:
    """The same motion and torques, tick by tick; with another force or gain they would not be."""
    ours, theirs = study_of(task), get_study(study)
    mine, yours = ours.case(variant), theirs.case(case)
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
        felt = one[f"truth/{frame}/wrench"]
        assert np.abs(felt).max() > 1.0
        np.testing.assert_allclose(felt, other[f"truth/{frame}/wrench"], atol=1e-3)


PHASES = """
robot = "leg3"
controller = "haptic"
moves = "foot"
compensates = "gravity"
timing = { sensing_delay = 0.0, computation_delay = 0.0 }
simulation = { contact = "explicit", physics_step = 1e-4 }
impedance = { stiffness = [6000, 6000, 12000], force_max = [150, 150, 300], range = 0.025 }
scene.floor = { shape = "plane", stiffness = 1e5, damping = 1e3, friction = 0.0 }
"""
FIRST = '[[phase]]\nname = "down"\ntarget = [0.1, 0.0, 0.017]\nwrench = [0, 0, 20]\n'
INSERTION = """
robot = "panda"
controller = "haptic"
scene.hole = { shape = "plane", pose = { xyz = [0.5, 0.0, 0.2] } }
[[phase]]
frame = "hole"
target = [0.0, 0.0, -0.01]
modes = ["motion", "motion", "force", "force", "force", "motion"]
wrench = [0, 0, 8, 0, 0, 0]
until = { any = [{ depth = 0.004 }, { timeout = 8.0 }] }
else = "fail"
"""


def case_from(folder: Path, text: str) -> TaskCase:
    file = folder / "task.toml"
    file.write_text(text, encoding="utf-8")
    return case_of(load_task(file), "task")


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


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (INSERTION.replace('modes = ["motion", "motion", "force"', 'modes = ["motion", "motion", "motion"').replace(
            '"force", "force", "motion"]', '"motion", "motion", "motion"]'), r"axes whose mode is not force: z"),
        (INSERTION + 'motion = { shape = "line" }\n', r"motion is for a timed list"),
        (INSERTION.replace('frame = "hole"', 'frame = "hull"'), r"a thing of the scene or a pose; valid: 'hole'"),
        (PHASES + FIRST + 'touch = "flor"\nduration = 1.0\n', r"touch names no thing.*did you mean 'floor'"),
        (PHASES + FIRST + "until = { force = 3.0 }\n", r"'down' may never end"),
        (PHASES + '[[phase]]\nduration = 1.0\n', r"the first phase needs a target"),
        (PHASES + FIRST + "duration = 1.0\n[[event]]\nchange = { tarjet = [0, 0, 0] }\n", r"did you mean 'target'"),
        (PHASES + FIRST + "duration = 1.0\n[[event]]\nchange = { target = [0, 0] }\n", r"target is 3 numbers, got"),
        (PHASES + FIRST + 'duration = 1.0\n[[event]]\nchange = { reset = "no" }\n', r"true or false, got 'no'"),
        (
            PHASES + FIRST + 'duration = 1.0\n[[phase]]\nduration = 1.0\ntracks.foot = { shape = "hold" }\n',
            r"a phase with tracks is the only one",
        ),
        (
            'robot = "panda"\ncontroller = "stack"\n[[phase]]\nduration = 1.0\ntracks.flange = { shape = "hold" }\n'
            'tracks.elbow = { shape = "hold" }\n',
            r"the first frame has a motion, and the others are 'posture'",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_run_is_refused_in_a_sentence(tmp_path: Path, text: str, message: str) -> None:
    case = case_from(tmp_path, text)  # the file itself is in order
    with pytest.raises(ConfigError, match=message) as caught:
        study_of(str(tmp_path / "task.toml")).build(case)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (PHASES + FIRST, r"either duration or until"),
        (PHASES + FIRST + "duration = 1.0\nuntil = { contact = true }\n", r"either duration or until"),
        (PHASES + FIRST + "until = { contact = true, timeout = 2.0 }\n", r"a timeout stands alone"),
        (PHASES + FIRST + "until = {}\n", r"a condition needs one of"),
        (PHASES + FIRST.replace("[0, 0, 20]", "[0, 20]") + "duration = 1.0\n", r"three or six axes, got 2"),
        (PHASES + FIRST + "duration = 1.0\n" + FIRST + "duration = 1.0\n", r"phases need different names"),
        (PHASES, r"belongs to a task of \[\[phase\]\]"),
        (PHASES + "path.speed = 0.1\n" + FIRST + "duration = 1.0\n", r"path belongs to a task with a path"),
        (PHASES + "truth.tilt = 3.0\n" + FIRST + "duration = 1.0\n", r"truth\.tilt belongs to a task with a path"),
        (PHASES.replace('"plane"', '"plane", mass = 1.0') + FIRST + "duration = 1.0\n", r"a plane cannot move"),
    ],
)
def test_a_file_that_contradicts_itself_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        case_from(tmp_path, text)


def test_numbers_are_in_the_axes_of_the_phases_frame(tmp_path: Path) -> None:
    """A quarter turn about z: what is x there is the world's y; what a phase leaves out is as before."""
    frame = "frame = { xyz = [0.1, 0.0, 0.0], rpy = [0, 0, 90] }\n"
    text = FIRST.replace("[0.1, 0.0, 0.017]", "[0.02, 0.0, 0.1]").replace("[0, 0, 20]", "[7, 0, 0]")
    case = case_from(tmp_path, PHASES + text + frame + "duration = 1.0\n[[phase]]\nduration = 1.0\n")
    first, second = stages_of(case, Robot.load("leg3"), np.eye(3))
    for stage in (first, second):
        np.testing.assert_allclose(stage.task.position, [0.1, 0.02, 0.1], atol=1e-12)
        np.testing.assert_allclose(stage.task.wrench[:3], [0.0, 7.0, 0.0], atol=1e-12)
        assert stage.task.rotation is None


def test_events_are_drawn_by_the_seed_and_are_for_the_controller_that_they_name() -> None:
    case = study_of("push-box").case("push-box-harder")
    times = [changes_of(merged(case, {"seed": seed}))[0].time for seed in range(20)]
    assert len(set(times)) == 20
    assert min(times) >= 1.0
    assert max(times) <= 2.8
    np.testing.assert_array_equal(changes_of(case)[0].tuning["force_max"], np.full(3, 120.0))
    assert not changes_of(merged(case, {"controller": "haptic-hold"}))[0].tuning


def test_pushes_one_after_the_other_are_drawn_as_those_of_the_study(monkeypatch: pytest.MonkeyPatch) -> None:
    """From the same generator the same pushes; each seed other ones; none beyond the run."""
    case = study_of("figure8-hardware").case("figure8-pushed")
    apart = [pushes_of(merged(case, {"seed": seed}), 12.0) for seed in range(3)]
    assert len({pushes[0].start for pushes in apart}) == 3
    monkeypatch.setattr("pliant.studies.task.world.generator", lambda *_: np.random.default_rng(5))
    mine = pushes_of(case, 12.0)
    theirs = random_pushes(np.random.default_rng(5), "elbow", 12.0, start=2.0)
    for name in ("start", "duration", "force"):
        np.testing.assert_allclose([getattr(x, name) for x in mine], [getattr(x, name) for x in theirs], rtol=1e-12)
    assert len(mine) > 10
    one = merged(case, {"disturbance": [{"push": (1.0, 2.0, 3.0), "start": 13.0}]})
    assert pushes_of(one, 12.0) == ()


def test_things_stand_where_the_scene_says() -> None:
    floor, box = scene_of(study_of("push-box").case("push-box")).things
    assert (floor.name, floor.surface.friction, floor.surface.friction_moving) == ("floor", 0.5, 0.3)
    assert (box.name, box.surface.stiffness) == ("box", 1e6)
