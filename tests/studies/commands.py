"""Runs `pliant` with the toy study in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

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
    """Exit code, standard output and standard error."""
    process = start(*arguments)
    out, errors = process.communicate(timeout=120)
    assert "Traceback" not in errors, errors
    return process.returncode, out, errors


def rows(folder: Path) -> pa.Table:
    return pq.read_table(folder / "results.parquet").drop(["wall [s]"])


def content(folder: Path) -> str:
    """Schema and rows as text: NaN is not equal to itself."""
    table = rows(folder)
    return f"{table.schema.to_string(show_schema_metadata=True, truncate_metadata=False)}\n{table.to_pylist()!r}"
