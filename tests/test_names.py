"""Contracts of names: one class name a thing."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent / "src" / "pliant"


def twins(files: Iterable[Path]) -> dict[str, list[str]]:
    """Class name → the files that define it, where several do."""
    found: dict[str, list[str]] = defaultdict(list)
    for path in files:
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef):
                found[node.name].append(path.name)
    return {name: places for name, places in found.items() if len(places) > 1}


def test_no_two_classes_have_one_name() -> None:
    files = sorted(SOURCE.rglob("*.py"))
    assert len(files) > 300  # it found them
    assert twins(files) == {}


def test_a_second_class_of_a_name_would_be_noticed(tmp_path: Path) -> None:
    for name in ("one.py", "two.py"):
        (tmp_path / name).write_text("class Plan:\n    pass\n")
    assert twins(sorted(tmp_path.iterdir())) == {"Plan": ["one.py", "two.py"]}
