"""Contract of prose: lines of at most 120 characters, but for tables, code, formulas and what has no place to break."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LONGEST = 120
PAGES = [
    *sorted((ROOT / "docs").glob("*.md")),
    *(ROOT / f"{name}.md" for name in ("README", "CONTRIBUTING", "CHANGELOG")),
]


def long_lines(text: str) -> list[int]:
    """Numbers of lines that are too long: not of tables, fenced or indented code, display formulas, HTML, or a line of
    one word or link."""
    found: list[int] = []
    fenced = formula = False
    for number, line in enumerate(text.splitlines(), start=1):
        bare = line.strip()
        if bare.startswith(("```", "~~~")):
            fenced = not fenced
        elif not fenced and (formula or bare.startswith("$$")):
            formula ^= bare.count("$$") % 2 == 1
        elif not fenced and len(line) > LONGEST and not bare.startswith(("|", "<")) and not line.startswith("    "):
            broken = re.sub(r"`[^`]*`|\$[^$]+\$|\[[^\]]*\]\([^)]*\)", "x", bare)
            if " " in re.sub(r"^([-*+]|\d+\.) ", "", broken):
                found.append(number)
    return found


def test_prose_is_wrapped() -> None:
    assert len(PAGES) > 20  # it found them
    assert {page.name: lines for page in PAGES if (lines := long_lines(page.read_text(encoding="utf-8")))} == {}


def test_a_long_line_would_be_noticed() -> None:
    long = "word " * 30
    assert long_lines(f"{long}\n\n```\n{long}\n```\n| {long} |\n$$a\n{long}$$\n- {long}\n") == [1, 9]
