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
from pliant.studies.task.build_list import listed
from pliant.studies.task.config import case_of
from pliant.studies.task.study import study_of
from pliant.studies.task.world import true_surface
from pliant.tasks import load_task
from pliant.tasks.draws import Normal, OneOf, Uniform, bounds, drawn
from pliant.tasks.files import catalogue, read_task
from pliant.tasks.parts import Force


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


def test_one_phase_of_a_list_is_changed_by_its_name(tmp_path: Path) -> None:
    """A file, a variant and an option change what they name; the other phases stay as they are."""
    first = '[[phase]]\nname = "down"\ntarget = [0.5, 0, 0.1]\nduration = 1.0\n'
    written(tmp_path, first + "[[phase]]\nwrench = [0, 0, 9]\nduration = 2.0\n")
    text = 'base = "task.toml"\n[phase.down]\nduration = 3.0\n[variant.hard.phase.2]\nwrench = [0, 0, 20]\n'
    path = written(tmp_path, text, "b.toml")
    hard = load_task(path, "hard")
    assert [phase.duration for phase in hard.phase] == [3.0, 2.0]
    assert [phase.wrench for phase in hard.phase] == [None, (0.0, 0.0, 20.0)]
    assert load_task(path).phase[1].wrench == (0.0, 0.0, 9.0)
    assert merged(hard, {"phase": {"down": {"duration": 1.5}}}).phase[0].duration == 1.5
    written(tmp_path, text + '[variant.more.phase.rest]\nname = "rest"\nduration = 4.0\n', "b.toml")
    assert [phase.duration for phase in load_task(path, "more").phase] == [3.0, 2.0, 4.0]
    written(tmp_path, text + "[variant.odd.phase.don]\nduration = 1.0\n", "b.toml")
    with pytest.raises(
        ConfigError, match=r"b\.toml: phase has nothing called 'don'; valid: '2', 'down' .*did you mean 'down'"
    ):
        load_task(path, "odd")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[path]\nspede = 1.0\n", r"task\.toml: unknown key 'path\.spede'.*did you mean 'speed'"),
        ('[path]\npattern = "zigzag"\n', r"path\.pattern.*'raster', 'spiral'.*got 'zigzag'"),
        ("[path]\nspeed = -1.0\n", r"path\.speed.*must be at least 0.*got -1"),
        ("[force]\nnormal = -5.0\n", r"a force on a surface pushes"),
        ("[force]\nnormal = [[0.0, 5], [0.0, 9]]\n", r"must increase"),
        ("[truth]\nshift = { uniform = [1.0, -1.0] }\n", r"low to high"),
        ('[path]\npattern = "file"\n', r"path\.file and path\.pattern = 'file' go together"),
        ('base = "task.toml"\n', r"inherit from each other in a circle"),
        ("variant = 3\n", r"write \[variant\.NAME\]"),
        ("format = 2\n", r"written for a newer pliant .format 2., this one reads up to 1"),
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
    """Its path is reached on one branch, or its phases can all be run; variants too."""
    found = read_task(name)
    assert found.task.description
    for case in (described.config for described in study_of(name).cases.values()):
        if case.phase:  # a shorter one of a phase that tracks: its posture takes seconds
            first = case.phase[0].model_copy(update={"duration": 0.5} if case.phase[0].tracks else {})
            assert listed(case.model_copy(update={"phase": (first, *case.phase[1:])})).duration > 0.0
            continue
        made = planned(case)
        assert made.references.longest > made.path.duration


@given(value=st.floats(-1e3, 1e3), width=st.floats(0.0, 10.0), seed=st.integers(0, 1000))
@settings(max_examples=30, deadline=None)
def test_draws_stay_within_their_bounds(value: float, width: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    for how in (value, Uniform(uniform=(value, value + width)), OneOf(choice=(value, value + width))):
        low, high = bounds(how)
        assert low <= drawn(how, rng) <= high
    assert bounds(Normal(normal=(value, width))) == (value - 3.0 * width, value + 3.0 * width)


def any_truth(seed: int) -> dict[str, object]:
    """Values of every key of `[truth]`, drawn."""
    rng = np.random.default_rng(seed)
    return {
        "shift": float(rng.uniform(-0.02, 0.02)),
        "tilt": {"uniform": sorted(rng.uniform(-20.0, 20.0, 2).tolist())},
        "axis": "random" if seed % 2 else tuple(rng.standard_normal(3).tolist()),
        "stiffness": float(rng.uniform(1e3, 1e5)),
        "damping": {"choice": rng.uniform(10.0, 500.0, 3).tolist()},
        "friction": {"normal": [0.3, float(rng.uniform(0.0, 0.1))]},
        "tool_mass": float(rng.uniform(0.0, 2.0)),
        "link_masses": float(rng.uniform(0.0, 0.5)),
        "joint_friction": float(rng.uniform(0.0, 2.0)),
        "joint_damping": float(rng.uniform(0.0, 2.0)),
        "imperfections": ("none", "p3", "p3-without-torque-loop")[seed % 3],
    }


@pytest.mark.parametrize("seed", range(12))
def test_what_is_true_changes_no_parameter_and_no_reference(seed: int) -> None:
    """A search over everything that can be true, for a value that a controller or a reference gets to know."""
    case = case_of(load_task("wipe"), "wipe")
    truth = any_truth(seed)
    things = {"things"}  # of lists of phases: tests/tasks/test_insertion.py
    assert set(truth) | things == set(type(case.truth).model_fields)
    other = merged(case, {"truth": truth, "seed": seed + 1})
    mine, theirs = planned(case), planned(other)
    for name in mine.references.begins:
        assert theirs.references.begins[name] == mine.references.begins[name]
    for time in np.linspace(0.0, mine.path.duration, 7).tolist():
        np.testing.assert_array_equal(theirs.path.position.at(time).value, mine.path.position.at(time).value)
    config = case.controller_parameters(mine.robot, case.believed(mine.surface))
    assert config == other.controller_parameters(theirs.robot, other.believed(theirs.surface))


def test_a_part_stands_where_its_pose_says_whatever_place_would_be_good() -> None:
    case = merged(case_of(load_task("wipe"), "wipe"), {"surface": {"pose": {"xyz": (0.55, 0.0, 0.1)}}})
    np.testing.assert_array_equal(planned(case).surface.origin, (0.55, 0.0, 0.1))


@pytest.mark.parametrize(
    "changes", [{"size": (1e9, 1e9)}, {"pattern": "circle", "turns": 1000.0}, {"size": (1.0, 1e3)}]
)
def test_a_path_that_nobody_waits_for_is_refused(changes: dict[str, object]) -> None:
    with pytest.raises(ConfigError, match=r"m long, more than 200 m: make path\.size"):
        planned(merged(case_of(load_task("wipe"), "wipe"), {"path": changes}))


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


def test_a_force_of_nothing_is_asked_for_and_a_pull_is_not() -> None:
    force = Force(normal=((0.0, 0.0), (0.5, 30.0), (1.0, 10.0)))
    assert force.knots() == ((0.0, 0.5, 1.0), (0.0, 30.0, 10.0))
    assert force.largest == 30.0  # N, not the last share
    assert Force(normal=0.0).largest == 0.0
    with pytest.raises(ValueError, match="must not be negative, got -1 N"):
        Force(normal=((0.0, -1.0), (1.0, 5.0)))


def test_files_inherit_eight_deep_and_no_deeper(tmp_path: Path) -> None:
    written(tmp_path, "[path]\nspeed = 0.07\n", "0.toml")
    for depth in range(1, 10):
        written(tmp_path, f'base = "{depth - 1}.toml"\n', f"{depth}.toml")
    assert load_task(tmp_path / "8.toml").path.speed == 0.07
    with pytest.raises(ConfigError, match="more than 8 deep"):
        load_task(tmp_path / "9.toml")
