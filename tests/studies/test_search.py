"""The search over a controller's parameters, on a study whose minimum is known."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from pliant.cli import tune
from pliant.dotted import nested
from pliant.errors import ConfigError
from pliant.experiments.parameter_search import PENALTY, ParameterSearch, Range
from pliant.experiments.registry import get_study
from pliant.experiments.search import Trial, find_search, search
from tests.studies import toy
from tests.studies.commands import study


def test_the_search_finds_the_minimum_and_begins_at_the_start() -> None:
    assert get_study("toy") is toy.STUDY
    made = list(search("toy", toy.STUDY.search("idle"), 64, seed=1))
    assert dict(made[0].values) == {"gains.a": 1.0, "gains.b": 5.0}
    best = min(made, key=lambda trial: trial.objective)
    assert made[0].objective == pytest.approx(10.1)
    assert best.objective < 0.6  # of 0.1 at a = 0.1, b = 2


def test_failed_runs_and_impossible_values_cost_a_finite_penalty() -> None:
    sought = toy.STUDY.search("idle")
    failing = ParameterSearch(sought.parameters, [toy.STUDY.case("physics")], sought.objective, sought.start)
    (trial,) = search("toy", failing, 1)
    assert (trial.objective, trial.failed) == (PENALTY, 1)
    assert trial.failure is not None


def test_mistakes_in_a_tuning_are_sentences() -> None:
    with pytest.raises(ConfigError, match="low above 0"):
        Range(0.0, 1.0, log=True)
    with pytest.raises(ConfigError, match=r"no controller 'idel'.*did you mean 'idle'"):
        find_search(toy.STUDY, "idel")
    with pytest.raises(ConfigError, match="cannot be tuned"):
        find_search(toy.STUDY, "other")
    assert nested({"a.b": 1.0, "a.c": 2.0}) == {"a": {"b": 1.0, "c": 2.0}}


@pytest.mark.study
def test_the_command_writes_the_same_trials_on_one_process_and_on_two(tmp_path: Path) -> None:
    tables = []
    for jobs in (1, 2):
        folder = tmp_path / str(jobs)
        code, out, errors = study("toy", "--tune", "idle", "--trials", 8, "--jobs", jobs, "--out", folder)
        assert code == 0, errors
        assert "gains.a" in out
        tables.append(pq.read_table(folder / "trials.parquet"))
        tuned = tomllib.loads((folder / "tuned.toml").read_text())
        assert (tuned["study"], tuned["controller"]) == ("toy", "idle")
        assert set(tuned["gains"]) == {"a", "b"}
        assert (folder / "trials.png").stat().st_size > 10_000
    assert tables[0].equals(tables[1])
    code, _, errors = study("toy", "--tune", "nobody", "--out", tmp_path)
    assert code == 2
    assert "valid: 'idle', 'other'" in errors


@pytest.mark.parametrize("trials", [1, 10])
def test_as_many_trials_are_made_as_asked_for(trials: int) -> None:
    assert len(list(search("toy", toy.STUDY.search("idle"), trials, seed=1))) == trials


def test_the_table_of_a_search_has_the_start_beside_the_best() -> None:
    sought = toy.STUDY.search("idle")
    values = ({"gains.a": 1.0, "gains.b": 5.0}, {"gains.a": 0.1, "gains.b": 2.0}, {"gains.a": 9.0, "gains.b": 9.0})
    made = [Trial(i, values[i], objective, 0) for i, objective in enumerate((10.1, 0.1, 55.0))]
    table = tune._start_and_best(sought, made, made[1], {"study": "toy", "controller": "idle"})
    columns = [list(column.cells) for column in table.columns]
    assert columns[0] == ["gains.a", "gains.b", "objective"]
    assert columns[1] == ["1.00", "5.00", "10.1"]
    assert columns[2] == ["0.100", "2.00", "0.100"]


def test_what_only_got_the_penalty_is_drawn_as_failed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sought = toy.STUDY.search("idle")
    seen: list[np.ndarray] = []
    monkeypatch.setattr("pliant.telemetry.plots.trials", lambda judged, *_: seen.append(judged))
    monkeypatch.setattr("pliant.telemetry.plots.save", lambda figure, path: path)
    start = dict(sought.start)
    made = [Trial(0, start, 2.0, 0), Trial(1, start, PENALTY, 0), Trial(2, start, 3.0, 1)]
    tune._draw(sought, made, {"study": "toy", "controller": "idle"}, tmp_path / "x.png")
    np.testing.assert_array_equal(seen[0], [2.0, np.nan, np.nan])


def test_changes_under_dots_and_in_tables_are_one_tree() -> None:
    assert nested({"a.b": 1, "a": {"c": 2, "d.e": 3}}) == {"a": {"b": 1, "c": 2, "d.e": 3}}
    assert nested({"a": {"c": 2}, "a.b": 1}) == {"a": {"c": 2, "b": 1}}
    for twice in ({"a.b": 1, "a": {"b": 2}}, {"a": 1, "a.b": 2}, {"a.b": 1, "a": 2}):
        with pytest.raises(ConfigError, match="given"):
            nested(twice)
