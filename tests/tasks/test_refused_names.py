"""Names that there are not: `task check`, `study`, `compare` and `new task` refuse them before anything runs."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from pliant.cli.app import app
from pliant.configuration import merged
from pliant.errors import ConfigError
from pliant.experiments.registry import get_study
from pliant.tasks.files import load_task

CLI = CliRunner()
PLAIN = """
robot = "panda"
[surface]
pose = { xyz = [0.48, 0.0, 0.35] }
[path]
size = [0.04, 0.02]
[force]
normal = 15
"""
LIST = """
robot = "panda"
controller = "haptic"
[scene]
floor = { shape = "plane", stiffness = 1e4, pose = { xyz = [0.48, 0.0, 0.35] } }
[[phase]]
name = "down"
target = [0.48, 0.0, 0.347]
wrench = [0, 0, 15]
duration = 1
"""
EVENT = '[[event]]\ntime = 0.5\nchange = { "controller.%s.%s" = 100.0 }\n'


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def _called(text: str, *arguments: str) -> tuple[int, str]:
    Path("job.toml").write_text(text, encoding="utf-8")
    done = CLI.invoke(app, list(arguments))
    return done.exit_code, " ".join(done.output.split())


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ('controller = "haptik"\n' + PLAIN, "did you mean 'haptic'?"),
        (PLAIN + "[accept]\nforce_eror = 1\n", "there is no metric 'force_eror'"),
        (LIST + "[accept]\nforce_peek = 1\n", "there is no metric 'force_peek'"),
        (PLAIN + '[sweep]\n"path.sped" = [1, 2]\n', "did you mean 'speed'?"),
        (PLAIN + '[sweep]\ncontroller = ["haptic", "stak"]\n', "did you mean 'stack'?"),
        (PLAIN + '[sweep]\n"path.speed" = []\n', "sweep.path.speed is an empty list"),
        (PLAIN + "[sweep]\npath.speed = [0.1]\n", 'write "path.speed" in quotes'),
        (PLAIN + "[control.haptic]\nfoo = 1\n", "control.haptic: unknown key 'foo'; valid: "),
        (LIST + EVENT % ("hapic", "force_max"), "did you mean 'haptic'?"),
        (LIST + EVENT % ("stack", "force_mx"), "did you mean 'force_max'?"),
    ],
)
def test_task_check_refuses_what_a_run_refuses(text: str, sentence: str) -> None:
    code, said = _called(text, "task", "check", "job.toml")
    assert code == 2, said
    assert sentence in said
    assert "possible" not in said


def test_what_there_is_passes() -> None:
    sweep = '[sweep]\n"path.speed" = [0.05, 0.06]\ncontroller = ["haptic", "stack"]\n[accept]\nforce_error = 1\n'
    code, said = _called(PLAIN + sweep + "[control.haptic]\nimpedance = {}\n", "task", "check", "job.toml")
    assert code == 0, said
    assert "possible as believed" in said
    code, said = _called(LIST + EVENT % ("stack", "force_max"), "task", "check", "job.toml")
    assert code == 0, said


@pytest.mark.parametrize("values", ["[]", "3", "{ }"])
def test_a_study_refuses_a_sweep_without_values(values: str) -> None:
    code, said = _called(PLAIN + f'[sweep]\n"path.speed" = {values}\n', "study", "job.toml")
    assert code == 2, said
    assert "sweep.path.speed" in said
    assert "did not foresee" not in said


def test_compare_runs_nothing_if_one_controller_cannot_be_built() -> None:
    code, said = _called(PLAIN, "compare", "job.toml", "--controllers", "haptic,foo", "--seeds", "1")
    assert code == 2, said
    assert "'foo'" in said
    assert not list(Path().rglob("results.parquet"))


def test_parameters_of_a_controller_that_is_not_chosen_are_checked() -> None:
    study = get_study("wipe")
    other = merged(study.case("wipe"), {"control": {"haptic": {"foo": 1}}})
    assert other.controller != "haptic"
    with pytest.raises(ConfigError, match=r"control\.haptic: unknown key 'foo'; valid: .*'impedance'"):
        study.build(other)


@pytest.mark.parametrize(("name", "is_good"), [("a b", True), ("a.b", True), ("a/b", False), ("..", False)])
def test_the_name_of_a_variant_can_be_that_of_a_folder(name: str, is_good: bool) -> None:
    Path("job.toml").write_text(PLAIN + f'[variant."{name}"]\nforce.normal = 3\n', encoding="utf-8")
    if is_good:
        assert load_task("job.toml", name).force.normal == 3
        return
    with pytest.raises(ConfigError, match="its name becomes that of a folder"):
        load_task("job.toml", name)


def test_an_empty_file_is_told() -> None:
    assert "says nothing" in _called("", "task", "check", "job.toml")[1]
    assert "says nothing" not in _called(PLAIN, "task", "check", "job.toml")[1]


def test_a_template_of_a_task_names_a_robot_and_a_file_that_work() -> None:
    code, said = _called("", "new", "task", "line", "--robot", "nope", "-o", "line.toml")
    assert code == 2, said
    assert "'iiwa14'" in said
    assert not Path("line.toml").exists()
    code, said = _called("", "new", "task", "line", "-o", "plain")
    assert code == 0, said
    assert "pliant task check plain.toml" in said
    assert load_task("plain.toml").path.pattern == "line"
