"""Runs `pliant study` with the toy study, in this process or in one of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from rich.console import Console
from typer.testing import CliRunner

import tests.studies.toy  # noqa: F401  (registers it)
from pliant.cli.app import app

ROOT = Path(__file__).resolve().parents[2]
TOY = "tests.studies.toy"
PLIANT = [sys.executable, "-c", f"import {TOY}\nfrom pliant.cli import main\nif __name__ == '__main__': main()"]


def environment() -> dict[str, str]:
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    added = {"PYTHONPATH": path, "DASK_DISTRIBUTED__WORKER__PRELOAD": TOY, "OMP_NUM_THREADS": "1"}
    return os.environ | added | {"COLUMNS": "160", "PYTHONWARNINGS": "default"}


def start(*arguments: object, **options: Any) -> subprocess.Popen[str]:
    command = [*PLIANT, "study", *map(str, arguments)]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, env=environment(), stdout=pipe, stderr=pipe, text=True, **options)


def study(*arguments: object) -> tuple[int, str, str]:
    """Exit code, standard output and standard error, of the command in this process; what its workers say on theirs
    is in it."""
    sys.stderr.flush()
    kept = os.dup(2)
    with tempfile.TemporaryFile("w+") as said, pytest.MonkeyPatch.context() as patch:
        for name, value in environment().items():
            patch.setenv(name, value)
        patch.setattr("pliant.cli.program.out", Console(width=160))
        os.dup2(said.fileno(), 2)
        try:
            done = CliRunner().invoke(app, ["study", *map(str, arguments)])
        finally:
            os.dup2(kept, 2)
            os.close(kept)
        said.seek(0)
        errors = done.stderr + said.read()
    assert "Traceback" not in errors, errors
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.exit_code, done.stdout, errors


def rows(folder: Path) -> pa.Table:
    return pq.read_table(folder / "results.parquet").drop(["wall [s]"])


def content(folder: Path) -> str:
    """Schema and rows as text: NaN is not equal to itself."""
    table = rows(folder)
    return f"{table.schema.to_string(show_schema_metadata=True, truncate_metadata=False)}\n{table.to_pylist()!r}"
