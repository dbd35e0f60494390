"""What is wrong with a TOML file, in words that name key and line."""

from __future__ import annotations

import re
import tomllib

_TWICE = ("Cannot overwrite", "Cannot declare", "Cannot redefine", "Cannot mutate", "Duplicate")
"""begin of what Python says of a key or table that stands there twice; of tables it names neither, or no line"""
_TABLE = re.compile(r"\s*\[\[?\s*([^\[\]=#]+?)\s*\]\]?\s*(?:#.*)?")
_KEY = re.compile(r"\s*((?:\"[^\"]*\"|'[^']*'|[^=#\"'])+?)\s*=")


def toml_sentence(text: str, error: ValueError) -> str:
    """Args: text: of the file; error: what Python says of it. Other errors than doubled keys are told as they are."""
    if not str(error).startswith(_TWICE):
        return str(error)
    lines = text.splitlines()
    found = re.search(r"at line (\d+)", str(error))
    row = _statement(lines, len(lines) if found is None else int(found[1]))
    if row is None:
        return str(error)
    key, first = _key_at(lines, row), _first_line(lines, row)
    since = "" if first is None else f", the first time in line {first + 1}"
    return f"line {row + 1}: key {key!r} stands there twice{since}"


def _statement(lines: list[str], end: int) -> int | None:
    """Number, from 0, of the line with which the statement begins that fails at a line `end`, counted from 1: all
    before it can be read."""
    for row in range(min(end, len(lines)) - 1, -1, -1):
        try:
            tomllib.loads("\n".join(lines[:row]))
        except ValueError:
            continue
        return row
    return None


def _key_at(lines: list[str], row: int) -> str:
    """Dotted key of a line as a user writes it, with the table below which it stands."""
    table = _TABLE.fullmatch(lines[row])
    if table:
        return table[1]
    key = _KEY.match(lines[row])
    name = key[1] if key else lines[row].strip()
    above = next((found[1] for line in reversed(lines[:row]) if (found := _TABLE.fullmatch(line))), "")
    return f"{above}.{name}" if above else name


def _first_line(lines: list[str], row: int) -> int | None:
    """Number, from 0, of the line with the same key; None: it stands there in another form, or in the same line."""
    key = _key_at(lines, row)
    return next((place for place in range(row) if lines[place].strip() and _key_at(lines, place) == key), None)
