"""Tables of many rows of text, in the look of those of rich, drawn faster."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import zip_longest

from rich.console import Console

_NARROWEST = 6  # characters of a column


@dataclass
class PlainTable:
    """A title, headings, and rows of texts that are wrapped where the console is narrow."""

    title: str
    headings: Sequence[str]
    kept: int = 1
    """leading columns that are not wrapped: what the user has to type"""
    rows: list[Sequence[str]] = field(default_factory=list[Sequence[str]])
    breaks: set[int] = field(default_factory=set[int])
    """numbers of rows above which a line is drawn"""

    def column(self, place: int) -> list[str]:
        """The texts of a column, without its heading."""
        return [row[place] for row in self.rows]

    def print(self, console: Console) -> None:
        """Prints it. Args: console: gives the width."""
        widths = self._widths(console.width)
        rule = ["━" * (width + 2) for width in widths]
        console.print(self.title, style="italic", markup=False, highlight=False)
        head = ["┏" + "┳".join(rule) + "┓", *_lines(self.headings, widths, "┃"), "┡" + "╇".join(rule) + "┩"]
        console.print("\n".join(head), style="bold", markup=False, highlight=False, soft_wrap=True)
        between = [line.replace("━", "─") for line in rule]
        lines: list[str] = []
        for place, row in enumerate(self.rows):
            if place in self.breaks:
                lines.append("├" + "┼".join(between) + "┤")
            lines += _lines(row, widths, "│")
        console.out("\n".join((*lines, "└" + "┴".join(between) + "┘")), highlight=False)

    def _widths(self, room: int) -> list[int]:
        """Of the longest texts; the widest columns are narrowed until the table fits."""
        columns = zip(self.headings, *self.rows, strict=True)
        widths = [max(map(len, texts)) for texts in columns]
        excess = sum(widths) + 3 * len(widths) + 1 - room
        wrapped = range(self.kept, len(widths))
        for _ in range(excess):
            widest = max(wrapped, key=lambda place: widths[place])
            widths[widest] = max(widths[widest] - 1, _NARROWEST)
        return widths


def _lines(cells: Sequence[str], widths: Sequence[int], bar: str) -> list[str]:
    wrapped = [
        [cell] if len(cell) <= width else textwrap.wrap(cell, width) for cell, width in zip(cells, widths, strict=True)
    ]
    rows = zip_longest(*wrapped, fillvalue="")
    joint = f" {bar} "
    return [
        f"{bar} {joint.join(part.ljust(width) for part, width in zip(row, widths, strict=True))} {bar}" for row in rows
    ]
