"""The clock of a loop with a live page: wall time, slow motion, pause, single steps."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from pliant.live.link.messages import Flow

_BEHIND = 0.1  # s that a loop may lag before it gives up catching up
_IDLE = 0.02  # s between two looks at the mailbox while paused


@dataclass(frozen=True, slots=True)
class PaceReport:
    """Speed of the loop since the last report."""

    real_time_factor: float
    playing: bool


class Pace:
    """Paces a clock. Between two periods, and while it waits, it calls `attend`, which may change `flow` or `stop`.

    Args:
        period: s of simulated time per tick.
        attend: handles messages; returns quickly.
        wait: sleeps until a message may have arrived, at most the given number of s.
        paced: False: as fast as possible.
    """

    def __init__(
        self, period: float, attend: Callable[[], None], wait: Callable[[float], object], *, paced: bool = True
    ) -> None:
        self.period, self.flow = period, Flow()
        self.steps = 0
        """periods still to be made while paused"""
        self.stopped = False
        self._attend, self._wait, self._paced = attend, wait, paced
        self._mark = (time.perf_counter(), 0)
        self._factor = 0.0
        self._ticks = 0

    def __call__(self, ticks: Iterable[object]) -> Iterator[object]:
        """The same items, each when it is due; ends early when `stopped`."""
        due = time.perf_counter()
        for item in ticks:
            due = self._until_due(due)
            if self.stopped:
                return
            self._ticks += 1
            yield item
            due += self.period / self.flow.speed
        self._ticks += 1

    def report(self) -> PaceReport:
        """What happened since the last report, which was at least half a second ago."""
        now = time.perf_counter()
        start, ticks = self._mark
        if now - start >= 0.5:
            self._factor = (self._ticks - ticks) * self.period / (now - start)
            self._mark = (now, self._ticks)
        return PaceReport(self._factor, self.flow.playing)

    def _until_due(self, due: float) -> float:
        """Waits until `due`. Returns the time at which the tick was due; pauses and lag shift it."""
        self._attend()
        while not self.stopped:
            if not self.flow.playing:
                if self.steps > 0:
                    self.steps -= 1
                    return time.perf_counter()
                self._wait(_IDLE)
                self._attend()
                due = time.perf_counter()
                continue
            lag = time.perf_counter() - due
            if not self._paced or lag >= 0.0:
                return due if lag < _BEHIND else due + lag
            time.sleep(min(-lag, _IDLE))
            if lag < -_IDLE:
                self._attend()
        return due
