"""Standard normal numbers for compiled code: drawn in blocks, each source from its own generator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pliant.simulation.seeding import generator
from pliant.spatial import Array

_BLOCK = 64  # rows that are drawn at once


@dataclass(slots=True)
class Draws:
    """Rows of numbers, one per correction of the torque loop: the same numbers as drawn one row after the other."""

    generators: dict[str, np.random.Generator]
    """source → its generator; of a source without noise nothing is drawn"""
    columns: Mapping[str, tuple[int, int]]
    """source → its columns, from and to"""
    block: Array
    """(rows, width)"""
    row: int
    """that comes next; as many as there are: a new block is due"""

    @classmethod
    def start(cls, seed: int, widths: Mapping[str, int], noisy: Mapping[str, bool], ticks: int) -> Draws:
        """Args: seed: of the run; widths: source → numbers a row, in the order of the columns; noisy: whether a source
        draws at all; ticks: rows that are taken at once."""
        columns: dict[str, tuple[int, int]] = {}
        end = 0
        for source, width in widths.items():
            columns[source] = (end, end + width)
            end += width
        rows = ticks * -(-_BLOCK // ticks)
        made = {source: generator(seed, source) for source in widths if noisy[source]}
        return cls(made, columns, np.zeros((rows, end)), rows)

    def single(self, sources: tuple[str, ...]) -> Array:
        """One row (width,) outside the order, drawn from some sources alone; zeros from the others."""
        row = np.zeros(self.block.shape[1])
        for source in sources:
            if source in self.generators:
                begin, end = self.columns[source]
                row[begin:end] = self.generators[source].standard_normal(end - begin)
        return row

    def ahead(self, count: int) -> Array:
        """The rows (count, width) that come next, which stay to be taken. Args: count: a multiple of what is taken at
        once."""
        if len(self.block) - self.row < count:
            more = np.zeros((count, self.block.shape[1]))
            self._draw(more)
            self.block, self.row = np.concatenate([self.block[self.row :], more]), 0
        return self.block[self.row : self.row + count]

    def pass_by(self, count: int) -> None:
        """Takes rows that `ahead` has given."""
        self.row += count

    def take(self, count: int) -> Array:
        """The next rows (count, width)."""
        if self.row >= len(self.block):
            self._draw(self.block)
            self.row = 0
        self.row += count
        return self.block[self.row - count : self.row]

    def _draw(self, block: Array) -> None:
        for source, drawn in self.generators.items():
            begin, end = self.columns[source]
            block[:, begin:end] = drawn.standard_normal((len(block), end - begin))
