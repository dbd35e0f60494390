"""`pliant new controller`: what it writes runs and passes its own test."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pliant.cli.app import app

runner = CliRunner()


@pytest.mark.study
def test_what_it_writes_passes_its_own_test(tmp_path: Path) -> None:
    file = tmp_path / "soft.py"
    done = runner.invoke(app, ["new", "controller", "SoftSpring", "-o", str(file)])
    assert done.exit_code == 0
    assert "MyController" not in file.read_text()
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_soft.py"]
    tested = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120)
    assert tested.returncode == 0, tested.stdout
    assert "2 passed" in tested.stdout
    again = runner.invoke(app, ["new", "controller", "SoftSpring", "-o", str(file)])
    assert again.exit_code == 2  # nothing is overwritten


@pytest.mark.parametrize(
    "arguments",
    [("controler", "A"), ("controller", "soft-spring"), ("controller", "class"), ("controller", "A", "-o", "a.txt")],
)
def test_bad_input_is_one_sentence(arguments: tuple[str, ...]) -> None:
    done = runner.invoke(app, ["new", *arguments])
    assert done.exit_code == 2
    assert done.stderr.count("\n") == 1
