"""The limits of a task: what asks for more is refused, what passes them ends the run and counts as failed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.runner import run_case
from pliant.signals import Truth
from pliant.simulation.limited_plant import RunLimits
from pliant.studies.task.study import study_of

SHORT = {
    "surface": {"pose": {"xyz": (0.55, 0.0, 0.1)}},
    "path": {"pattern": "line", "size": (0.02, 0.0), "speed": 0.05},
    "force": {"normal": 20.0},
    "phases": {"stand_off": 0.01, "press": 0.1, "leave": 0.1},
    "timing": {"sensing_delay": 0.0, "computation_delay": 0.0},
    "truth": {"shift": 0.0, "tilt": 0.0, "imperfections": "none"},
}
FLOOR = """
robot = "leg3"
controller = "haptic"
moves = "foot"
compensates = "gravity"
landing = "off"
timing = { sensing_delay = 0.0, computation_delay = 0.0 }
scene.floor = { shape = "plane", stiffness = 1e5, damping = 1e3 }
[[phase]]
target = [0.1, 0.0, 0.017]
wrench = [0, 0, 20]
duration = 0.6
[limits]
"""


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        ({"force": 15.0}, r"force\.normal asks for 20 N, and limits\.force allows 15"),
        ({"speed": 0.03}, r"path\.speed asks for 0\.05 m/s, and limits\.speed allows 0\.03"),
        ({"workspace": {"upper": (0.55, 1.0, 1.0)}}, r"path leaves limits\.workspace at \(0\.55"),
        ({"workspace": {"lower": (1.0, 0.0, 0.0), "upper": (1.0, 1.0, 1.0)}}, r"lower must be below upper"),
        ({"torque": 1.5}, r"limits\.torque"),
    ],
)
def test_a_task_that_asks_for_more_than_it_allows_is_refused(limits: dict[str, Any], message: str) -> None:
    study = study_of("wipe")
    with pytest.raises(ConfigError, match=message) as caught:
        study.build(merged(study.case("wipe"), {**SHORT, "limits": limits}))
    assert "\n" not in str(caught.value)
    with pytest.raises(ConfigError, match=message):  # the check does not call it possible
        study.check(merged(study.case("wipe"), {**SHORT, "limits": limits}))


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        ("force = 10.0", r"wrench of phase 'phase 1' asks for 20 N"),
        ("speed = 0.05", r"planner\.speed asks for 0\.2 m/s"),
        ("workspace.lower = [0.0, 0.0, 0.05]", r"a target leaves limits\.workspace"),
    ],
)
def test_a_list_that_asks_for_more_than_it_allows_is_refused(tmp_path: Path, limits: str, message: str) -> None:
    (tmp_path / "t.toml").write_text(FLOOR + limits + "\n")
    study = study_of(str(tmp_path / "t.toml"))
    with pytest.raises(ConfigError, match=message):
        study.build(study.case("t"))


@pytest.mark.study
@pytest.mark.parametrize(
    ("limits", "failure"),
    [
        ({"force": 20.5}, "limits.force was exceeded"),
        ({"speed": 0.0501}, "limits.speed was exceeded"),
        ({"torque": 0.05}, "limits.torque was exceeded"),
        ({"workspace": {"lower": (-1.0, -1.0, 0.1149)}}, "limits.workspace was left"),
        ({"force": 60.0, "speed": 0.5, "torque": 1.0, "workspace": {"lower": (0.0, -1.0, 0.0)}}, None),
    ],
)
def test_a_run_ends_where_a_limit_is_passed(limits: dict[str, Any], failure: str | None) -> None:
    study = study_of("wipe")
    result = run_case(study, merged(study.case("wipe"), {**SHORT, "limits": limits}))
    if failure is None:
        assert result.failure is None
    else:
        assert result.failure is not None
        assert result.failure.startswith(failure)
        assert " at t = " in result.failure


@pytest.mark.study
def test_a_list_ends_there_too(tmp_path: Path) -> None:
    (tmp_path / "t.toml").write_text(FLOOR + "force = 20.2\n")
    study = study_of(str(tmp_path / "t.toml"))
    assert "limits.force was exceeded" in str(run_case(study, study.case("t")).failure)


def truth(place: np.ndarray, force: float, torque: float) -> Truth:
    wrench = np.array([0.0, 0.6 * force, 0.8 * force, 9.0, 9.0, 9.0])
    return Truth(0.0, np.zeros(2), np.zeros(2), np.array([0.0, -torque]), {"tool": place}, {}, {"tool": wrench})


@given(
    place=st.tuples(*[st.floats(-2.0, 2.0)] * 3),
    moved=st.floats(0.0, 2e-3),
    force=st.floats(0.0, 50.0),
    torque=st.floats(0.0, 20.0),
)
@settings(max_examples=200, deadline=None)
def test_what_is_said_to_be_broken_is(place: tuple[float, ...], moved: float, force: float, torque: float) -> None:
    limits = RunLimits("tool", 30.0, 1.0, 0.5, (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    here = np.array(place)
    said = limits.broken(truth(here, force, torque), here - [moved, 0.0, 0.0], 1e-3, np.array([10.0, 20.0]))
    speed = float(np.linalg.norm(here - (here - [moved, 0.0, 0.0]))) / 1e-3
    broken = {
        "force": np.linalg.norm([0.6 * force, 0.8 * force]) > 30.0,
        "speed": speed > 1.0,
        "torque": torque / 20.0 > 0.5,
        "workspace": np.abs(here).max() > 1.0,
    }
    assert bool(said) == any(broken.values())
    if said:
        assert broken[said.split()[0].removeprefix("limits.")]
