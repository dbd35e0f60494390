"""Wall times of the stages of the loop. They differ from run to run, so they stay out of the log."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pliant.spatial import Array
from pliant.stopwatch import percentiles
from pliant.telemetry.output import write_text

_KEPT = 100_000  # latest periods whose times are kept for the percentiles


class Timing:
    """Collects seconds per stage, in bounded memory."""

    def __init__(self) -> None:
        self._names: tuple[str, ...] = ()
        self._times: Array = np.empty((0, _KEPT))
        self._count = 0

    def add(self, wall: Mapping[str, float]) -> None:
        """Takes the times of one period: stage → s. Stages that the first period lacks are left out."""
        self._take(wall, self._count % _KEPT, 1)

    def add_block(self, wall: Mapping[str, Array]) -> None:
        """The same of several periods, at most as many as are kept: stage → (k,) s."""
        count = min(map(len, wall.values()), default=0)
        self._take(wall, np.arange(self._count, self._count + count) % _KEPT, count)

    def _take(self, wall: Mapping[str, Any], columns: int | npt.NDArray[np.intp], count: int) -> None:
        if not self._count:
            self._names = tuple(wall)
            self._times = np.full((len(wall), _KEPT), np.nan)
        for row, name in enumerate(self._names):
            self._times[row, columns] = wall.get(name, np.nan)
        self._count += count

    def summary(self) -> dict[str, dict[str, float]]:
        """Stage → mean, median, 90th and 99th percentile, maximum in µs, over the latest 100 000 periods, and their
        number."""
        found: dict[str, dict[str, float]] = {}
        for name, row in zip(self._names, self._times[:, : min(self._count, _KEPT)], strict=True):
            times = row[np.isfinite(row)] * 1e6
            if times.size:
                of = percentiles(times)
                found[name] = {
                    "count": int(times.size),
                    "mean_us": float(times.mean()),
                    "p50_us": of["median"],
                    "p90_us": of["p90"],
                    "p99_us": of["p99"],
                    "max_us": of["max"],
                }
        return found

    def write(self, path: Path) -> None:
        """Writes the summary as JSON.

        Raises:
            OutputError: the file cannot be written.
        """
        write_text(path, json.dumps(self.summary(), indent=2) + "\n")
