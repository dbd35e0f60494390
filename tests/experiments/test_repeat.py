"""A run is repeated from its `config.toml` or its log, and every value says where it comes from."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from pliant.errors import ConfigError, OutputError
from pliant.experiments.choice import chosen
from pliant.experiments.origins import Origin, origins
from pliant.experiments.registry import get_study, study_names
from pliant.experiments.repeat import write_config
from pliant.experiments.runner import run_case

CASES = [(study, case) for study in study_names() for case in get_study(study).cases]


@pytest.mark.parametrize(("study", "case"), [*CASES, ("wipe", None), ("wipe-sphere", None)])
def test_a_configuration_written_whole_is_read_back_as_it_was(study: str, case: str | None, tmp_path: Path) -> None:
    first = chosen(study, case, {"seed": 3}, {})
    again = chosen(str(write_config(first.study, first.config, tmp_path)), None, {}, {})
    assert again.config == first.config
    assert type(again.config) is type(first.config)
    assert again.study.name == first.study.name


def test_every_row_of_a_study_is_read_back_as_it_was(tmp_path: Path) -> None:
    """Rows hold what no file gives: variants, models that differ, values without a word in TOML."""
    study = get_study("polishing")
    rows = study.runs("tables-2-3-4-delayed", 1)
    assert len({row.variant for row in rows}) > 1
    for row in rows[::5]:
        assert chosen(str(write_config(study, row, tmp_path)), None, {}, {}).config == row


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Folder and log of a short run of a task, with noise, delays and a drawn surface."""
    folder = tmp_path_factory.mktemp("ran")
    choice = chosen("wipe", None, {"seed": 5}, {"duration": 0.2})
    result = run_case(choice.study, choice.config, folder, figures=False)
    write_config(choice.study, choice.config, folder)
    assert result.log is not None
    return folder, result.log


def test_a_run_of_a_task_repeats_bit_for_bit_from_both(ran: tuple[Path, Path], tmp_path: Path) -> None:
    folder, log = ran
    for number, source in enumerate((folder / "config.toml", log)):
        choice = chosen(str(source), None, {}, {})
        (tmp_path / str(number)).mkdir()
        again = run_case(choice.study, choice.config, tmp_path / str(number), figures=False)
        assert again.log is not None
        assert again.log.read_bytes() == log.read_bytes()
    other = run_case(choice.study, chosen(str(log), None, {"seed": 6}, {}).config, tmp_path, figures=False)
    assert other.log is not None
    assert other.log.read_bytes() != log.read_bytes()  # the seed reaches the run


def test_changes_are_laid_over_a_repeated_run(ran: tuple[Path, Path]) -> None:
    for source in ran[0] / "config.toml", ran[1]:
        config = chosen(str(source), None, {"controller": "stack"}, {"path": {"speed": 0.02}}).config
        assert (config.controller, config.seed, config.model_dump()["path"]["speed"]) == ("stack", 5, 0.02)


def damaged(folder: Path, **changes: Any) -> str:
    values = tomllib.loads((folder / "config.toml").read_text())
    path = folder / "damaged.toml"
    path.write_text(tomli_w.dumps({key: value for key, value in (values | changes).items() if value != "gone"}))
    return str(path)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"none": "locked"}, "'none' is a list of keys without a value, got 'locked'"),
        ({"none": ["robot.x"]}, "'none' names 'robot.x', but 'robot' is no table"),
        ({"study": 3}, "study is a name, got 3"),
        ({"robot": "gone"}, "robot"),
        ({"seed": -1}, "seed"),
        ({"sed": 1, "complete": "0.0.1"}, r"'sed'.*written by pliant 0\.0\.1, this is pliant"),
    ],
)
def test_a_damaged_file_is_one_sentence(ran: tuple[Path, Path], changes: dict[str, Any], words: str) -> None:
    with pytest.raises(ConfigError, match=words) as raised:
        chosen(damaged(ran[0], **changes), None, {}, {})
    assert "\n" not in str(raised.value)
    assert "damaged.toml" in str(raised.value)


def test_one_run_is_of_one_case(ran: tuple[Path, Path]) -> None:
    with pytest.raises(ConfigError, match="holds one run, of case 'wipe'; --case other is another"):
        chosen(str(ran[1]), "other", {}, {})


def test_what_is_no_log_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.mcap").write_bytes(b"nothing")
    for name in "a.mcap", "b.mcap":
        with pytest.raises(OutputError):
            chosen(str(tmp_path / name), None, {}, {})


def found(target: str, **options: Any) -> dict[str, Origin]:
    choice = chosen(target, None, {"seed": 2}, options, ("an option", "--set"))
    return {row.key: row for row in origins(choice, choice.study.build(choice.config).parameters)}


def test_every_value_says_where_it_comes_from(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('study = "stack"\ncase = "figure8-plain"\n[path]\nramp = 1.5\n')
    rows = found(str(file), control={"joint_damping": 0.3}, path={"period": 3.0})
    stiffness = "control.tasks.ee.translation.stiffness"
    assert {key: rows[key].origin for key in ("seed", "path.ramp", "path.period", "control.joint_damping")} == {
        "seed": "an option",
        "path.ramp": str(file),
        "path.period": "--set",
        "control.joint_damping": "--set",
    }
    assert (rows["case"].origin, rows["physics_step"].origin) == ("case figure8-plain", "default")
    assert (rows["path.ramp"].shown, rows["path.ramp"].unit) == ("1.5", "s")
    assert rows[stiffness].unit == "N/m"
    assert float(rows[stiffness].value) > 0.0  # what the controller was built with, not only what was changed


def test_what_a_controller_takes_from_the_task_is_suggested() -> None:
    rows = found("wipe")
    of_the_controller = {key: row for key, row in rows.items() if key.startswith("control.offset-free-mpc.")}
    assert of_the_controller["control.offset-free-mpc.contact.axes"].origin == "suggested"
    assert {row.origin for row in of_the_controller.values()} == {"suggested", "default"}
    assert rows["limits.force"].origin == "case wipe"
