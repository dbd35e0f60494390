"""Controllers of other people that are wrong in one place, or need something that a task does not have."""

from __future__ import annotations

import io
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from rich.console import Console

import pliant
from pliant.cli.listing import list_command
from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.registry import get_study
from pliant.experiments.sweep import Job, run_task
from pliant.interfaces import Lookahead, Needs
from pliant.wiring.registry import find_controller

ODD = textwrap.dedent(
    '''
    """Each is wrong in one place."""

    import numpy as np

    from pliant.controllers.registry import CONTROLLERS
    from pliant.entries import ControllerConfig, ControllerEntry
    from pliant.interfaces import ChannelUnit, Controller, Lookahead, Needs
    from pliant.signals import Command
    from pliant.telemetry.summary import Metric


    class Still(Controller):
        """It lets the arm hang."""

        class Config(ControllerConfig):
            gain: float = 1.0

        def __init__(self, robot, config, period):
            self.n, self.gain = robot.n, config.gain

        def init(self, estimate):
            return None

        def step(self, estimate, reference, state):
            zero = np.zeros(self.n)
            return Command(estimate.time, zero, zero), state


    class Heir(Still):
        """Its configuration is that of its base."""


    class Foresees(Still):
        """It looks at its preview."""

        needs = Needs(preview=Lookahead(4, 0.01))

        def step(self, estimate, reference, state):
            assert reference.preview.position.shape == (5, 3)
            return super().step(estimate, reference, state)


    class Feels(Still):
        """It wants the wrench."""

        needs = Needs(wrench=True)


    class Units(Still):
        """Its units are texts."""

        channels = {"a": "N"}


    def no_controller(robot, config, period):
        return 3


    def nothing(robot, config, believed):
        return None


    def divided(robot, config, believed):
        return 1 / 0


    def made(robot, config, period):
        return Still(robot, Still.Config(), period)


    builds = ControllerEntry("builds", "", ControllerConfig(), no_controller)
    suggests = ControllerEntry("suggests", "", ControllerConfig(), made, suggest=nothing)
    fails = ControllerEntry("fails", "", ControllerConfig(), made, suggest=divided)
    filters = ControllerEntry("filters", "", ControllerConfig(), made, filter=divided)
    sound = ControllerEntry("sound", "", ControllerConfig(), made)


    def text(log, config):
        return Metric("mine", "12", "N")


    def found(log, config):
        return Metric("mine", float(len(log["truth/q"])), "1")
    '''
)


@pytest.fixture(scope="module")
def odd(tmp_path_factory: pytest.TempPathFactory) -> str:
    file = tmp_path_factory.mktemp("odd") / "odd.py"
    file.write_text(ODD)
    return str(file)


SHORT = {"duration": 0.01, "checks": []}


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("Units", "channels name → ChannelUnit"),
        ("builds", "its build must return a Controller, got 3"),
        ("suggests", "its suggest must return a ControllerConfig, got None"),
        ("fails", "its suggest fails: ZeroDivisionError"),
        ("filters", "its filter fails: ZeroDivisionError"),
    ],
)
def test_what_an_own_controller_does_wrong_is_one_sentence(odd: str, name: str, said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        pliant.run("haptic", controller=f"{odd}:{name}", **SHORT)
    failure = pliant.run("haptic", controller=f"{odd}:sound", **SHORT).failure
    assert str(failure).startswith("no contact: frame")  # baseline: it runs to its end


def test_a_configuration_can_be_inherited(odd: str) -> None:
    assert find_controller(f"{odd}:Heir").default.model_dump() == {"gain": 1.0}


@pytest.mark.parametrize("task", ["haptic", "box-tip", "press"])
def test_a_preview_is_given_wherever_it_is_asked_for(odd: str, task: str) -> None:
    more = {"checks": []} if task == "haptic" else {}
    result = pliant.run(task, controller=f"{odd}:Foresees", duration=0.004, **more)
    assert "AssertionError" not in (result.failure or "")
    assert "AttributeError" not in (result.failure or "")


def test_who_needs_a_wrench_is_refused_where_nothing_feels_one(odd: str) -> None:
    for controller in (f"{odd}:Feels", "force-feedback-mpc"):
        with pytest.raises(ConfigError, match="there is no force signal: set sensor=true"):
            pliant.run("haptic", controller=controller, sensor=False, **SHORT)
    failure = pliant.run("haptic", controller=f"{odd}:Still", sensor=False, **SHORT).failure
    assert str(failure).startswith("no contact: frame")  # it runs to its end


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (lambda: Lookahead(0, 0.01), "1 node or more"),
        (lambda: Lookahead(3, -0.01), "step above zero"),
        (lambda: Lookahead(3, 0.01, -0.5), "lead of zero"),
        (lambda: Needs(preview=(5, 0.01)), "Lookahead"),  # type: ignore[arg-type]
        (lambda: Needs(disturbance="some"), "valid: 'all', 'none', 'normal'"),  # type: ignore[arg-type]
    ],
)
def test_needs_that_nobody_can_meet_are_refused(given: object, said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        given()  # type: ignore[operator]


@pytest.mark.parametrize(
    ("study", "controller", "changes"),
    [
        ("haptic", "haptic-hold", {"exploration": {"gain": 45.0}}),
        ("haptic", "haptic-paper", {"exploration": {"mode": "adaptive"}}),
        ("stack", "stack-paper", {"law": "capped"}),
        ("stack", "spring", {"law": "capped"}),
    ],
)
def test_what_makes_a_controller_what_it_is_cannot_be_set(study: str, controller: str, changes: object) -> None:
    """Otherwise a run would go by a name that is not its own."""
    config = merged(get_study(study).case(next(iter(get_study(study).cases))), {"controller": controller})
    get_study(study).build(config)
    with pytest.raises(ConfigError, match=f"{controller!r} is defined by"):
        get_study(study).build(merged(config, {"control": changes}))


def test_own_metrics_of_a_run_that_measured_nothing_change_no_sentence(odd: str) -> None:
    alone = pliant.run("press", controller="haptic", duration=0.05)
    beside = pliant.run("press", controller="haptic", duration=0.05, metrics=[f"{odd}:found"])
    assert alone.failure is not None
    assert beside.failure == alone.failure
    with pytest.raises(ConfigError, match="the value of 'mine' must be a number, got '12'"):
        pliant.run("haptic", metrics=[f"{odd}:text"], **SHORT)


def test_a_task_that_is_a_value_runs_and_travels(tmp_path: Path) -> None:
    task = pliant.load_task("press")
    result = pliant.run(task, controller="haptic", duration=0.02, out=tmp_path)
    assert result.config.case == "task"
    again = pliant.run(tmp_path / "config.toml")
    assert again.failure == result.failure
    assert (again.log["truth/q"] == result.log["truth/q"]).all()
    config = get_study("press").case("press").model_copy(update={"duration": 0.01, "controller": "haptic"})
    done = run_task(Job("a-file-that-went.toml", config))  # as a worker that does not see the file
    assert done.status == "failed"
    assert "no contact was found" in str(done.result.failure)


def test_one_broken_package_leaves_the_others_their_controllers(tmp_path: Path, odd: str) -> None:
    (tmp_path / "mine_ok.py").write_text(ODD)
    for name, value in (("good", "mine_ok:Still"), ("gone", "no_such_module:Still"), ("stack", "mine_ok:Still")):
        info = tmp_path / f"pkg_{name}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: pkg-{name}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[pliant.controllers]\n{name} = {value}\n")
    code = (
        "from pliant.wiring.registry import broken_controllers, controllers, find_controller\n"
        "print(find_controller('good').name, find_controller('stack').family, sorted(broken_controllers()))\n"
        "try: find_controller('gone')\nexcept Exception as error: print(error)\n"
    )
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path}, check=True
    )
    good, sentence = done.stdout.splitlines()
    assert good.startswith("good ")
    assert good.endswith("['gone', 'stack']")
    assert "'gone' (no_such_module:Still) of the package 'pkg-gone' cannot be used" in sentence


def test_names_are_whole_at_eighty_columns() -> None:
    said = io.StringIO()
    list_command(Console(file=said, width=80), "controllers")
    for name in pliant.controllers():
        assert name in said.getvalue()


def test_a_list_of_controllers_is_a_list() -> None:
    with pytest.raises(ConfigError, match="takes a list of controllers"):
        pliant.compare("haptic", "haptic")
    with pytest.raises(ConfigError, match="no part of the run"):
        pliant.run("haptic", duration=1.3)  # what is measured later would be empty
