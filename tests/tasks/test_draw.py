"""Tasks whose values the seed draws, and sweeps whose rows change several values."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pliant.configuration import merged
from pliant.errors import ConfigError, ShapeError
from pliant.experiments.registry import get_study
from pliant.robot import Robot
from pliant.studies.task.build_list import listed
from pliant.studies.task.drawn_case import as_drawn
from pliant.studies.task.listed import robot_of_list
from pliant.studies.task.study import study_of

TASK = """
robot = "leg3"
controller = "haptic"
moves = "foot"
compensates = "gravity"
timing = { sensing_delay = 0.0, computation_delay = 0.0 }
scene.floor = { shape = "plane", stiffness = 1e5, friction = 0.0 }
[[phase]]
name = "press"
target = [0.1, 0.0, 0.017]
wrench = [0, 0, 20]
duration = 0.5
[draw]
"""


def written(folder: Path, more: str) -> str:
    file = folder / "task.toml"
    file.write_text(TASK + more, encoding="utf-8")
    return str(file)


def test_values_are_drawn_by_the_seed_and_follow_each_other(tmp_path: Path) -> None:
    more = """
"scene.floor.stiffness" = { log_uniform = [1e3, 1e6] }
"scene.floor.damping" = { of = "scene.floor.stiffness", factor = 2.0, power = 0.5 }
"phase.press.wrench.3" = { least = [{ uniform = [10, 40] }, { of = "scene.floor.stiffness", factor = 0.01 }] }
"phase.1.target.1" = { choice = [0.05, 0.15] }
"""
    case = study_of(written(tmp_path, more.replace("phase.1", "phase.press"))).case("task")
    runs = [as_drawn(merged(case, {"seed": seed})) for seed in range(40)]
    assert runs[3] == as_drawn(merged(case, {"seed": 3}))
    stiffness = np.array([one.scene["floor"].stiffness for one in runs])
    assert len(set(stiffness)) == 40
    assert 1e3 <= stiffness.min() < stiffness.max() <= 1e6
    np.testing.assert_allclose([one.scene["floor"].damping for one in runs], 2.0 * np.sqrt(stiffness), rtol=1e-12)
    forces = np.array([one.phase[0].wrench for one in runs], dtype=float)
    assert np.all(forces[:, :2] == 0.0)
    assert np.all(forces[:, 2] <= np.minimum(40.0, 0.01 * stiffness) + 1e-9)
    assert (forces[:, 2] < 0.0099 * stiffness).any()  # the other of the two
    assert {one.phase[0].target for one in runs} == {(0.05, 0.0, 0.017), (0.15, 0.0, 0.017)}


def test_one_value_drawn_more_leaves_the_others_as_they_were(tmp_path: Path) -> None:
    stiffness = '"scene.floor.stiffness" = { uniform = [1e4, 1e5] }\n'
    alone = as_drawn(study_of(written(tmp_path, stiffness)).case("task"))
    friction = '"scene.floor.friction" = { uniform = [0, 1] }\n'
    both = as_drawn(study_of(written(tmp_path, friction + stiffness)).case("task"))
    assert both.scene["floor"].stiffness == alone.scene["floor"].stiffness != 1e5
    assert both.scene["floor"].friction > alone.scene["floor"].friction == 0.0


def test_masses_that_are_scaled_are_known(tmp_path: Path) -> None:
    case = study_of(written(tmp_path, "")).case("task")
    heavier = merged(case, {"mass_scale": [1.0, 2.0, 0.5]})
    plain, found = Robot.load("leg3"), robot_of_list(heavier)
    masses = [inertia.mass for inertia in plain.model.inertias[1:]]
    np.testing.assert_allclose([one.mass for one in found.model.inertias[1:]], np.multiply(masses, [1.0, 2.0, 0.5]))
    assert listed(heavier).robot.model == found.model  # the controller's
    with pytest.raises(ShapeError, match=r"mass_scale must have 3 entries"):
        listed(merged(case, {"mass_scale": [1.0, 2.0]}))


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ('"scene.flor.stiffness" = { uniform = [1, 2] }', r"the task has no 'scene.flor'.*did you mean 'floor'"),
        ('"scene.floor.stifness" = { uniform = [1, 2] }', r"is no number of the task.*did you mean 'stiffness'"),
        ('"scene.floor.shape" = { uniform = [1, 2] }', r"'scene.floor.shape' is no number of the task"),
        ('"phase.down.settle" = { uniform = [1, 2] }', r"the task has no 'phase.down'; valid: 'press'"),
        ('"phase.press.wrench.4" = { uniform = [1, 2] }', r"is no number of the task; valid: '1', '2', '3'"),
        ('"scene.floor.damping" = { of = "scene.floor.stiffness" }', r"follows 'scene.floor.stiffness', which is not"),
        ('"scene.floor.friction" = { uniform = [-2, -1] }', r"friction.*must be at least 0"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_a_sentence(tmp_path: Path, more: str, message: str) -> None:
    study = study_of(written(tmp_path, more + "\n"))
    with pytest.raises(ConfigError, match=message) as caught:
        study.build(study.case("task"))
    assert "\n" not in str(caught.value)


def test_a_row_of_a_sweep_can_change_several_values(tmp_path: Path) -> None:
    more = """
[sweep]
seeds = 2
ground = [
  { label = "soft", scene.floor = { stiffness = 1e3, damping = 10.0 } },
  { label = "hard", "scene.floor.stiffness" = 1e6 },
]
"planner.speed" = [0.1, 0.2]
"""
    study = study_of(written(tmp_path, more))
    runs = study.runs("task")
    assert len(runs) == 8
    found = {(one.variant, one.scene["floor"].stiffness, one.scene["floor"].damping, one.planner.speed) for one in runs}
    assert ("ground soft, planner.speed 0.1", 1e3, 10.0, 0.1) in found
    assert ("ground hard, planner.speed 0.2", 1e6, 100.0, 0.2) in found
    nameless = study_of(written(tmp_path, more.replace('label = "soft", ', "")))
    with pytest.raises(ConfigError, match=r"sweep\.ground: a table that changes several values has a label"):
        nameless.runs("task")


def test_rows_of_balance_are_those_of_the_study() -> None:
    """Each strength of the elbow's task, with the gains that go with it."""
    ours, theirs = study_of("figure8-plain"), get_study("stack")
    mine, yours = ours.runs("balance"), theirs.runs("balance")
    assert len(mine) == len(yours) == 8
    brief = {"phase": [{**mine[0].phase[0].model_dump(exclude_none=True), "duration": 0.1}]}
    for one, other in zip(mine, yours, strict=True):
        assert one.variant.split()[1] == other.variant.removeprefix("elbow-").removesuffix("N")
        own = listed(merged(one, brief)).parameters.impedances()
        for frame, tuning in other.parameters().impedances().items():
            np.testing.assert_allclose(own[frame].force_max, tuning.force_max)
            np.testing.assert_allclose(own[frame].stiffness, tuning.stiffness)
            np.testing.assert_allclose(own[frame].linear_range, tuning.linear_range)
