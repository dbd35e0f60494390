"""A delay of whole periods, with the values under way in plain sight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from pliant.errors import ConfigError

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Delay(Generic[T]):
    """Gives back what it was given `periods` steps before. Its state is the queue of values under way, the oldest
    first.

    Raises:
        ConfigError: on construction, if `periods` is negative.
    """

    periods: int

    def __post_init__(self) -> None:
        if self.periods < 0:
            raise ConfigError(f"a delay must not be negative, got {self.periods} periods")

    def init(self, value: T) -> tuple[T, ...]:
        """The queue at the start: as if `value` had always been there."""
        return (value,) * self.periods

    def step(self, value: T, queue: tuple[T, ...]) -> tuple[T, tuple[T, ...]]:
        """Takes the newest value in, gives the oldest out. With 0 periods the value passes straight through."""
        waiting = (*queue, value)
        return waiting[0], waiting[1:]
