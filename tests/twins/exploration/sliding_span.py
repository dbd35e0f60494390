"""Largest minus smallest value over a sliding window of time, at a constant cost per sample."""

from __future__ import annotations

from collections import deque


class SlidingSpan:
    """Span of the samples within a time window. Changed in place."""

    __slots__ = ("_falling", "_rising")

    def __init__(self) -> None:
        # Candidates for the maximum and the minimum: each later one is smaller, or larger, than those before it.
        self._falling: deque[tuple[float, float]] = deque()
        self._rising: deque[tuple[float, float]] = deque()

    def clear(self) -> None:
        """Forgets everything."""
        self._falling.clear()
        self._rising.clear()

    def add(self, time: float, value: float, oldest: float) -> float:
        """Takes a sample, drops those before `oldest`, s. Returns the span."""
        falling, rising = self._falling, self._rising
        while falling and falling[-1][1] <= value:
            falling.pop()
        while rising and rising[-1][1] >= value:
            rising.pop()
        sample = (time, value)
        falling.append(sample)
        rising.append(sample)
        while falling[0][0] < oldest:
            falling.popleft()
        while rising[0][0] < oldest:
            rising.popleft()
        return falling[0][1] - rising[0][1]
