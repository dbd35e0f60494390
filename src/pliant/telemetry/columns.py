"""A log as columns of numbers, and as data frames of pandas and polars."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from pliant.errors import ConfigError, MissingExtraError
from pliant.spatial import Array


class Sampled(Protocol):
    """Channels with their times, as a log has them."""

    @property
    def channels(self) -> Mapping[str, Any]:
        """By name, each with its `shape` and `labels`."""
        ...

    def time(self, name: str) -> Array:
        """(n,) s."""
        ...

    def __getitem__(self, name: str) -> Array:
        """(n, …)."""
        ...


def columns(log: Sampled, names: Sequence[str] = ()) -> dict[str, Array]:
    """Column → (n,) values; the first is "time", s.

    Args:
        log: any log.
        names: channels; none: all that were sampled together with the first one.

    Returns:
        A scalar channel gives the column of its name, an array `name.0`, `name.1`, … or `name.LABEL`, row by row.

    Raises:
        ConfigError: an unknown channel, or channels that were not sampled at the same times.
    """
    wanted = list(names or log.channels)
    if not wanted:
        return {}
    time = log.time(wanted[0])
    found: dict[str, Array] = {"time": time}
    for name in wanted:
        if not np.array_equal(log.time(name), time):
            if names:
                raise ConfigError(f"channel {name!r} was not sampled at the times of {wanted[0]!r}: ask for it alone")
            continue
        values = log[name].reshape(len(time), -1)
        found |= {column: values[:, index] for index, column in enumerate(_headings(log, name, values.shape[1]))}
    return found


def _headings(log: Sampled, name: str, size: int) -> list[str]:
    channel = log.channels[name]
    if channel.shape == ():
        return [name]
    labels = channel.labels if len(channel.labels) == size else tuple(map(str, range(size)))
    return [f"{name}.{label}" for label in labels]


def data_frame(package: str, content: dict[str, Any]) -> Any:
    """A `DataFrame` of pandas or polars. Raises MissingExtraError if the package is not installed."""
    try:
        module = importlib.import_module(package)
    except ImportError as error:
        raise MissingExtraError(f"data frames of {package} need it: pip install {package}") from error
    return module.DataFrame(content)
