"""Tasks from files, run: force on curved surfaces, what the metrics say, the commands as a user calls them."""

from __future__ import annotations

import itertools
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from pliant.cli.app import app
from pliant.configuration import merged
from pliant.experiments.runner import run_case
from pliant.spatial import exp3
from pliant.studies.task.build import planned
from pliant.studies.task.measure import MEASURES, TaskSignals, measured, signals_of
from pliant.studies.task.study import study_of
from pliant.studies.task.world import true_surface
from pliant.surfaces import SphereSurface
from pliant.telemetry import Log
from pliant.telemetry.output import output_folder

SHORT = {"path": {"pattern": "line", "size": (0.06, 0.03), "speed": 0.06}, "force": {"normal": 20.0}}
CLI = CliRunner()


@pytest.mark.study
@pytest.mark.parametrize(("name", "robot"), [("wipe-sphere", "panda"), ("wipe-cylinder", "ur5e")])
def test_a_force_on_a_curved_surface_that_is_not_where_it_is_believed(name: str, robot: str) -> None:
    study = study_of(name)
    result = run_case(study, merged(study.case(name), {**SHORT, "robot": robot, "seed": 1}))
    assert result.failure is None
    found = {metric.name: metric.value for metric in result.metrics}
    assert found["force_error"] <= 0.9
    assert found["contact_lost"] == 0.0
    assert found["force_peak"] <= 40.0


def signals(**changes: object) -> TaskSignals:
    values = {
        "time": np.arange(10) * 0.1,
        "force": np.array([0.0, 0.0, 4.0, 9.0, 10.0, 12.0, 10.0, 0.0, 10.0, 3.0]),
        "wanted": np.full(10, 10.0),
        "beside": np.linspace(0.0, 0.009, 10),
        "following": np.arange(10) >= 4,
        "limit": np.linspace(0.0, 0.5, 20).reshape(10, 2),
    }
    return TaskSignals(**(values | changes))  # type: ignore[arg-type]


def test_metrics_on_ten_samples() -> None:
    found = {metric.name: metric for metric in measured(signals(), {"force_error": 2.0})}
    assert found["force_error"].value == pytest.approx((0 + 2 + 0 + 10 + 0 + 7) / 6)
    assert found["force_error"].met is False
    assert found["force_error_max"].value == 10.0
    assert found["force_peak"].value == 12.0
    assert found["landing_peak"].value == 9.0  # before 0.2 s after the third sample
    assert found["contact_lost"].value == pytest.approx(100.0 / 6)
    assert found["path_error"].value == pytest.approx(1e3 * np.linspace(0.0, 0.009, 10)[4:].mean())
    assert found["path_error_max"].value == pytest.approx(9.0)
    assert found["torque_share"].value == pytest.approx(50.0)
    assert set(found) == set(MEASURES) - {"force_swing", "force_line"}  # no second in which the force stands still
    assert measured(signals(following=np.zeros(10, dtype=bool)), {}) == ()


@dataclass
class Written:
    """A log of signals that are told."""

    values: dict[str, np.ndarray]
    ends: float

    def __getitem__(self, name: str) -> np.ndarray:
        return self.values[name]

    def time(self, name: str) -> np.ndarray:
        return np.arange(len(self.values[name])) * 0.1

    def phases(self) -> list[tuple[float, str]]:
        return [(0.0, "press"), (0.2, "follow"), (self.ends, "release")]


@given(
    tilt=st.floats(5.0, 20.0),
    turned=st.floats(0.0, 2 * math.pi),
    force=st.floats(5.0, 40.0),
    radius=st.floats(0.1, 1.0),
)
@settings(max_examples=30, deadline=None)
def test_metrics_are_along_the_true_normal_and_in_its_tangent_plane(
    tilt: float, turned: float, force: float, radius: float
) -> None:
    """On a sphere whose top is tilted away from the believed normal z: pressed by the asked force along the true
    normal, off the path along that normal alone, there is no error; read along the believed one there is."""
    rng = np.random.default_rng(0)
    axis = np.array([math.cos(turned), math.sin(turned), 0.0])
    surface = SphereSurface(np.zeros(3), np.eye(3), radius)
    places = np.array([exp3(math.radians(tilt + wobble) * axis)[:, 2] for wobble in rng.uniform(-1.0, 1.0, 12)])
    wrench = np.hstack([force * places, rng.standard_normal((12, 3))])
    log = Written(
        {
            "truth/tool/wrench": wrench,
            "truth/tool/position": radius * places + 2e-3 * places,
            "reference/tool/position": radius * places,
            "reference/tool/wrench": np.tile([0.0, 0.0, force, 0.0, 0.0, 0.0], (12, 1)),
            "command/torque": np.zeros((12, 2)),
        },
        ends=1.0,
    )
    found = signals_of(log, "tool", surface, np.ones(2))  # type: ignore[arg-type]
    metrics = {metric.name: metric.value for metric in measured(found, {})}
    assert metrics["force_error_max"] < 1e-9
    assert metrics["path_error_max"] < 1e-9
    assert abs(wrench[:, 2] - force).min() > 1e-3 * force  # as the believed normal would have it
    assert found.following.sum() == 8


def test_every_row_of_a_sweep_says_what_it_changes(tmp_path: Path) -> None:
    path = tmp_path / "t.toml"
    path.write_text(
        '[sweep]\n"surface.stiffness" = [3e3, 1e5]\ncontroller = ["haptic", "stack"]\nseeds = 2\n', encoding="utf-8"
    )
    runs = study_of(str(path)).runs("t")
    assert len(runs) == 8
    wanted = itertools.product(("haptic", "stack"), (3e3, 1e5), (0, 1))
    assert {(run.controller, run.surface.stiffness, run.seed) for run in runs} == set(wanted)
    assert {run.variant for run in runs} == {"surface.stiffness 3000.0", "surface.stiffness 100000.0"}


def test_a_user_begins_a_task_runs_it_and_compares_controllers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for pattern in ("raster", "file", "hold"):
        done = CLI.invoke(app, ["new", "task", pattern, "-o", f"{pattern}.toml"])
        assert done.exit_code == 0, done.output
        study_of(f"{pattern}.toml")
    assert CLI.invoke(app, ["new", "task", "raster", "-o", "raster.toml"]).exit_code == 2  # nothing is overwritten
    sets = ["--set", "path.time=0.2", "--set", "phases.stand_off=0.01", "--set", "phases.press=0.1"]
    sets += ["--set", "phases.release=0.05", "--set", "phases.leave=0.1", "--set", "surface.pose.xyz=[0.55,0.0,0.1]"]
    done = CLI.invoke(
        app, ["compare", "hold.toml", "--controllers", "offset-free-mpc,haptic", "--seeds", "1", "--out", "o", *sets]
    )
    assert done.exit_code == 0, done.output
    cases = json.loads((tmp_path / "o" / "summary.json").read_text())["cases"]
    assert [case["controller"] for case in cases] == ["offset-free-mpc", "haptic"]
    assert all(case["failed"] == 0 for case in cases)
    for figure in ("compare_force_error.png", "compare_path_error.png"):
        assert (tmp_path / "o" / figure).stat().st_size > 10_000


def test_a_task_is_checked_before_it_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    short = ["--set", "path.pattern=hold", "--set", "path.time=1.0"]
    done = CLI.invoke(app, ["task", "check", "wipe", *short])
    assert done.exit_code == 0, done.output
    assert "possible as believed and in 10 random worlds" in done.output
    assert list(tmp_path.rglob("wipe_check.png"))
    assert "drawn 1" not in done.output  # of those that are possible, the believed surface alone is printed
    refused = CLI.invoke(app, ["task", "check", "wipe", *short, "--set", "force.normal=900"])
    assert refused.exit_code == 2, refused.output
    assert "lower force.normal or raise limits.force" in refused.output
    allowed = ["--set", "force.normal=900", "--set", "limits.force=1000"]
    heavy = CLI.invoke(app, ["task", "check", "wipe", *short, *allowed])
    assert heavy.exit_code == 1, heavy.output
    assert "not possible as believed" in heavy.output
    assert CLI.invoke(app, ["task", "check"]).exit_code == 2
    assert CLI.invoke(app, ["task", "check", "stack"]).exit_code == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "wype"], "no study or task named 'wype'"),
        (["new", "task", "zigzag"], "no pattern 'zigzag'"),
        (["new", "robot", "x"], "no template 'robot'"),
        (["compare", "wipe", "--controllers", ","], "at least one name"),
        (["compare", "wipe", "--controllers", "nobody"], "nobody"),
        (["run", "wipe", "--set", "accept.beauty=1"], "accept: there is no metric 'beauty'"),
        (["run", "wipe", "--set", "surface.pose.xyz=[3,0,0]"], "cannot reach"),
    ],
)
def test_bad_input_is_a_sentence(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = CLI.invoke(app, arguments)
    assert done.exit_code == 2, done.output
    assert message in done.output


@pytest.mark.study
def test_the_force_follows_the_normal_that_is_felt(tmp_path: Path) -> None:
    """A surface 4° off, friction 0.25: after one line and its turn the felt normal is within 1°, and what follows
    presses better than along the believed one."""
    study = study_of("wipe")
    changes = {
        "truth": {"tilt": 4.0, "axis": (1.0, 1.0, 0.0), "shift": 0.003, "friction": 0.25},
        "path": {"size": (0.06, 0.02), "speed": 0.08},
        "force": {"normal": 20.0},
    }
    errors = dict[str, float]()
    for along in ("believed", "estimated"):
        case = merged(merged(study.case("wipe"), changes), {"force": {"along": along}})
        result = run_case(study, case, output_folder(tmp_path / along), figures=False)
        assert result.failure is None
        assert result.log is not None
        log = Log.open(result.log)
        time, wrench = log.time("truth/tool/wrench"), log["truth/tool/wrench"][:, :3]
        made = planned(case)
        true = true_surface(case, made.surface, made.path).geometry.normal(log["truth/tool/position"][-1])
        ends = {name: start for start, name in log.phases()}
        late = (time > 0.5 * (ends["follow"] + ends["release"])) & (time < ends["release"])
        errors[along] = float(np.abs(wrench[late] @ true - 20.0).mean())
        if along == "estimated":
            felt = log["estimate/tool/surface/normal"][-1]
            assert math.degrees(math.acos(float(felt @ true))) < 1.0
            assert math.degrees(float(log["estimate/tool/surface/normal_std"][-1])) < 1.5
            pushes = wrench[late] / np.linalg.norm(wrench[late], axis=1, keepdims=True)
            assert np.median(np.degrees(np.arccos(pushes @ true))) > 10.0  # what the force's direction would say
    assert errors["estimated"] < errors["believed"], errors
