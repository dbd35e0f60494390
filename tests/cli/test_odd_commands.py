"""Whole commands with odd values, files and paths: done, or refused in one sentence, soon."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

import tests.studies.toy  # noqa: F401  (a study of milliseconds)
from pliant.cli.app import app
from tests.cli.commands import Typist, odd_files

LINES, PARTS = 360, 12
SLOW = 20.0  # s of computing; what waits without end, the limit of every test ends


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    made = tmp_path_factory.mktemp("odd")
    return made, odd_files(made)


def wrong_with(line: list[str]) -> str:
    """What is wrong with the way in which a command ends; empty if nothing is."""
    began = time.process_time()
    done = CliRunner().invoke(app, line, catch_exceptions=True)
    took = time.process_time() - began
    said = [text for text in done.stderr.splitlines() if not text.startswith(("note: ", "warning: "))]
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        return f"{type(done.exception).__name__}: {done.exception}"
    if "Traceback" in done.output or "did not foresee" in done.output:
        return done.output[-300:]
    if took > SLOW:
        return f"it took {took:.0f} s"
    if done.exit_code == 0:
        return ""
    if done.exit_code not in (1, 2):
        return f"exit code {done.exit_code}: {said}"
    kind = "error: " if done.exit_code == 2 else "failed: "
    own = [text for text in said if text.startswith(kind)]
    usage = done.exit_code == 2 and said and said[0].startswith("Usage: ")
    if not usage and (len(own) != 1 or said[-1] != own[0] or len(own[0]) > 2000):
        return f"exit code {done.exit_code}: {said}"
    return ""


@pytest.mark.parametrize("part", range(PARTS))
@pytest.mark.filterwarnings("ignore")
def test_an_odd_command_is_done_or_refused_in_a_sentence(
    part: int, folder: tuple[Path, list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder[0])
    lines = [Typist(seed, folder[1]).line() for seed in range(part, LINES, PARTS)]
    wrong = {str([word[:60] for word in line]): found for line in lines if (found := wrong_with(line))}
    assert wrong == {}
