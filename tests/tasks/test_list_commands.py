"""Lists of phases are checked and tuned by the same commands as paths on a surface."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pliant.cli.app import app
from pliant.configuration import merged
from pliant.experiments.base import Result
from pliant.experiments.search import find_search
from pliant.studies.task.search import FIRST_SEED, objective
from pliant.studies.task.study import study_of
from pliant.telemetry.summary import Metric

CLI = CliRunner()
LIST = """
robot = "leg3"
controller = "haptic"
moves = "foot"
compensates = "gravity"
timing = { sensing_delay = 0.0, computation_delay = 0.0 }
impedance = { stiffness = [6000, 6000, 12000], force_max = [150, 150, 300], range = 0.025 }
[[phase]]
name = "over"
target = [0.10, 0.0, 0.1]
duration = 0.3
[[phase]]
name = "aside"
target = [0.12, 0.0, 0.1]
duration = 0.3
[variant.away]
[[variant.away.phase]]
target = [0.9, 0.0, 0.1]
duration = 8.0
"""


def written(folder: Path, more: str = "") -> str:
    path = folder / "list.toml"
    path.write_text(more + LIST, encoding="utf-8")
    return str(path)


def test_a_list_is_checked_along_its_targets(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path)
    good = CLI.invoke(app, ["task", "check", "list.toml"])
    assert good.exit_code == 0, good.output
    assert "possible; no seed draws another way" in good.output
    assert list(tmp_path.rglob("list_check.png"))
    pressed = LIST.replace("[0.12, 0.0, 0.1]\n", "[0.12, 0.0, 0.1]\nwrench = [0, 0, 5000]\n")
    (tmp_path / "pressed.toml").write_text(pressed, encoding="utf-8")
    done = CLI.invoke(app, ["task", "check", "pressed.toml"])
    assert done.exit_code == 1, done.output
    assert "torque of joint" in done.output


def test_a_task_that_must_go_out_of_reach_is_no_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path)
    refused = CLI.invoke(app, ["task", "check", "list.toml", "--case", "away"])
    assert refused.exit_code == 1
    assert "surface" not in refused.output, "a list of phases has none to be moved"
    written(tmp_path, 'check = "off"\n')
    done = CLI.invoke(app, ["task", "check", "list.toml", "--case", "away"])
    assert done.exit_code == 0, done.output
    assert "cannot reach" in done.output
    assert 'the task says check = "off"' in done.output


def test_a_place_that_the_planner_would_bring_back_is_checked_as_asked(tmp_path: Path) -> None:
    """A target out of reach is brought back while it runs; the check says that it was asked for."""
    study = study_of(written(tmp_path))
    check = study.check(study.case("away"))
    assert not check.reachable
    assert "cannot reach" in check.surfaces[0].failure


def test_events_at_drawn_times_are_checked_too() -> None:
    study = study_of("box-tip")
    case = merged(study.case("box-tip-harder"), {"event": [{"time": {"uniform": (3.0, 3.4)}, "change": {}}]})
    down = [{"time": {"uniform": (3.0, 3.4)}, "change": {"wrench": [0.0, 0.0, 4000.0]}}]
    assert study.check(case, 3).reachable
    found = study.check(merged(case, {"event": down}), 3)
    assert [one.reachable for one in found.surfaces] == [False] * 4
    assert len({one.time for one in found.surfaces}) > 1  # each at its own time


@pytest.mark.parametrize(
    ("name", "controller"), [("floor", "haptic"), ("figure8-plain", "stack"), ("box-tip", "haptic")]
)
def test_a_list_is_searched_as_any_task(name: str, controller: str) -> None:
    sought = find_search(study_of(name), controller)
    assert any(key.endswith("stiffness") for key in sought.parameters)
    assert all(run.seed >= FIRST_SEED for run in sought.runs)


def test_a_search_on_a_list_writes_what_run_reads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path, 'tune = { "exploration.gain" = [5.0, 60.0] }\n')
    done = CLI.invoke(app, ["study", "list.toml", "--tune", "haptic", "--trials", "1"])
    assert done.exit_code == 0, done.output
    (folder,) = (tmp_path / "pliant-out").glob("list-tune-*")
    tuned = tomllib.loads((folder / "tuned.toml").read_text())
    assert 5.0 <= tuned["control"]["haptic"]["exploration"]["gain"] <= 60.0


def test_what_is_worse_in_one_phase_costs_more() -> None:
    case = study_of("floor").case("floor")
    good = {"a/force_rms": 0.5, "b/force_rms": 1.5, "a/position_max": 4.0, "a/contact_breaks": 0.0, "rmse_x": 2.0}

    def cost(**worse: float) -> float:
        return objective([Result(case, tuple(Metric(name, value, "1") for name, value in (good | worse).items()))])

    assert cost() == pytest.approx(1.0 + 0.2 + 2.0)  # phases are a mean
    for name, value in good.items():
        assert cost(**{name: value + 1.0}) > cost()
