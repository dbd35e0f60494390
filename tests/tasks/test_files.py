"""Task files: what they say, what they inherit, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.configuration import merged
from pliant.errors import ConfigError, PliantError
from pliant.studies.task.build import planned
from pliant.studies.task.config import case_of
from pliant.studies.task.study import study_of
from pliant.studies.task.world import true_surface
from pliant.tasks import load_task
from pliant.tasks.draws import Choice, Normal, Uniform, bounds, drawn
from pliant.tasks.files import catalogue, read_task


def written(folder: Path, text: str, name: str = "task.toml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_says_what_it_wants_and_leaves_the_rest_to_defaults(tmp_path: Path) -> None:
    task = load_task(written(tmp_path, 'robot = "panda"\n[path]\npattern = "circle"\nturns = 2\n'))
    assert (task.robot, task.path.pattern, task.path.turns) == ("panda", "circle", 2.0)
    assert task.surface.shape == "plane"


def test_a_file_inherits_and_its_variants_are_its_own(tmp_path: Path) -> None:
    written(tmp_path, "[surface]\nstiffness = 5e3\n[path]\nspeed = 0.02\n[variant.slow]\npath = { speed = 0.01 }\n")
    text = 'base = "task.toml"\n[path]\nspeed = 0.1\n[variant.fast]\npath = { speed = 0.2 }\n'
    path = written(tmp_path, text, "b.toml")
    assert (load_task(path).surface.stiffness, load_task(path).path.speed) == (5e3, 0.1)
    assert load_task(path, "fast").path.speed == 0.2
    with pytest.raises(ConfigError, match=r"no variant 'slow'; valid: 'fast'"):
        load_task(path, "slow")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[path]\nspede = 1.0\n", r"task\.toml: unknown key 'path\.spede'.*did you mean 'speed'"),
        ('[path]\npattern = "zigzag"\n', r"path\.pattern.*'raster', 'spiral'.*got 'zigzag'"),
        ("[path]\nspeed = -1.0\n", r"path\.speed.*greater than 0.*got -1"),
        ("[force]\nnormal = -5.0\n", r"a force on a surface pushes"),
        ("[force]\nnormal = [[0.0, 5], [0.0, 9]]\n", r"must increase"),
        ("[truth]\nshift = { uniform = [1.0, -1.0] }\n", r"low to high"),
        ('[path]\npattern = "file"\n', r"path\.file and path\.pattern = 'file' go together"),
        ('base = "task.toml"\n', r"inherit from each other in a circle"),
        ("variant = 3\n", r"write \[variant\.NAME\]"),
        ("format = 2\n", r"format.*less than or equal to 1"),
    ],
)
def test_bad_input_is_one_sentence_with_file_and_key(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message) as caught:
        load_task(written(tmp_path, text))
    assert "\n" not in str(caught.value)


def test_what_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "task.toml"
    path.write_bytes(b"\xff\xfe\x00robot")
    with pytest.raises(ConfigError, match=r"task\.toml"):
        load_task(path)


def test_an_unknown_task_is_refused_with_those_there_are() -> None:
    with pytest.raises(ConfigError, match=r"no task 'wype'.*did you mean 'wipe'"):
        load_task("wype")


@pytest.mark.parametrize("name", catalogue())
def test_every_task_that_ships_can_be_run(name: str) -> None:
    """Its path is reached on one branch; variants too."""
    found = read_task(name)
    assert found.task.description
    for case in study_of(name).cases.values():
        made = planned(case)
        assert made.references.longest > made.path.duration


@given(value=st.floats(-1e3, 1e3), width=st.floats(0.0, 10.0), seed=st.integers(0, 1000))
@settings(max_examples=30, deadline=None)
def test_draws_stay_within_their_bounds(value: float, width: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    for how in (value, Uniform(uniform=(value, value + width)), Choice(choice=(value, value + width))):
        low, high = bounds(how)
        assert low <= drawn(how, rng) <= high
    assert bounds(Normal(normal=(value, width))) == (value - 3.0 * width, value + 3.0 * width)


TRUTHS = [
    {"shift": 0.01, "tilt": 5.0, "axis": (1.0, 0.0, 0.0)},
    {"stiffness": 1e5, "damping": 10.0, "friction": 0.9},
    {"tool_mass": 1.0, "link_masses": 0.3},
    {"imperfections": "p3"},
]


@pytest.mark.parametrize("truth", TRUTHS)
def test_what_is_true_changes_no_parameter_and_no_reference(truth: dict[str, object]) -> None:
    case = case_of(load_task("wipe"), "wipe")
    other = merged(case, {"truth": truth, "seed": 7})
    mine, theirs = planned(case), planned(other)
    assert mine is theirs  # made once: not even computed again
    config = case.parameters(mine.robot, case.believed(mine.surface))
    assert config == other.parameters(theirs.robot, other.believed(theirs.surface))


def test_the_true_surface_is_where_the_draw_puts_it() -> None:
    case = merged(case_of(load_task("wipe"), "wipe"), {"truth": {"shift": 0.003, "tilt": 4.0, "axis": (0.0, 1.0, 0.0)}})
    made = planned(case)
    true = true_surface(case, made.surface, made.path).geometry
    pivot, up = made.path.places[0], made.path.normals[0]
    assert true.near(pivot + 0.003 * up).distance == pytest.approx(0.0, abs=1e-9)
    assert np.degrees(np.arccos(true.normal(pivot) @ up)) == pytest.approx(4.0)
    drawn_once = merged(case, {"truth": {"tilt": {"uniform": (-4.0, 4.0)}}, "seed": 3})
    again, twice = (true_surface(drawn_once, made.surface, made.path) for _ in range(2))
    np.testing.assert_array_equal(again.geometry.rotation, twice.geometry.rotation)


def test_a_path_file_is_laid_on_the_surface(tmp_path: Path) -> None:
    (tmp_path / "path.csv").write_text("note,y,x\na,-20,-40\nb,-20,40\nc,20,40\n")
    task = load_task(
        written(tmp_path, '[surface]\nshape = "cylinder"\n[path]\npattern = "file"\nfile = "path.csv"\nunit = "mm"\n')
    )
    made = planned(case_of(task, "mine"))
    assert made.path.length == pytest.approx(0.12, rel=0.05)
    assert max(abs(made.surface.near(place).distance) for place in made.path.places) < 1e-5


@pytest.mark.parametrize(
    ("csv", "unit", "message"),
    [
        ("x,y,z\n0,0,0\n0.05,0,0\n0.1,0,0.08\n", "m", r"line 4: the point is 80\.0 mm off the believed surface"),
        ("x,y\n0,0\n60,0\n60,40\n", "m", r"is it in millimetres\? then set path\.unit = 'mm'"),
        ("x,q\n0,0\n", "m", r"y"),
    ],
)
def test_a_path_file_that_does_not_fit_is_refused(tmp_path: Path, csv: str, unit: str, message: str) -> None:
    (tmp_path / "path.csv").write_text(csv)
    task = load_task(written(tmp_path, f'[path]\npattern = "file"\nfile = "path.csv"\nunit = "{unit}"\n'))
    with pytest.raises(ConfigError, match=message):
        planned(case_of(task, "mine"))


def test_a_surface_out_of_reach_is_refused(tmp_path: Path) -> None:
    task = load_task(written(tmp_path, "[surface]\npose = { xyz = [2.0, 0.0, 0.0] }\n"))
    with pytest.raises(PliantError, match="cannot reach"):
        planned(case_of(task, "mine"))
