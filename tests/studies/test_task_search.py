"""Any controller is tuned on a task file, by its gains or by the parameters that the file names."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pliant.cli.app import app
from pliant.errors import ConfigError
from pliant.experiments.base import Result
from pliant.experiments.search import find_search
from pliant.studies.task.search import FIRST_SEED, objective
from pliant.studies.task.study import study_of
from pliant.telemetry.summary import Metric
from pliant.wiring.registry import controllers

CLI = CliRunner()
TASK = """\
[surface]
pose = { xyz = [0.55, 0.0, 0.1] }
[path]
pattern = "hold"
time = 0.1
[phases]
stand_off = 0.005
press = 0.1
leave = 0.1
[truth]
shift = { uniform = [-0.002, 0.002] }
[variant.soft]
surface = { stiffness = 5e3 }
"""


def written(folder: Path, more: str = "") -> str:
    path = folder / "press-once.toml"
    path.write_text(TASK + more, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("controller", controllers())
def test_every_controller_has_gains_to_search_on_other_seeds_than_a_tables(controller: str) -> None:
    study = study_of("wipe")
    sought = find_search(study, controller)
    assert sought.parameters
    assert all(run.controller == controller and run.seed >= FIRST_SEED for run in sought.runs)
    for key, about in sought.parameters.items():
        assert about.low < sought.start[key] < about.high
        assert "phases.reach" not in key  # of another task


def test_a_file_names_what_is_searched(tmp_path: Path) -> None:
    study = study_of(written(tmp_path, '[tune]\n"exploration.gain" = [5.0, 500.0]\n'))
    sought = find_search(study, "haptic")
    (key,) = sought.parameters
    assert (key, sought.parameters[key].log) == ("exploration.gain", True)
    assert sought.changes({key: 7.0}) == {"control": {"haptic": {"exploration": {"gain": 7.0}}}}
    with pytest.raises(ConfigError, match=r"tune: controller 'offset-free-mpc' has no number 'exploration\.gain'"):
        find_search(study, "offset-free-mpc")
    with pytest.raises(ConfigError, match="nobody"):
        find_search(study, "nobody")


def test_a_search_on_another_robot_starts_from_what_is_suggested_for_that_one(tmp_path: Path) -> None:
    """The joint damping of plain springs follows the lightest joint; iiwa14's, of the file, is the control."""
    more = '[variant.other]\nrobot = "ur5e"\n[tune]\njoint_damping = [0.01, 100.0]\n'
    study = study_of(written(tmp_path, more))
    changed = find_search(study, "spring", None, {"robot": "ur5e"})
    assert changed.start == find_search(study, "spring", "other").start
    assert changed.start["joint_damping"] != pytest.approx(find_search(study, "spring").start["joint_damping"], rel=0.1)
    assert [(run.robot, run.seed) for run in changed.runs] == [("ur5e", FIRST_SEED), ("ur5e", FIRST_SEED + 1)]
    with pytest.raises(ConfigError, match="nothing"):
        find_search(study, "spring", None, {"nothing": 1.0})


def test_what_is_worse_costs_more() -> None:
    case = study_of("wipe").case("wipe")
    good = {"force_error": 0.5, "path_error": 0.2, "force_error_max": 2.0, "contact_lost": 0.0}

    def cost(**worse: float) -> float:
        return objective([Result(case, tuple(Metric(name, value, "1") for name, value in (good | worse).items()))])

    assert cost() == pytest.approx(0.5 + 0.2 + 0.1)
    for name, value in good.items():
        assert cost(**{name: value + 1.0}) > cost()


@pytest.mark.parametrize("controller", ["operational-space", "mine.py:MyController"])
def test_a_search_on_a_file_writes_what_run_reads(
    controller: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """For a controller of the package, and for a class of the user's own."""
    monkeypatch.chdir(tmp_path)
    if ":" in controller:
        assert CLI.invoke(app, ["new", "controller", "MyController", "-o", "mine.py"]).exit_code == 0
    name = Path(written(tmp_path, "[tune]\nstiffness = [100.0, 900.0]\n")).name
    done = CLI.invoke(app, ["study", name, "--tune", controller, "--trials", "1", "--case", "soft"])
    assert done.exit_code == 0, done.output
    (folder,) = (tmp_path / "pliant-out").glob("press-once-tune-*")
    tuned = tomllib.loads((folder / "tuned.toml").read_text())
    assert (tuned["study"], tuned["case"], tuned["controller"]) == (name, "soft", controller)
    assert 100.0 <= tuned["control"][controller]["stiffness"] <= 900.0
    shown = CLI.invoke(app, ["run", str(folder / "tuned.toml"), "--show-config"])
    assert shown.exit_code == 0, shown.output
