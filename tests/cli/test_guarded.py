"""How a command ends where nobody reads on, and where something happens that nobody foresaw."""

from __future__ import annotations

import pytest
import typer
from rich.console import Console

from pliant.cli.guarded import guarded


class Closed:
    """A pipe whose reader has gone."""

    encoding = "utf-8"

    def write(self, text: str) -> int:
        raise BrokenPipeError

    def flush(self) -> None:
        raise BrokenPipeError


def test_a_reader_that_goes_is_no_error(capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def end(_console: Console) -> None:
        raise SystemExit(1)  # rich's own closes this process's output before

    monkeypatch.setattr(Console, "on_broken_pipe", end)

    @guarded
    def command() -> None:
        Console(file=Closed()).print("text")  # type: ignore[arg-type]

    with pytest.raises(SystemExit):
        command()
    assert capfd.readouterr().err == ""


def test_an_end_that_nobody_foresaw_is_one(capfd: pytest.CaptureFixture[str]) -> None:
    @guarded
    def command() -> None:
        raise SystemExit(1)

    with pytest.raises(typer.Exit):
        command()
    assert "did not foresee this (SystemExit: 1)" in capfd.readouterr().err
