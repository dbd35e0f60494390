"""The command line as a user calls it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

from pliant.cli.app import app
from pliant.telemetry import Log

PLIANT = [sys.executable, "-c", "from pliant.cli import main; main()"]
CLI = CliRunner()
SHORT = ["--set", "duration=3.4", "--set", "path.ramp=1.0"]


def pliant(*arguments: str, cwd: Path, timeout: float = 300.0) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"COLUMNS": "160", "OMP_NUM_THREADS": "1"}
    environment.pop("DISPLAY", None)
    return subprocess.run(
        [*PLIANT, *arguments], cwd=cwd, env=environment, capture_output=True, text=True, timeout=timeout, check=False
    )


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[subprocess.CompletedProcess[str], Path]:
    """One short run of the default case, in an empty folder."""
    folder = tmp_path_factory.mktemp("run")
    return pliant("run", *SHORT, cwd=folder), folder / "pliant-out" / "stack" / "figure8-wall"


@pytest.mark.study
def test_run_prints_a_table_and_leaves_log_figures_and_summary(
    finished: tuple[subprocess.CompletedProcess[str], Path],
) -> None:
    result, out = finished
    assert result.returncode == 0, result.stderr
    assert "RMSE x" in result.stdout
    assert "13.2" in result.stdout  # the paper's number stands beside ours
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["study"], summary["seed"]) == ("stack", 0)
    case = summary["cases"][0]
    assert (case["case"], case["controller"]) == ("figure8-wall", "stack")
    assert case["metrics"]["RMSE x"]["unit"] == "mm"
    assert case["metrics"]["RMSE x"]["paper"] == 13.2
    figures = sorted(path.name for path in out.glob("*.png"))
    assert [name.rsplit("_", 1)[1] for name in figures if "scene" not in name] == [
        "energy.png",
        "path.png",
        "posture.png",
        "torque.png",
    ]
    assert all((out / name).stat().st_size > 10_000 for name in figures)


@pytest.mark.study
def test_the_log_of_a_run_can_be_described_and_drawn(
    finished: tuple[subprocess.CompletedProcess[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pliant.cli.program.out", Console(width=160))
    (log,) = finished[1].glob("*.mcap")
    result = CLI.invoke(app, ["log", str(log), "--plot", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert "truth/flange/position" in result.stdout
    assert list(tmp_path.glob("*.png"))


@pytest.mark.study
def test_a_run_is_repeated_bit_for_bit_from_its_configuration(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("pliant.cli.program.out", Console(width=160))
    first = ["stack", "--case", "figure8-pushed", "--set", "duration=2.0", "--set", "path.ramp=0.5", "--seed", "3"]
    logs: list[bytes] = []
    for name, asked in (("a", first), ("b", ["a/config.toml"]), ("c", ["a/config.toml", "--seed", "4"])):
        result = CLI.invoke(app, ["run", *asked, "--no-figures", "--out", name])
        assert result.exit_code == 0, result.output
        assert not list((tmp_path / name).glob("*.png"))
        assert f"again    pliant run {name}/config.toml" in result.stdout
        (log,) = (tmp_path / name).glob("*.mcap")
        logs.append(log.read_bytes())
    assert logs[0] == logs[1]
    assert logs[0] != logs[2]


@pytest.mark.study
def test_a_configuration_file_and_overrides_reach_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text(
        'study = "stack"\ncase = "figure8-hardware"\nduration = 2.5\npreset = "table-1-robot"\n[path]\nramp = 0.5\n'
    )
    result = CLI.invoke(app, ["run", "mine.toml", "--no-figures", "--set", "path.period=3.0", "--out", "out"])
    assert result.exit_code == 0, result.output
    (log,) = (tmp_path / "out").glob("*.mcap")
    config = Log.open(log).info.config
    assert config["preset"] == "table-1-robot"
    assert config["path"]["ramp"] == 0.5
    assert config["path"]["period"] == 3.0
    assert config["joints"]["friction"] == 0.5  # the case's own value stays


def test_show_config_prints_every_value_and_runs_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = CLI.invoke(app, ["run", "stack", "--show-config", "--set", "path.period=3.0"])
    assert result.exit_code == 0, result.output
    rows = {line.split()[0]: line.split()[1:] for line in result.stdout.partition("\n\n")[0].splitlines()}
    assert rows["path.period"] == ["3.0", "s", "--set"]
    assert rows["physics_step"][-1] == "default"
    assert not list(tmp_path.iterdir())


def test_set_takes_lists_and_empties_lists_and_options() -> None:
    def shown(*sets: str) -> dict[str, list[str]]:
        arguments = [part for text in sets for part in ("--set", text)]
        result = CLI.invoke(app, ["run", "haptic", "--show-config", *arguments])
        assert result.exit_code == 0, result.output
        return {line.split()[0]: line.split()[1:] for line in result.stdout.partition("\n\n")[0].splitlines()}

    usual = shown()
    assert usual["checks"][0] != "[]"  # baseline: there is something to empty
    assert usual["torque_step"][0] not in ("null", "0.2")
    assert (usual["checks"][-1], usual["torque_step"][-1]) != ("--set", "--set")
    emptied = shown("checks=[]", "torque_step=none")
    assert emptied["checks"] == ["[]", "--set"]
    assert (emptied["torque_step"][0], emptied["torque_step"][-1]) == ("null", "--set")
    given = shown("steps=[{target = [0, 0, 0.25]}, {time = 1.5, target = [0, 0, 0.3]}]")
    assert "0.25]," in given["steps"]
    assert given["steps"][-1] == "--set"
    refused = CLI.invoke(app, ["run", "haptic", "--show-config", "--set", "steps=[{target = [0, 0]}]"])
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "steps.1.target: entry 3 is missing" in refused.stderr


@pytest.mark.study
def test_ctrl_c_keeps_what_was_recorded(tmp_path: Path) -> None:
    command = [*PLIANT, "run", "--set", "duration=150", "--set", "path.kind=hold", "--out", "out"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 120.0
    while time.monotonic() < deadline:
        logs = list((tmp_path / "out").glob("*.mcap"))
        if logs and logs[0].stat().st_size > 300_000:
            break
        time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=100)  # it takes 0.3 s on an idle machine, and others may be at work
    assert process.returncode == 130
    assert "Traceback" not in errors
    assert "interrupted" in errors
    assert (tmp_path / "out" / "config.toml").exists()  # so that it can be made again
    (path,) = (tmp_path / "out").glob("*.mcap")
    log = Log.open(path)
    assert not log.truncated
    assert log.failure == "interrupted"
    assert log.duration > 0.5


def test_doctor_and_list_say_what_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pliant.cli.program.out", Console(width=160))
    doctor = CLI.invoke(app, ["doctor"])
    assert doctor.exit_code == 0, doctor.output
    assert "mujoco" in doctor.stdout
    listed = CLI.invoke(app, ["list"])
    for name in ("lwr4", "iiwa14", "leg3", "operational-space", "figure8-wall"):
        assert name in listed.stdout


def test_what_only_lists_does_not_wait_for_the_libraries_of_a_run() -> None:
    program = "import sys; from pliant.cli.listing import list_command; from rich.console import Console"
    program += "; list_command(Console(), None); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=True)
    loaded = done.stdout.splitlines()[-1].split()
    assert "pliant.cli.listing" in loaded
    assert {"matplotlib", "mink", "numpy", "pinocchio", "pydantic", "qpsolvers"}.isdisjoint(loaded)


def test_doctor_locks_joints_of_a_robot() -> None:
    assert "iiwa14, 6 joints" in CLI.invoke(app, ["doctor", "iiwa14", "--locked", "A7=0.1"]).stdout


def test_doctor_warns_of_an_unsafe_configuration(tmp_path: Path) -> None:
    (tmp_path / "stiff.toml").write_text(
        'study = "stack"\ncase = "figure8-hardware"\n'
        "[control.tasks.ee.translation]\nstiffness = 60000\nforce_max = 4000\n"
    )
    result = CLI.invoke(app, ["doctor", "--config", str(tmp_path / "stiff.toml")])
    assert result.exit_code == 0, result.output
    assert "oscillates" in result.stdout
    assert "safe: stiffness" in result.stdout
