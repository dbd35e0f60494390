"""Figures: drawn without a display and without matplotlib's global state, nothing lost, the same bytes twice."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from pliant.errors import OutputError, ShapeError
from pliant.telemetry import Metric, Recorder, RunInfo
from pliant.telemetry.plots import (
    Curve,
    Panel,
    Path2D,
    attractor,
    compare,
    energy_ledger,
    joint_torques,
    phase_portrait,
    plot_log,
    posture_difference,
    save,
    sweep,
    task_path,
    time_series,
)
from pliant.telemetry.plots.series import thin
from tests.telemetry.ticks import JOINTS, make_tick

TIME = np.arange(0.0, 2.0, 0.01)  # s
WAVES = np.sin(np.outer(TIME, np.arange(1.0, 8.0)))  # (200, 7)
LOOP = np.stack((np.cos(TIME), np.zeros_like(TIME), np.sin(TIME)), axis=1)


def all_figures() -> dict[str, Figure]:
    broken = WAVES.copy()
    broken[150:] = np.nan  # a run that failed on the way
    return {
        "series": time_series(
            [Panel("force, N", [Curve("a", TIME, broken[:, 0]), Curve("r", TIME, WAVES[:, 1], "reference")])], "t"
        ),
        "path": task_path([Path2D("a", LOOP), Path2D("b", broken[:, :3])], LOOP, wall=0.5),
        "path_by_error": task_path([Path2D("a", 1.01 * LOOP)], LOOP, by_error=True),
        "posture": posture_difference(TIME, WAVES, broken, JOINTS),
        "torques": joint_torques(TIME, 30.0 * broken, np.full(7, 31.0), JOINTS, phases=[(0.0, "a"), (1.0, "b")]),
        "energy": energy_ledger(TIME, {"stored": WAVES[:, 0]}, WAVES[:, 1]),
        "attractor": attractor(TIME, {"F": TIME}, {"E": TIME**2}, {"x": [(LOOP[:, 0], LOOP[:, 2])]}),
        "portrait": phase_portrait([(LOOP[:, 0], LOOP[:, 2])]),
        "compare": compare(
            {"a": [Metric("m", 1.0, "N", 2.0, 0.5, std=0.1)], "b": [Metric("m", float("nan"), "N")]}, "E, N"
        ),
        "sweep": sweep(
            np.arange(1.0, 4.0),
            {"a": np.array([[1.0, 2.0], [2.0, np.nan], [np.nan, np.nan]])},
            "x, s",
            "y, N",
            target=1.0,
        ),
    }


def test_every_figure_is_a_png_with_labelled_axes(tmp_path: Path) -> None:
    for name, made in all_figures().items():
        data = save(made, tmp_path / "a.png").read_bytes()
        assert data.startswith(b"\x89PNG"), name
        shown = [ax for ax in made.axes if ax.get_visible() and ax.has_data()]
        assert shown, name
        assert any("," in ax.get_ylabel() for ax in shown), name  # quantity, unit


def test_the_same_figure_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in "ab":
        save(phase_portrait([(LOOP[:, 0], LOOP[:, 2])]), tmp_path / f"{name}.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_a_figure_that_is_drawn_once_has_the_pixels_of_one_that_matplotlib_saves(tmp_path: Path) -> None:
    """`savefig` draws twice: the first time to place everything, which the second one does too."""
    for name in ("one", "saved"):
        made = phase_portrait([(LOOP[:, 0], LOOP[:, 2])])
        if name == "one":
            save(made, tmp_path / "one.png")
        else:
            made.savefig(tmp_path / "saved.png")
    one, saved = (Image.open(tmp_path / f"{name}.png") for name in ("one", "saved"))
    assert one.mode == "RGB"
    assert one.info["dpi"] == saved.info["dpi"]
    assert np.asarray(saved)[:, :, 3].min() == 255  # opaque: nothing is lost without the fourth
    assert np.array_equal(np.asarray(one), np.asarray(saved)[:, :, :3])
    assert np.ptp(np.asarray(one)) > 100  # there is something to compare


def test_no_global_state_of_matplotlib_is_touched() -> None:
    code = (
        "import sys, numpy as np, matplotlib\nbefore = matplotlib.rcParams.copy()\n"
        "from pliant.telemetry.plots import *\nposture_difference(np.arange(3.0), np.eye(3), np.eye(3))\n"
        "assert 'matplotlib.pyplot' not in sys.modules\nassert matplotlib.rcParams.copy() == before\n"
    )
    environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True, env=environment, timeout=120)


def test_fewer_points_keep_every_spike() -> None:
    time = np.arange(100_001) * 1e-3
    value = np.zeros_like(time)
    value[12_345], value[77_777], value[-1] = 5.0, -7.0, 3.0
    few_time, few = thin(time, value)
    assert few.size <= 4100
    assert (few.max(), few.min(), few[-1]) == (5.0, -7.0, 3.0)
    assert few_time[np.argmax(few)] == time[12_345]
    assert np.all(np.diff(few_time) > 0.0)
    assert not np.any(value[:: time.size // 4000] == 5.0)  # every 25th point alone would have lost it


def test_a_path_by_error_needs_one_path_as_long_as_its_reference() -> None:
    with pytest.raises(ShapeError):
        task_path([Path2D("a", LOOP), Path2D("b", LOOP)], LOOP, by_error=True)
    with pytest.raises(ShapeError):
        task_path([Path2D("a", LOOP[:-1])], LOOP, by_error=True)


def test_a_log_draws_itself(tmp_path: Path) -> None:
    with Recorder(None, RunInfo("stack", "figure8", joints=JOINTS)) as recorder:
        for k in range(60):
            recorder(make_tick(k))
    written = plot_log(recorder.log(), tmp_path / "figures")
    names = {path.stem for path in written}
    assert {"tool_error", "tool_path", "tool_force", "torques", "posture", "energy"} <= names
    assert all(path.stat().st_size > 5000 for path in written)


def test_an_empty_log_draws_nothing(tmp_path: Path) -> None:
    with Recorder(None) as recorder:
        pass
    assert plot_log(recorder.log(), tmp_path) == []


def test_a_figure_that_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="cannot be written"):
        save(phase_portrait([]), tmp_path / "nowhere" / "a.png")
