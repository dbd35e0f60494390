"""The file of a sweep: what goes in comes out, and what is not such a file is refused."""

from __future__ import annotations

import json
import math
import random
import re
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from pliant.cli.study import resume_command
from pliant.errors import PliantError
from pliant.experiments import parquet
from pliant.experiments.parquet import read_parquet, write_parquet
from pliant.experiments.results import FILE, Request, ResultStore, read_results
from pliant.experiments.sweep import asked_runs, sweep
from tests.studies import toy

REQUEST = Request("toy", ("fine", "physics"), 2, ("gains.a=0.3",))


def _written(folder: Path) -> ResultStore:
    asked = asked_runs(REQUEST)
    store = ResultStore(folder, REQUEST, asked)
    store.begin()
    for run in sweep("toy", asked):
        store.add(run)
    return store


def test_runs_come_back_bit_for_bit(tmp_path: Path) -> None:
    store = _written(tmp_path)
    request, runs = read_results(tmp_path)
    assert request == REQUEST
    assert [repr(run) for run in runs] == [repr(run) for run in store.runs]  # repr: NaN is not equal to itself
    assert math.isnan(runs[0].result.metrics[1].value)
    assert type(runs[0].result.config) is toy.ToyConfig


def test_a_row_has_the_value_of_each_metric_once(tmp_path: Path) -> None:
    _written(tmp_path)
    (row, *_) = pq.read_table(tmp_path / FILE).to_pylist()
    assert {"E_λ [N]", "never [s]", "seed [1]"} <= set(row)
    about = json.loads(row["result"])["metrics"]
    assert [metric["value"] for metric in about] == ["E_λ [N]", "never [s]", "seed [1]"]  # names of columns
    assert about[0]["target"] == 0.1 * 3
    assert repr(row["E_λ [N]"]) not in row["result"]


def test_a_run_is_in_the_file_as_soon_as_it_was_added(tmp_path: Path) -> None:
    asked = asked_runs(REQUEST)
    store = ResultStore(tmp_path, REQUEST, asked)
    store.begin()
    for number, run in enumerate(sweep("toy", asked)):
        assert len(read_results(tmp_path)[1]) == number
        store.add(run)


def test_a_study_started_anew_keeps_what_an_earlier_one_found(tmp_path: Path) -> None:
    rows = len(_written(tmp_path).runs)
    for _ in range(2):  # the second time the file is empty: it does not push the first one out
        ResultStore(tmp_path, REQUEST, asked_runs(REQUEST)).begin()
    assert pq.read_table(tmp_path / FILE).num_rows == 0
    assert pq.read_table(tmp_path / f"{FILE}.old").num_rows == rows > 0


def _refused(folder: Path, study: str | None = None) -> str:
    with pytest.raises(PliantError) as caught:
        resume_command(None, None, folder, study, 1, None)  # type: ignore[arg-type]
    return str(caught.value)


def test_what_cannot_be_resumed_is_refused_in_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert "is not a folder" in _refused(tmp_path / "none")
    assert "cannot be read" in _refused(tmp_path)
    _written(tmp_path)
    assert "holds results of study 'toy', not of 'stack'" in _refused(tmp_path, "stack")
    whole = (tmp_path / FILE).read_bytes()
    for damaged in (whole[: len(whole) // 2], b"", b"PAR1" + bytes(50) + whole[54:]):
        (tmp_path / FILE).write_bytes(damaged)
        assert re.search(r"is not a whole Parquet file|does not hold the results", _refused(tmp_path))
    pq.write_table(pa.table({"x": [1]}), tmp_path / FILE)
    assert "not one of pliant's" in _refused(tmp_path)
    monkeypatch.setattr(parquet, "__version__", "0.0.9")
    _written(tmp_path)
    assert re.search(r"written by pliant 0\.0\.9, this is pliant \d", _refused(tmp_path))


def test_a_flipped_bit_or_a_cut_is_a_sentence_or_changes_nothing(tmp_path: Path) -> None:
    _written(tmp_path)
    whole, draw = (tmp_path / FILE).read_bytes(), random.Random(7)
    before = repr(read_results(tmp_path))
    refused: list[str] = []
    for number in range(300):
        damaged = bytearray(whole)
        if number % 3:
            damaged[draw.randrange(len(whole))] ^= 1 << draw.randrange(8)
        else:
            del damaged[draw.randrange(len(whole)) :]
        (tmp_path / FILE).write_bytes(damaged)
        try:
            assert repr(read_results(tmp_path)) == before
        except PliantError as error:
            refused.append(str(error))
    assert len(refused) > 150  # the others changed nothing: a flipped statistic of a column, say
    assert all(len(text.splitlines()) == 1 for text in refused)


EDITS = {
    "status": "done",
    "failure": "it fell over, says who",
    "seed": 99,
    "case": "physics",
    "configuration": "{}",
    "result": "[]",
    "warnings": None,
    "wall [s]": None,
}


@pytest.mark.parametrize("column", EDITS)
def test_an_edited_row_is_refused_in_a_sentence(column: str, tmp_path: Path) -> None:
    _written(tmp_path)
    table, about = read_parquet(tmp_path / FILE)
    edited = table.to_pylist()
    edited[0][column] = EDITS[column]
    changed = pa.Table.from_pylist(edited, table.schema)
    pq.write_table(changed, tmp_path / FILE)
    assert "was changed after pliant wrote it" in _refused(tmp_path)
    for odd in (changed, table.drop([column])):  # whoever counts the digest anew does not get further
        write_parquet(tmp_path / FILE, odd, about)
        assert "does not hold the results of a study" in _refused(tmp_path)


def test_a_number_changed_with_care_is_noticed(tmp_path: Path) -> None:
    _written(tmp_path)
    table = pq.read_table(tmp_path / FILE)
    edited = table.to_pylist()
    edited[0]["E_λ [N]"] += 1e-3
    pq.write_table(pa.Table.from_pylist(edited, table.schema), tmp_path / FILE)
    assert "was changed after pliant wrote it" in _refused(tmp_path)


@pytest.mark.parametrize(
    "change", [{"study": 1}, {"cases": 5}, {"seeds": "many"}, {"assignments": [3]}, {"logs": None}]
)
def test_an_edited_request_is_refused_in_a_sentence(change: dict[str, object], tmp_path: Path) -> None:
    _written(tmp_path)
    table, about = read_parquet(tmp_path / FILE)
    write_parquet(tmp_path / FILE, table, about | change)
    assert "does not hold the results of a study" in _refused(tmp_path)
    write_parquet(tmp_path / FILE, table, about | {"seeds": 10**23})
    assert "seeds" in _refused(tmp_path)
