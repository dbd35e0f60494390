"""Base class of pools for the tasks of a sweep, and the simplest one: this process."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True)
class Lost:
    """A task that was started several times and whose process died each time."""

    reason: str


class Pool(Protocol):
    """Does tasks."""

    def __call__(self, function: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[int, R | Lost]]:
        """Yields the index of each task with the result of the function, in the order in which they finish."""
        ...


def in_this_process(function: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[int, R | Lost]]:
    """Runs the tasks one after the other, in this process."""
    for index, task in enumerate(tasks):
        yield index, function(task)
