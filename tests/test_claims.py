"""The list of claims names tests that exist; words that were too strong do not come back."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
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


STRONG = re.compile(
    r"\b(never|any|always|exact|exactly|bounded|passive|guarantees?|guaranteed|no matter)\b", re.IGNORECASE
)
QUANTITIES = re.compile(r"\b(any|every|cannot)\b", re.IGNORECASE)
"""In docstrings "any" says that an argument is free, and everywhere "every" and "cannot" list and refuse: only the
README, which people believe first, is read for them."""
REVIEWED = ROOT / "tests" / "reviewed_words.txt"


def sentences(text: str) -> Iterator[str]:
    """The sentences of a text and the cells of its tables, blanks made one."""
    without_code = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    for piece in re.split(r"(?<=[.:;!?|])\s+|\n\s*\n", without_code):
        yield " ".join(piece.split())


def docstrings(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            yield node.value.value


def strong_sentences() -> Iterator[tuple[str, str]]:
    """(file, sentence) of README, pages and docstrings that hold a strong word."""
    for page in (*ROOT.glob("*.md"), *sorted((ROOT / "docs").glob("*.md"))):
        text = page.read_text(encoding="utf-8")
        for sentence in sentences(text):
            if STRONG.search(sentence) or (page.name == "README.md" and QUANTITIES.search(sentence)):
                yield page.name, sentence
    for module in sorted((ROOT / "src").rglob("*.py")):
        for text in docstrings(module):
            for sentence in sentences(text):
                if any(word.lower() != "any" for word in STRONG.findall(sentence)):
                    yield module.name, sentence


def reviewed() -> dict[str, str]:
    """Piece of a sentence → test that holds it, empty where it promises nothing."""
    lines = (line for line in REVIEWED.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#"))
    pairs = (line.partition(" => ") for line in lines)
    return {piece: test for piece, _, test in pairs}


def test_every_strong_sentence_was_reviewed() -> None:
    """A new one is reworded, or gets a line in `tests/reviewed_words.txt` and, if it promises something, a test."""
    pieces = reviewed()
    new = [f"{file}: {sentence}" for file, sentence in strong_sentences() if not any(p in sentence for p in pieces)]
    assert new == []


def test_a_sentence_that_nobody_reviewed_is_found() -> None:
    boast = "The robot never falls, whatever happens."
    assert STRONG.search(boast)
    assert not any(piece in boast for piece in reviewed())


def test_promises_have_tests_that_exist() -> None:
    named = [test for test in reviewed().values() if test]
    assert len(named) > 30
    assert missing(" ".join(f"`{test}`" for test in named)) == []
