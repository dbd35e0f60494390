"""The file with the rows of `pliant list`, which `python -m pliant.cli.list_rows` writes."""

from __future__ import annotations

import json
from pathlib import Path

FILE = Path(__file__).with_name("lists.json")


def written(what: str) -> list[list[str]]:
    """The rows of a list in the file. Args: what: controllers, studies or tasks."""
    rows: list[list[str]] = json.loads(FILE.read_text(encoding="utf-8"))[what]
    return rows
