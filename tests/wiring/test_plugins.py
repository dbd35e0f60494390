"""Controllers of other people: from a file, from a module, from an installed package; and what is refused."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_case
from pliant.wiring.registry import find_controller

MINE = textwrap.dedent(
    '''
    """A spring at one frame."""

    import numpy as np
    import pinocchio as pin

    from pliant.entries import ControllerConfig
    from pliant.interfaces import ChannelUnit, Controller, Needs
    from pliant.quantity import quantity
    from pliant.signals import Command
    from pliant.telemetry.summary import Metric


    class Spring(Controller):
        """A spring between a frame and its reference."""

        class Config(ControllerConfig):
            frame: str = "flange"
            stiffness: float = quantity(500.0, "N/m", "of the spring")

        channels = {"spring/force": ChannelUnit("N")}

        def __init__(self, robot, config, period):
            self.robot, self.config = robot, config

        @property
        def needs(self):
            return Needs(wrench=True)

        def init(self, estimate):
            return self.robot.model.createData()

        def step(self, estimate, reference, data):
            model, frame = self.robot.model, self.robot.frame_id(self.config.frame)
            axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
            J = pin.computeFrameJacobian(model, data, estimate.q, frame, axes)[:3]
            assert self.config.frame in estimate.wrenches
            here = pin.updateFramePlacement(model, data, frame).translation
            target = next(task for task in reference.tasks if task.frame == self.config.frame)
            force = self.config.stiffness * (target.position - here)
            torque = J.T @ force - estimate.v
            sent = np.clip(torque, -self.robot.torque_limit, self.robot.torque_limit)
            return Command(estimate.time, sent, torque - sent, {"spring/force": force}), data


    def strongest(log, config):
        """Largest force of the spring."""
        return Metric("strongest spring", abs(log["spring/force"]).max(), "N")


    def broken(log, config):
        return log["no/such/channel"]
    '''
)


def pliant(*arguments: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    code = "from pliant.cli import main\nif __name__ == '__main__': main()"
    environment = os.environ | {"OMP_NUM_THREADS": "1", "COLUMNS": "200"}
    command = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, check=False, timeout=120)


def test_a_controller_from_a_file_runs_with_its_parameters_units_and_needs(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(MINE)
    done = pliant(
        "run", "haptic", "--controller", "mine.py:Spring", "--set", "duration=0.1", "--set", "control.stiffness=800",
        "--set", "steps=[{target = [0, 0, 0.25]}]", "--set", "checks=[]",
        "--metric", "mine.py:strongest", "--out", "out", cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "strongest spring" in done.stdout
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["cases"][0]["controller"] == "mine.py:Spring"
    (log,) = (tmp_path / "out").glob("*.mcap")
    said = pliant("log", log, cwd=tmp_path)
    assert "spring/force" in said.stdout
    assert any("spring/force" in line and " N " in line for line in said.stdout.splitlines())


def test_a_controller_from_a_module_is_swept_over_two_processes(tmp_path: Path) -> None:
    (tmp_path / "my_control.py").write_text(MINE)
    done = pliant(
        "compare", "haptic", "--case", "random", "--seeds", 2, "--jobs", 2, "--controllers", "my_control:Spring",
        "--set", "duration=0.1", "--set", "checks=[]",
        "--metric", "my_control:strongest", "--out", "out", cwd=tmp_path,
    )  # fmt: skip
    assert "Traceback" not in done.stderr
    assert "no contact: frame" in done.stderr
    table = pq.read_table(tmp_path / "out" / "results.parquet")
    assert min(table["strongest spring [N]"].to_pylist()) > 1.0


@pytest.mark.parametrize(
    ("where", "message"),
    [
        ("nowhere.py:Spring", r"file nowhere\.py does not exist"),
        ("no_such_module:Spring", r"module 'no_such_module' cannot be imported"),
        ("numpy:NotThere", r"numpy has no 'NotThere'"),
        ("math:pi", r"must be a subclass of pliant\.interfaces\.Controller"),
        (":Spring", r"write my_module:Name"),
    ],
)
def test_what_is_no_controller_is_refused_in_a_sentence(where: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        find_controller(where)


def test_a_file_that_does_not_import_is_refused_with_its_reason(tmp_path: Path) -> None:
    (tmp_path / "broken.py").write_text("import math\nmath.no_such_thing\n")
    with pytest.raises(ConfigError, match=r"broken\.py cannot be imported: AttributeError"):
        find_controller(f"{tmp_path}/broken.py:Spring")


def test_an_installed_package_offers_its_controllers_by_name(tmp_path: Path) -> None:
    (tmp_path / "springs.py").write_text(MINE)
    info = tmp_path / "springs-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: springs\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[pliant.controllers]\nsoft-spring = springs:Spring\n")
    code = "from pliant.wiring.registry import controllers; print(controllers()['soft-spring'].summary)"
    environment = os.environ | {"PYTHONPATH": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False, timeout=60
    )
    assert done.stdout.strip() == "A spring between a frame and its reference.", done.stderr


@pytest.mark.parametrize(
    ("metric", "message"),
    [
        ("mine.py:weakest", "mine.py has no 'weakest'"),
        ("nothing", "there is no metric 'nothing'"),
        ("math:pi", "must be a function"),
    ],
)
def test_what_is_no_metric_is_refused_before_anything_runs(metric: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(MINE)
    name = f"{tmp_path}/{metric}" if metric.startswith("mine") else metric
    study = get_study("haptic")
    with pytest.raises(ConfigError, match=message):
        merged(study.case("floor"), {"own_metrics": [name]})


def test_a_metric_that_fails_says_which_and_why(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(MINE)
    study = get_study("haptic")
    changes = {"own_metrics": [f"{tmp_path}/mine.py:broken"], "duration": 0.01, "checks": []}
    with pytest.raises(ConfigError, match="no/such/channel"):
        run_case(study, merged(study.case("floor"), changes))
