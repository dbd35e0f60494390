"""The list of claims names tests that exist; words that were too strong do not come back."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
NAMED = re.compile(r"`(tests/[\w/]+\.py)::(\w+)`")


def missing(page: str) -> list[str]:
    """Tests that a page names and that do not exist."""
    gone = []
    for file, test in NAMED.findall(page):
        path = ROOT / file
        if not path.is_file() or not re.search(rf"^def {test}\(", path.read_text(encoding="utf-8"), re.MULTILINE):
            gone.append(f"{file}::{test}")
    return gone


def test_every_test_that_a_claim_names_exists() -> None:
    page = (ROOT / "docs" / "claims.md").read_text(encoding="utf-8")
    assert len(NAMED.findall(page)) >= 16
    assert missing(page) == []


@pytest.mark.parametrize("name", ["tests/laws/test_attractor.py::test_that_is_not", "tests/no_file.py::test_that_is"])
def test_a_name_without_a_test_is_found(name: str) -> None:
    assert missing(f"| claim | `{name}` |") == [name]


def test_every_row_has_a_condition_and_a_test() -> None:
    page = (ROOT / "docs" / "claims.md").read_text(encoding="utf-8")
    rows = [line.strip("|").split("|") for line in page.splitlines() if line.startswith("|")][2:]
    assert all(len(row) == 3 and row[1].strip() for row in rows)
    assert all(NAMED.search(row[2]) for row in rows)


@pytest.mark.parametrize(
    "words", ["for any file", "runs away, every run", "nothing works", "passive for any switching", "control arm"]
)
def test_words_that_were_too_strong_do_not_come_back(words: str) -> None:
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    assert not [page.name for page in pages if words in page.read_text(encoding="utf-8").lower()]
