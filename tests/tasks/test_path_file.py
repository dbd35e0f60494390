"""What a path file says beside places: how fast and how hard, and which of file and task counts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pliant.references.toolpaths.toolpath import Toolpath
from pliant.studies.task.config import TaskCase
from pliant.studies.task.geometry import laid_out
from pliant.studies.task.study import study_of
from pliant.studies.task.task_study import TaskStudy

PLACE = 'robot = "panda"\n[surface]\npose = { xyz = [0.48, 0.0, 0.35] }\n'
FILE = PLACE + '[path]\npattern = "file"\nfile = "path.csv"\n'


def case_from(folder: Path, csv: str, text: str = FILE) -> tuple[TaskStudy, TaskCase]:
    (folder / "path.csv").write_text(csv, encoding="utf-8")
    (folder / "task.toml").write_text(text, encoding="utf-8")
    study = study_of(str(folder / "task.toml"))
    return study, study.case("task")


def path_from(folder: Path, csv: str, text: str = FILE) -> Toolpath:
    _, case = case_from(folder, csv, text)
    return laid_out(case, case.robot)[2]


def test_a_force_of_a_file_stays_between_its_values(tmp_path: Path) -> None:
    """A force that fades to nothing does not pull on the way, as a cubic through the same rows would."""
    path = path_from(tmp_path, "x,y,force\n-0.04,0,15\n-0.01,0,0\n0.01,0,0\n0.04,0,15\n")
    assert path.force is not None
    forces = np.array([path.force.at(time).value[0] for time in np.linspace(0.0, path.duration, 5001).tolist()])
    assert forces.min() == 0.0
    assert forces.max() == pytest.approx(15.0, abs=1e-9)


@pytest.mark.parametrize(
    ("csv", "sentence"),
    [
        ("x,y\n-0.04,0\n0.04,0\n", ""),
        ("x,y,speed\n-0.04,0,0.04\n0.04,0,0.04\n", "the speeds in path.csv say how fast, not path.speed"),
        ("x,y,time\n-0.04,0,0\n0.04,0,2\n", "the times in path.csv say how fast, not path.speed: they ask for 2 s"),
        ("x,y,time\n-0.04,0,0\n0.04,0,0.001\n", "they ask for 0.001 s, and the path takes 0.8 s"),
    ],
)
def test_it_is_said_whether_file_or_task_sets_the_pace(csv: str, sentence: str, tmp_path: Path) -> None:
    study, case = case_from(tmp_path, csv, FILE + "speed = 0.2\n")
    told = study.about(case).get("pace", "")
    assert sentence in told
    assert bool(told) == bool(sentence)
    warned = any("path.acceleration = 0.5" in warning for warning in study.build(case).warnings)
    assert warned == ("0.001" in csv)


def test_a_path_that_only_speeds_up_and_brakes_takes_the_time_that_its_acceleration_needs(tmp_path: Path) -> None:
    """80 mm at 0.5 m/s² take 2 sqrt(0.08 m / 0.5 m/s²) = 0.8 s from rest to rest, however little the file allows."""
    assert path_from(tmp_path, "x,y,time\n-0.04,0,0\n0.04,0,0.001\n").duration == pytest.approx(0.8, rel=0.01)


def test_a_path_over_a_ball_may_reach_to_its_side(tmp_path: Path) -> None:
    """1.5 rad from the top still faces up; what faces down is refused (`test_bad_files.py`)."""
    ball = PLACE.replace("[surface]\n", '[surface]\nshape = "sphere"\nradius = 0.05\n') + FILE[len(PLACE) :]
    normals = path_from(tmp_path, "x,y\n0,0\n0.075,0\n", ball).normals
    assert float(normals[0] @ normals[-1]) == pytest.approx(np.cos(1.5), abs=1e-3)


def test_the_line_of_a_place_is_that_of_the_stretch_on_which_it_lies(tmp_path: Path) -> None:
    path = path_from(tmp_path, "x,y\n-0.04,0\n0,0\n\n0.04,0.02\n")
    assert path.rows is not None
    assert path.rows.line_near(path.places[len(path.places) // 4]) == 3
    assert path.rows.line_near(path.places[-2]) == 5


def test_a_study_of_a_task_without_keys_to_sweep_says_so(tmp_path: Path) -> None:
    csv = "x,y\n-0.04,0\n0.04,0\n"
    study, case = case_from(tmp_path, csv, FILE + "[sweep]\nseeds = 2\n")
    assert study.note(case).startswith("task has no [sweep] of keys")
    study, case = case_from(tmp_path, csv, FILE + '[sweep]\n"path.speed" = [0.05, 0.1]\n')
    assert study.note(case) == ""
