"""Logs as LeRobot data sets: the documented layout v2.1, read with pyarrow and json alone."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from pliant.errors import ConfigError, MissingExtraError, OutputError
from pliant.telemetry import Log, Recorder, RunInfo
from pliant.telemetry.columns import data_frame
from pliant.telemetry.lerobot import export_lerobot
from tests.telemetry.ticks import JOINTS, make_tick

FPS = 50
LENGTHS = (451, 700)  # ticks of 1 ms: frames at 0, 20, …, 440 or 680 ms
FRAMES = (23, 35)


def logged(path: Path, ticks: int, case: str, joints: tuple[str, ...] = JOINTS, seed: int = 0) -> Path:
    with Recorder(path, RunInfo("stack", case, robot="lwr4", joints=joints)) as recorder:
        for k in range(ticks):
            recorder(make_tick(k, seed))
    return path


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("logs")
    return [logged(folder / f"{n}.mcap", n, case, seed=n) for n, case in zip(LENGTHS, ("one", "two"), strict=True)]


@pytest.fixture(scope="module")
def data_set(files: list[Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export_lerobot([Log.open(file) for file in files], tmp_path_factory.mktemp("set"), fps=FPS)


def lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def test_the_layout_is_that_of_v2_1(data_set: Path) -> None:
    info = json.loads((data_set / "meta/info.json").read_text(encoding="utf-8"))
    assert (info["codebase_version"], info["fps"], info["video_path"]) == ("v2.1", FPS, None)
    assert (info["total_episodes"], info["total_frames"], info["total_tasks"]) == (2, sum(FRAMES), 2)
    assert (info["total_chunks"], info["chunks_size"], info["total_videos"]) == (1, 1000, 0)
    assert info["splits"] == {"train": "0:2"}
    assert info["robot_type"] == "lwr4"
    assert lines(data_set / "meta/tasks.jsonl") == [
        {"task_index": 0, "task": "stack one"},
        {"task_index": 1, "task": "stack two"},
    ]
    assert lines(data_set / "meta/episodes.jsonl") == [
        {"episode_index": 0, "tasks": ["stack one"], "length": FRAMES[0]},
        {"episode_index": 1, "tasks": ["stack two"], "length": FRAMES[1]},
    ]
    here = sorted(str(file.relative_to(data_set)) for file in data_set.rglob("*") if file.is_file())
    asked = [info["data_path"].format(episode_chunk=0, episode_index=n) for n in (0, 1)]
    assert asked == [f"data/chunk-000/episode_{n:06d}.parquet" for n in (0, 1)]
    meta = ("episodes", "episodes_stats", "tasks")
    assert here == sorted([*asked, "meta/info.json", *(f"meta/{name}.jsonl" for name in meta)])


def test_every_column_is_the_feature_that_it_says(data_set: Path) -> None:
    features = json.loads((data_set / "meta/info.json").read_text(encoding="utf-8"))["features"]
    table = pq.read_table(data_set / "data/chunk-000/episode_000000.parquet")
    assert set(table.column_names) == set(features)
    assert not [name for name in features if "/" in name]  # LeRobot refuses such names
    for name, about in features.items():
        scalar = {"float32": pa.float32(), "int64": pa.int64()}[about["dtype"]]
        (size,) = about["shape"]
        assert table.schema.field(name).type == (scalar if size == 1 else pa.list_(scalar, size))
        assert about["names"] is None or len(about["names"]) == size
    assert features["action"]["names"][2] == f"command/torque {JOINTS[2]} [N·m]"


def test_numbers_and_counters_are_those_of_the_log(files: list[Path], data_set: Path) -> None:
    first = 0
    for number, file in enumerate(files):
        log = Log.open(file)
        table = pq.read_table(data_set / f"data/chunk-000/episode_{number:06d}.parquet").to_pydict()
        count = FRAMES[number]
        rows = np.arange(count) * 20  # ticks of 1 ms, frames of 20
        state = np.hstack([log[f"measurement/{name}"][rows] for name in ("q", "v", "torque")])
        np.testing.assert_array_equal(np.array(table["observation.state"]), state.astype(np.float32))
        np.testing.assert_array_equal(np.array(table["action"]), log["command/torque"][rows].astype(np.float32))
        wrench = log["measurement/tool/wrench"][rows].astype(np.float32)
        np.testing.assert_array_equal(np.array(table["observation.wrench"]), wrench)
        # LeRobot compares neighbouring stamps with 1/fps, to 0.1 ms
        np.testing.assert_allclose(np.diff(table["timestamp"]), 1.0 / FPS, atol=1e-5)
        assert table["frame_index"] == list(range(count))
        assert table["index"] == list(range(first, first + count))
        assert set(table["episode_index"]) == {number}
        assert set(table["task_index"]) == {number}
        first += count


def test_the_statistics_are_those_of_the_columns(data_set: Path) -> None:
    for row in lines(data_set / "meta/episodes_stats.jsonl"):
        table = pq.read_table(data_set / f"data/chunk-000/episode_{row['episode_index']:06d}.parquet").to_pydict()
        assert set(row["stats"]) == set(table)
        for name, stats in row["stats"].items():
            values = np.array(table[name], dtype=float).reshape(len(table[name]), -1)
            assert stats["count"] == [len(values)]
            for key, law in (("min", np.min), ("max", np.max), ("mean", np.mean), ("std", np.std)):
                np.testing.assert_allclose(stats[key], law(values, axis=0), rtol=1e-5, atol=1e-6)


def test_bad_input_is_one_sentence_and_leaves_nothing(files: list[Path], tmp_path: Path) -> None:
    log = Log.open(files[0])
    other = Log.open(logged(tmp_path / "other.mcap", 30, "one", tuple(f"other_{i}" for i in range(7))))
    for logs, options, words in (
        ([], {}, "one log at least"),
        ([log, other], {}, "other joints, sensors or actions"),
        ([log], {"fps": 1200}, "from 1 to the rate"),
        ([log], {"fps": 0}, "from 1 to the rate"),
        ([log], {"action": ("command/tork",)}, "did you mean"),
        ([log], {"action": ()}, "an action needs"),
    ):
        with pytest.raises(ConfigError, match=words):
            export_lerobot(logs, tmp_path / "new", **options)
        assert not (tmp_path / "new").exists()
    with pytest.raises(OutputError, match="not empty"):
        export_lerobot([log], tmp_path)


def test_the_command_as_a_user_calls_it(
    files: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from pliant.cli import main

    def run_in_process(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["pliant", *words])
        try:
            code = main() or 0
        except SystemExit as ended:
            code = int(ended.code or 0)
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    made = tmp_path / "set"
    chosen = ("--action", "reference/tool/position,reference/tool/wrench", "--fps", "25")
    code, out, err = run_in_process("log", "export", *map(str, files), "--lerobot", str(made), *chosen)
    assert (code, err) == (0, "")
    assert "2 episodes" in out
    table = pq.read_table(made / "data/chunk-000/episode_000001.parquet")
    assert (table.num_rows, table.schema.field("action").type.list_size) == (18, 9)
    for words, why in (
        (("log", "export", str(files[0])), "--lerobot DIR"),
        (("log", "export", "--lerobot", str(tmp_path / "x")), "one log at least"),
        (("log", str(files[0]), "--fps", "3"), "--fps belongs to pliant log export"),
        (("log", str(files[0]), str(files[1])), "takes one file"),
    ):
        code, _, err = run_in_process(*words)
        assert (code, err.count("\n")) == (2, 1)
        assert why in err


def test_a_package_that_is_not_there_is_named() -> None:
    with pytest.raises(MissingExtraError, match="pip install no_such_frames"):
        data_frame("no_such_frames", {})
