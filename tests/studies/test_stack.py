"""The stack study in a reduced form: shorter runs, fewer seeds, the same targets, with baselines that must fail."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from pliant import loop
from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.base import Result
from pliant.experiments.summarise import summarised
from pliant.references.postures.posture import UnreachableError
from pliant.studies.stack import STUDY
from pliant.studies.stack import from_task as cases_of_files
from pliant.studies.stack.build import build
from pliant.studies.stack.cases import CASES
from pliant.studies.stack.config import StackCaseConfig
from pliant.studies.stack.from_task import from_task, targets_of
from pliant.studies.stack.measure import tracking_rmse
from pliant.tasks import load_task
from pliant.tasks.draws import Uniform
from pliant.tasks.phase import Track
from pliant.telemetry import Log, Metric, Recorder

pytestmark = pytest.mark.study
SHORT = {"duration": 6.0, "path": {"ramp": 1.0}}  # one round of the figure-8 counts


@cache
def run(case: str, changes: tuple[tuple[str, Any], ...] = ()) -> tuple[StackCaseConfig, Log, loop.Outcome]:
    config = merged(STUDY.case(case), SHORT)
    for key, value in changes:
        config = merged(config, {key: value})
    wired = build(config)
    recorder = Recorder(None, channels=wired.channels)
    ticks = range(round(config.duration / config.period))
    outcome = loop.run(wired.plant, wired.estimator, wired.source, wired.controller, ticks, [recorder])
    return config, recorder.log(), outcome


def metrics_of(case: str, **changes: Any) -> dict[str, Metric]:
    config, log, outcome = run(case, tuple(changes.items()))
    assert outcome.failure is None
    return {metric.name: metric for metric in STUDY.judged(config, log)}


def test_cases_are_the_task_files(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a file changes is changed in its case; parameters that have no name are refused."""
    task = load_task("figure8-hardware", "figure8-pushed")
    path = task.phase[0].tracks["flange"]
    assert isinstance(path, Track)
    monkeypatch.setattr(cases_of_files, "load_task", lambda file, case: task)
    assert from_task("figure8-hardware", "figure8-pushed") == STUDY.case("figure8-pushed")
    slower = task.phase[0].model_copy(update={"tracks": {"flange": path.model_copy(update={"period": 5.0})}})
    pushes = task.disturbance[0].model_copy(update={"push": Uniform(uniform=(1.0, 2.0)), "frame": "flange"})
    changes = {"phase": (slower,), "disturbance": (pushes,), "compensates": "gravity", "accept": {"rmse_z": 7.0}}
    task = task.model_copy(update=changes)
    found = from_task("figure8-hardware", "figure8-pushed")
    assert found.pushes is not None
    assert (found.path.period, found.pushes.frame, found.pushes.force) == (5.0, "flange", (1.0, 2.0))
    assert (found.joints.compensation, targets_of("figure8-hardware")) == ("gravity", {"RMSE z": 7.0})
    odd = {"stack": {"tasks": {"ee": {"translation": {"stiffness": 1234.0}}}}}
    task = task.model_copy(update={"control": odd})
    with pytest.raises(ConfigError, match="those of no preset: stiff, soft"):
        from_task("figure8-hardware")


@pytest.mark.parametrize("case", ["figure8-plain", "figure8-gazebo", "figure8-hardware", "line-hardware"])
def test_tracking_reaches_its_targets(case: str) -> None:
    found = metrics_of(case)
    assert all(found[f"RMSE {axis}"].met for axis in "xyz")
    assert all(metric.met is not False for metric in found.values())


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("case", ["figure8-pushed", "line-pushed"])
def test_pushes_at_the_elbow_hardly_reach_the_tool(case: str, seed: int) -> None:
    found = metrics_of(case, seed=seed)
    for axis in "xyz":
        target = found[f"RMSE {axis}"].target
        assert target is not None
        assert found[f"RMSE {axis}"].value <= 1.3 * target  # the target is on the mean over ten seeds


def test_a_wall_disturbs_only_the_axis_that_it_stops() -> None:
    """Two runs and a metric of both: nothing that measures a run simulates another one."""
    free = {"wall": None, "variant": "no wall"}
    pair = [Result(config, STUDY.judged(config, log)) for config, log, _ in (run("figure8-wall"), _without_wall(free))]
    assert "RMSE y: change by the wall" not in {metric.name for metric in pair[0].metrics}
    walled, alone = summarised(STUDY, pair).cases
    found, without = ({metric.name: metric for metric in row.metrics} for row in (walled, alone))
    assert found["RMSE x"].value > 2.0 * without["RMSE x"].value
    for axis in "yz":
        change = found[f"RMSE {axis}: change by the wall"]
        assert change.value == abs(found[f"RMSE {axis}"].value - without[f"RMSE {axis}"].value)
        assert (change.target, change.met, change.runs) == (0.5, True, 1)
        assert change.name not in without
    assert found["torque step"].met


def _without_wall(changes: dict[str, Any]) -> tuple[StackCaseConfig, Log, loop.Outcome]:
    return run("figure8-wall", tuple(changes.items()))


def test_without_damping_the_capped_law_comes_to_rest_and_the_spring_does_not() -> None:
    whole = ("duration", 10.0)  # s, the pushes end at 6 s
    _, log, _ = run("rest-plain", (whole,))
    speed = np.abs(log["truth/v"][-500:]).max()
    _, spring, outcome = run("rest-plain", (whole, ("controller", "spring")))
    assert speed < 0.01
    assert outcome.failure is not None or np.abs(spring["truth/v"][-500:]).max() > 1.0


def test_the_printed_law_does_not_track() -> None:
    printed = metrics_of("figure8-plain", controller="stack-paper")
    ours = metrics_of("figure8-plain")
    assert printed["RMSE z"].value > 10.0 * ours["RMSE z"].value
    assert printed["torque variation"].value > 10.0 * ours["torque variation"].value


def test_the_spring_makes_energy_and_the_capped_law_does_not() -> None:
    name = "storage margin of translation"
    assert metrics_of("figure8-plain")[name].value >= -0.05
    assert metrics_of("figure8-plain", controller="spring")[name].value < -1.0


def test_any_gains_may_change_while_it_moves() -> None:
    found = metrics_of("calibration", seed=3)
    assert found["|h| over F_max"].value <= 1.0 + 1e-12
    assert found["RMSE x"].value < 50.0  # it keeps tracking, worse with the softer gains
    assert found["torque step"].value <= 15.0


def test_changed_gains_leave_no_debt_that_weakens_an_axis() -> None:
    """What the account could not pay of a change stayed owed: the axis went limp, and the moving target filled it."""
    found = metrics_of("calibration", seed=0)
    assert found["storage margin of translation"].value >= -0.05  # J
    assert found["RMSE y"].value < 6.0  # mm


def test_a_straight_elbow_is_no_singularity() -> None:
    found = metrics_of("singular")
    assert found["torque step"].value <= 15.0
    assert found["peak torque"].value < 100.0


def test_half_the_physics_step_changes_the_metrics_by_less_than_two_percent() -> None:
    coarse = tracking_rmse(*run("figure8-plain")[:2])
    fine = tracking_rmse(*run("figure8-plain", (("physics_step", 2.5e-4),))[:2])
    np.testing.assert_allclose(fine, coarse, rtol=0.02, atol=0.005)  # mm


def test_the_balance_case_changes_the_elbow_and_with_it_the_tool() -> None:
    runs = [config for config in STUDY.runs("balance") if config.variant in ("elbow-0N", "elbow-100N")]
    errors: list[float] = []
    for config in runs:
        wired = build(merged(config, SHORT))
        recorder = Recorder(None)
        loop.run(wired.plant, wired.estimator, wired.source, wired.controller, range(6000), [recorder])
        errors.append(float(np.linalg.norm(tracking_rmse(merged(config, SHORT), recorder.log()))))
    assert errors[0] != pytest.approx(errors[1], rel=1e-3)


def test_aico_is_a_second_way_to_the_posture() -> None:
    config = merged(STUDY.case("figure8-plain"), SHORT | {"path": {"method": "aico", "ramp": 1.0}})
    assert build(config).source.path.worst_distance < 1e-3  # type: ignore[attr-defined]


def test_every_run_of_the_study_can_be_wired() -> None:
    runs = [config for case in CASES for config in STUDY.runs(case)]
    assert len(runs) > 80
    assert sum(config.case == "figure8-pushed" and config.controller == "stack" for config in runs) >= 10
    assert len({config.model_dump_json() for config in runs}) == len(runs)


@pytest.mark.parametrize(
    ("changes", "error", "words"),
    [
        ({"control": {"tasks": {"elbow": None}}}, ConfigError, "two frames"),
        ({"controller": "operational-space", "retuning": {}}, ConfigError, "can be retuned"),
        ({"path": {"kind": "line", "amplitude": 1.5}}, UnreachableError, "cannot reach"),
        ({"path": {"peak_speed": 9.0, "kind": "line"}}, UnreachableError, "in time"),
        ({"preset": "medium"}, ConfigError, "preset"),
    ],
)
def test_what_the_study_refuses(changes: dict[str, Any], error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        build(merged(STUDY.case("figure8-plain"), changes))
