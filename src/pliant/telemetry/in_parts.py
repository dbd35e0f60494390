"""Means, extremes and columns of channels that are read in parts (`Log.parts`), so that a long log needs no more memory
than a short one."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from pliant.errors import ShapeError
from pliant.spatial import Array


def mean(parts: Iterable[Array]) -> Array:
    """Mean over the samples of all parts.

    Args:
        parts: (k, …) each.

    Returns:
        (…), in the unit of the argument.

    Raises:
        ShapeError: there is no sample.
    """
    total, count = np.zeros(()), 0
    for part in parts:
        total = total + np.sum(part, axis=0)
        count += len(part)
    if not count:
        raise _none()
    return total / count


def largest(values: Iterable[Array | float]) -> Array:
    """Largest value per entry over all parts; NaN where one is.

    Args:
        values: of each part, all of one shape (…).

    Returns:
        (…).

    Raises:
        ShapeError: there is no part.
    """
    found: Array | None = None
    for value in values:
        found = np.asarray(value, dtype=np.float64) if found is None else np.maximum(found, value)
    if found is None:
        raise _none()
    return found


def of_steps(metric: Callable[[Array, float], float], parts: Iterable[tuple[Array, ...]], period: float) -> float:
    """A metric that is a mean over the steps from sample to sample, of the steps of all parts.

    Args:
        metric: of samples (k, …) and their period, as `metrics.torque_variation` and `metrics.switch_rate`.
        parts: one channel's, each with the sample before it.
        period: s.

    Raises:
        ShapeError: there is no step.
    """
    total, steps = 0.0, 0
    for (part,) in parts:
        if len(part) > 1:
            total += metric(part, period) * (len(part) - 1)
            steps += len(part) - 1
    if not steps:
        raise _none()
    return total / steps


def _none() -> ShapeError:
    return ShapeError("a metric needs at least one sample, got none: is the window outside the run?")
