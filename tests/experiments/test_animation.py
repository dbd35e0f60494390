"""Animated pictures of logs: what is in them changes with the run, and what cannot be drawn is said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from pliant.errors import ConfigError, OutputError
from pliant.experiments.animation import animate
from pliant.experiments.drawn import drawn_log
from pliant.experiments.registry import get_study
from pliant.experiments.runner import run_case
from pliant.telemetry import Log, Recorder
from tests.telemetry.ticks import make_tick


def logged(study: str, folder: Path, **changes: object) -> Log:
    found = get_study(study)
    config = found.case(next(iter(found.cases))).model_copy(update={"duration": 0.8, **changes})
    result = run_case(found, config, folder, figures=False)
    assert result.log is not None
    return Log.open(result.log)


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Log:
    return logged("wipe", tmp_path_factory.mktemp("run"))


@pytest.mark.parametrize("ending", ["webp", "gif"])
def test_the_robot_moves_in_the_picture(log: Log, tmp_path: Path, ending: str) -> None:
    file = animate(log, tmp_path / f"run.{ending}", seconds=0.4, rate=10.0, width=160)
    with Image.open(file) as picture:
        assert (picture.n_frames, picture.size) == (4, (160, 120))
        shown: list[np.ndarray] = []
        for index in range(4):
            picture.seek(index)
            shown.append(np.asarray(picture.convert("L"), dtype=float))
    assert min((image < 200.0).mean() for image in shown) > 0.01  # something is there
    assert np.abs(shown[0] - shown[-1]).max() > 30.0


def test_the_scene_of_a_task_is_found_again(log: Log) -> None:
    """Of a task of the catalogue, too, whose name is not that of a study."""
    drawn, robot, scene = drawn_log(log)
    assert drawn.joints == robot.n
    assert scene is not None
    assert scene.things


def test_what_cannot_be_drawn_is_said(log: Log, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"ends in \.webp or \.gif"):
        animate(log, tmp_path / "run.mp4")
    for bad in ({"seconds": 1e9}, {"seconds": float("nan")}, {"seconds": 0.01}, {"width": 8}, {"rate": 100.0}):
        with pytest.raises(ConfigError, match="2 to 600 pictures"):
            animate(log, tmp_path / "run.gif", **bad)
    with pytest.raises(OutputError, match="cannot be written"):
        animate(log, tmp_path / "nowhere" / "run.gif", seconds=0.2, rate=10.0, width=64)
    with Recorder(None) as recorder:
        recorder(make_tick(0))
    with pytest.raises(OutputError, match="no motion"):
        animate(recorder.log(), tmp_path / "run.gif")
