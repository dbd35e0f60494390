"""What stands in a file or an option that a user names: read, or refused in a sentence; nothing waits for ever."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from pliant.cli import main
from pliant.configuration import parse_assignments, read_toml
from pliant.errors import ConfigError

TOML = {
    "a case that is a number": (b'study = "stack"\ncase = 1\n', "'case' is a name"),
    "nested tables": (b"[" + b".".join([b"a"] * 5000) + b"]\n", "nested"),
    "nested arrays": (b"a = " + b"[" * 5000 + b"]" * 5000, "nested"),
    "5000 digits": (b"a = " + b"1" * 5000, "is not TOML"),
    "binary": (bytes(range(256)) * 20, "is not UTF-8 text"),
}


def _fails(arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> str:
    monkeypatch.setattr(sys, "argv", ["pliant", *arguments])
    with pytest.raises(SystemExit) as ended:
        main()
    said = capsys.readouterr().err
    assert ended.value.code == 2, said
    assert "Traceback" not in said
    assert len(said.strip().splitlines()) == 1
    return said


@pytest.mark.parametrize("kind", TOML)
def test_odd_files_are_one_sentence(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file, (content, words) = tmp_path / "a.toml", TOML[kind]
    file.write_bytes(content)
    said = _fails(["run", str(file)], monkeypatch, capsys)
    assert words in said
    assert "did not foresee" not in said


@pytest.mark.parametrize("command", [["run", "odd.toml"], ["log", "odd.toml"], ["doctor", "--config", "odd.toml"]])
@pytest.mark.parametrize("kind", ["pipe", "folder"])
def test_a_pipe_or_a_folder_is_not_waited_for(
    kind: str, command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    os.mkfifo("odd.toml") if kind == "pipe" else Path("odd.toml").mkdir()
    assert "not a regular file" in _fails(command, monkeypatch, capsys)


def test_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_bytes(b"\xef\xbb\xbfa = 1\n")
    assert read_toml(tmp_path / "a.toml") == {"a": 1}


@pytest.mark.parametrize("text", ["a=" + "1" * 5000, "a=" + "[" * 5000, ".".join("a" * 5000) + "=1"])
def test_odd_values_are_one_short_sentence(text: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_assignments([text])
    assert len(str(caught.value)) < 500


@pytest.mark.parametrize(
    ("text", "keys"),
    [
        ("control.mine.py:Mine.gain=1", ["control", "mine.py:Mine", "gain"]),
        ('control."../a.b/mine.py:Mine".gain=1', ["control", "../a.b/mine.py:Mine", "gain"]),
        ("control.pypi.gain=1", ["control", "pypi", "gain"]),
        (" a . b =1", ["a", "b"]),
    ],
)
def test_the_name_of_a_file_is_one_part_of_a_key(text: str, keys: list[str]) -> None:
    found, got = parse_assignments([text]), []
    while isinstance(found, dict):
        ((key, found),) = found.items()
        got.append(key)
    assert (got, found) == (keys, 1)


def test_a_table_of_a_controller_that_there_is_not_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["run", "wipe", "--controller", "haptic", "--show-config", "--set"]
    said = _fails([*arguments, "control.haptik.exploration.gain=3"], monkeypatch, capsys)
    assert "no controller 'haptik'" in said
    assert "did you mean 'haptic'" in said


def test_a_folder_of_a_user_who_does_not_exist(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "output folder" in _fails(["run", "--out", "~no-such-user/x"], monkeypatch, capsys)


def test_what_nobody_foresaw_is_one_sentence_that_names_the_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from pliant.cli import listing

    def breaks(*_: object) -> None:
        raise ZeroDivisionError("a bug")

    monkeypatch.setattr(listing, "list_command", breaks)
    said = _fails(["list"], monkeypatch, capsys)
    file = Path(said.strip().rsplit(" ", 1)[1])
    assert "ZeroDivisionError: a bug" in file.read_text()
    file.unlink()
