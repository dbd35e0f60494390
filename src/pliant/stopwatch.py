"""Wall and CPU times of many repetitions."""

from __future__ import annotations

import time
from collections.abc import Generator
from contextlib import contextmanager

import numpy as np
import numpy.typing as npt


class Stopwatch:
    """Collects the times of repetitions. `cpu` and `wall` are theirs in µs."""

    def __init__(self) -> None:
        self.cpu: list[float] = []
        self.wall: list[float] = []

    @contextmanager
    def timed(self, counts: bool = True) -> Generator[None]:
        """Measures the body of the `with` block; `counts=False`: a warm-up repetition."""
        wall, cpu = time.perf_counter_ns(), time.thread_time_ns()
        yield
        cpu, wall = time.thread_time_ns() - cpu, time.perf_counter_ns() - wall
        if counts:
            self.cpu.append(1e-3 * cpu)
            self.wall.append(1e-3 * wall)

    def summary(self) -> dict[str, dict[str, float]]:
        """ "cpu" and "wall" → their percentiles in µs."""
        return {"cpu": percentiles(self.cpu), "wall": percentiles(self.wall)}


def percentiles(times: npt.ArrayLike) -> dict[str, float]:
    """Median, 90th and 99th percentile and largest of times (k,), in their unit."""
    median, p90, p99 = np.percentile(np.asarray(times), [50, 90, 99])
    return {"median": float(median), "p90": float(p90), "p99": float(p99), "max": float(np.max(times))}
