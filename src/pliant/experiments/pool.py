"""What a place is where the tasks of a sweep are done, and the simplest one: this process."""

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
        """Yields the index of each task with what the function returned, in the order in which they end."""
        ...


def in_this_process(function: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[int, R | Lost]]:
    """One after the other, without any other process."""
    for index, task in enumerate(tasks):
        yield index, function(task)
