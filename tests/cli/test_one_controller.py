"""What `pliant list controllers NAME` says, and that it is so."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

import pliant
from benchmarks import domains
from pliant.cli import one_controller
from pliant.cli.app import app
from pliant.experiments.origins import leaves
from pliant.robots import CATALOGUE
from pliant.wiring.domains import HOLDS, trials
from pliant.wiring.registry import controllers

CLI = CliRunner()
_TEMPLATE = Path(pliant.__file__).with_name("templates") / "controller.py"


@pytest.mark.parametrize("name", controllers())
def test_every_parameter_has_its_line(name: str) -> None:
    assert CLI.invoke(app, ["list", "controllers", name]).exit_code == 0
    keys = [".".join(path) for path, *_ in leaves(controllers()[name].default)]
    assert keys
    assert list(one_controller._parameters(controllers()[name]).columns[0].cells) == keys


def test_a_controller_without_a_name_is_told_too() -> None:
    told = CLI.invoke(app, ["list", "controllers", f"{_TEMPLATE}:MyController"])
    assert told.exit_code == 0, told.output
    assert "stiffness" in told.stdout
    assert "was not measured" in told.stdout


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["list", "controllers", "hapti"], "'haptic'"),
        (["list", "robots", "panda"], "`pliant doctor NAME`"),
        (["list", "studies", "stack"], "of controllers alone"),
    ],
)
def test_other_names_are_refused_in_a_sentence(words: list[str], said: str) -> None:
    told = CLI.invoke(app, words)
    assert told.exit_code == 2
    assert said in told.output
    assert "Traceback" not in told.output


def test_trials_are_of_what_there_is_and_once() -> None:
    cells = [(one.controller, one.robot, one.stiffness, one.delay) for one in trials()]
    assert len(set(cells)) == len(cells)
    assert {one.controller for one in trials()} == set(controllers())
    assert {one.robot for one in trials()} <= set(CATALOGUE)


def test_what_no_suggestion_changes_is_told_where_a_controller_fails() -> None:
    """The control has failed nowhere, or nothing of it is fixed."""
    for name, told in (("stack-paper", True), ("haptic-paper", True), ("haptic", False)):
        words = CLI.invoke(app, ["list", "controllers", name]).stdout
        assert ("what is suggested changes its gains, not this" in words) is told, name


@pytest.mark.parametrize(
    ("name", "robot", "holds"),
    [("offset-free-mpc", "iiwa14", True), ("classical-mpc", "ur3", False), ("haptic", "leg3", True)],
)
def test_what_is_told_can_be_found_again(name: str, robot: str, holds: bool) -> None:
    cells = [one for one in trials() if (one.controller, one.robot) == (name, robot)]
    trial = next(one for one in cells if (one.verdict == HOLDS) is holds)
    assert domains.run(trial.controller, trial.robot, trial.stiffness, trial.delay) == trial.verdict
