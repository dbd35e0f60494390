"""What `pliant list` says of what is not there."""

from __future__ import annotations

import io
import json
import subprocess
import sys

import pytest
from rich.console import Console

from pliant.cli import list_rows, listing
from pliant.cli.list_file import FILE
from pliant.cli.plain_table import PlainTable
from pliant.robots import CATALOGUE


@pytest.mark.parametrize("there", [True, False])
def test_a_robot_that_is_not_installed_has_its_remedy(there: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(listing, "is_available", lambda entry: there)
    table = listing._robots()
    names, texts = table.column(0), table.column(2)
    for name, text in list(zip(names, texts, strict=True))[:-1]:
        assert text.startswith(CATALOGUE[name].description)
        assert ("(not installed: pip install " in text) is not there


def test_a_list_of_phases_says_what_it_touches_and_how_many_they_are() -> None:
    """Neither the default surface nor the default path, which such a task does not have; a path keeps its own."""
    table = listing._tasks()
    names, things, paths = table.column(0), table.column(2), table.column(3)
    told = {name.removeprefix("  --case "): pair for name, *pair in zip(names, things, paths, strict=True)}
    assert told["figure8-plain"] == ["nothing", "lemniscate"]
    assert told["figure8-wall"] == ["plane", "lemniscate"]
    assert told["experiment-4"] == ["plane, ball", "5 phases"]
    assert told["wipe-cylinder"] == ["cylinder", "raster"]
    assert told["polish-circle"] == ["plane", "circle"]


@pytest.fixture(scope="module")
def rows() -> dict[str, list[list[str]]]:
    """In a process of its own: other tests register studies of theirs."""
    told = "from pliant.cli.list_rows import own_rows, text_of; print(text_of(own_rows()))"
    return json.loads(subprocess.run([sys.executable, "-c", told], check=True, capture_output=True, text=True).stdout)


def test_the_written_rows_are_those_of_controllers_studies_and_tasks(rows: dict[str, list[list[str]]]) -> None:
    """`python -m pliant.cli.list_rows` writes them again."""
    assert FILE.read_text(encoding="utf-8") == list_rows.text_of(rows)


@pytest.mark.parametrize("changed", ["controllers", "studies", "tasks"])
def test_a_row_that_changed_would_be_noticed(changed: str, rows: dict[str, list[list[str]]]) -> None:
    other = {**rows, changed: [[*rows[changed][0][:-1], "another text"], *rows[changed][1:]]}
    assert FILE.read_text(encoding="utf-8") != list_rows.text_of(other)


def test_what_another_package_offers_is_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever it is: the rows are then those of the registry, which tests of its own look at."""
    told = [["theirs", "own", "–", "–", "of another package"]]
    monkeypatch.setattr(list_rows, "controller_rows", lambda: told)
    assert "theirs" not in listing._controllers().column(0)
    monkeypatch.setattr(listing, "entry_points", lambda group: [group])
    assert listing._controllers().column(0) == ["theirs", "MODULE:CLASS"]


def said_at(width: int, table: PlainTable) -> list[str]:
    file = io.StringIO()
    table.print(Console(file=file, width=width))
    return file.getvalue().splitlines()


def test_a_narrow_console_wraps_texts_and_keeps_what_is_typed() -> None:
    table = PlainTable("things", ("name", "what it is"), rows=[("a-long-name-of-one", "one of several words")])
    table.rows.append(("two", "short"))
    table.breaks.add(1)
    assert said_at(80, table) == [
        "things",
        "┏━━━━━━━━━━━━━━━━━━━━┳━━━━━━━━━━━━━━━━━━━━━━┓",
        "┃ name               ┃ what it is           ┃",
        "┡━━━━━━━━━━━━━━━━━━━━╇━━━━━━━━━━━━━━━━━━━━━━┩",
        "│ a-long-name-of-one │ one of several words │",
        "├────────────────────┼──────────────────────┤",
        "│ two                │ short                │",
        "└────────────────────┴──────────────────────┘",
    ]
    narrow = said_at(40, table)
    assert max(map(len, narrow)) == 40
    assert "│ a-long-name-of-one │ one of several  │" in narrow
    assert "│                    │ words           │" in narrow
