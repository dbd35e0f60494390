"""The rows of the file that a path comes from, so that what is said about the path can name a line."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from pliant.spatial import Array


@dataclass(frozen=True)
class PathRows:
    """Points of a file, laid where the path is."""

    file: Path
    lines: tuple[int, ...]
    """(k,) line of each point in the file"""
    places: Array
    """(k, 3) m, in the world"""
    paced_by: Literal["", "time", "speed"] = ""
    """what of the file says how fast: its times, its speeds (of APT: feed rates), or nothing"""
    seconds: float | None = None
    """s from the first row to the last one by the file's times, where these set the pace"""

    def line_near(self, place: npt.ArrayLike) -> int:
        """Line of the row to which the stretch leads that is nearest to a place (3,) m."""
        starts, ways = self.places[:-1], np.diff(self.places, axis=0)
        off = np.asarray(place, dtype=np.float64) - starts
        along = np.sum(off * ways, axis=1) / np.maximum(np.sum(ways * ways, axis=1), 1e-18)
        left = off - np.clip(along, 0.0, 1.0)[:, None] * ways
        return self.lines[int(np.argmin(np.linalg.norm(left, axis=1))) + 1]

    def told_of(self, place: npt.ArrayLike) -> str:
        """The line of a place (3,) m, to be put behind what is said of that place."""
        return f", on the way to line {self.line_near(place)} of {self.file.name}"
