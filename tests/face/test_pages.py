"""The pages of Start and Extend do what they say: their files are written, their code and commands are run."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest
from typer.testing import CliRunner

from pliant.cli.app import app
from pliant.experiments import sweep
from pliant.experiments.runner import run_case

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGES = ("five_minutes", "your_arm", "extend_controller", "extend_task", "extend_robot", "extend_metric")
RUN = ("sh", "python", "xml", "csv", "toml")
BRIEFLY = (
    ("pliant run", "duration=4"),
    ("pliant compare haptic", "duration=2"),
    ("pliant compare haptic", "checks=[]"),  # which lie later
)
"""command, and what is set where a shorter run shows that it does what it says"""


class Block(NamedTuple):
    """A fenced block of a page."""

    language: str
    file: str
    """that it is the whole of; empty: none"""
    text: str


def blocks(text: str) -> list[Block]:
    """The fenced blocks, in order."""
    found = re.findall(r'^```(\w*)(?: title="([^"]+)")?\n(.*?)^```$', text, re.DOTALL | re.MULTILINE)
    return [Block(*one) for one in found]


def do(block: Block, scope: dict[str, object]) -> None:
    """Writes a file, runs a test that is one, executes code, or types commands, in the working folder."""
    if block.file:
        Path(block.file).write_text(block.text, encoding="utf-8")
        if block.file.startswith("test_"):
            command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", block.file]
            done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
            assert done.returncode == 0, done.stdout
    elif block.language == "python":
        exec(compile(block.text, "page", "exec"), scope)
    elif block.language == "sh":
        for line in block.text.splitlines():
            name, *arguments = shlex.split(line)
            assert name == "pliant"
            if arguments[0] == "run" and not {"--no-figures", "--show-config"} & set(arguments):
                arguments.append("--no-figures")  # which other tests draw; they take most of the time
            for beginning, setting in BRIEFLY:
                if line == beginning or line.startswith(f"{beginning} --controllers"):
                    arguments += ["--set", setting]
            result = CliRunner().invoke(app, arguments)
            assert result.exit_code == 0, f"{line}\n{result.output}\n{result.exception!r}"


@pytest.mark.parametrize("page", PAGES)
def test_the_page_does_what_it_says(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sweep, "run_case", lambda *what, figures: run_case(*what, figures=False))  # of a comparison
    if page == "your_arm":  # whose reader has one
        (arm,) = (one for one in blocks((DOCS / "extend_robot.md").read_text()) if one.file == "my_arm.xml")
        do(arm, {})
    found = [one for one in blocks((DOCS / f"{page}.md").read_text()) if one.language in RUN]
    assert len(found) > 3
    scope: dict[str, object] = {}
    for block in found:
        do(block, scope)


def test_what_does_not_run_would_be_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Baseline: a command with a wrong name, code that raises and a test that fails are all noticed."""
    monkeypatch.chdir(tmp_path)
    bad = (
        "```sh\npliant run --controller nobody\n```",
        "```python\nassert 1 > 2\n```",
        '```python title="test_bad.py"\ndef test_it():\n    assert 1 > 2\n```',
    )
    for text in bad:
        (block,) = blocks(text)
        with pytest.raises(AssertionError):
            do(block, {})
