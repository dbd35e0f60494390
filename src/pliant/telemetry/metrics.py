"""Metrics: pure functions of arrays.

Each takes the samples that it is to judge: cut the window with `between` first, and pass the true signals where there
are any. A sample that is not finite makes the result NaN, which meets no target, so that a failure cannot look good. SI
units throughout; `n` is the number of samples, `k` of axes or joints.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from pliant.errors import ShapeError
from pliant.spatial import Array

AUTHORS_WINDOW = 21  # samples of the moving average that the authors of [FFMPC] apply before they compute errors


def between(time: Array, begin: float, end: float = math.inf) -> npt.NDArray[np.bool_]:
    """Which samples lie in begin ≤ t < end. Args: time (n,) s; begin, end s. Returns: (n,) mask."""
    rounding = 1e-9  # s; sample times are sums of periods
    return (time >= begin - rounding) & (time < end - rounding)


# ---------------------------------------------------------------------- errors


def rmse(actual: Array, reference: Array) -> Array:
    """Root mean square error per axis, `sqrt(mean_t (actual − reference)²)`.

    Args:
        actual: (n, k) or (n,).
        reference: the same shape.

    Returns:
        (k,), or a 0-d array; in the unit of the arguments.

    Raises:
        ShapeError: the shapes differ or there is no sample.
    """
    return np.sqrt(np.mean(error_of(actual, reference) ** 2, axis=0))


def rms_error(actual: Array, reference: Array) -> float:
    """Root mean square error over time and axes, in the unit of the arguments (n,) or (n, k). Raises ShapeError as
    `rmse`."""
    return math.sqrt(float(np.mean(error_of(actual, reference) ** 2)))


def mae(actual: Array, reference: Array) -> float:
    """Mean absolute error over time and axes, in the unit of the arguments (n,) or (n, k). Raises ShapeError as `rmse`.

    Of the world-z force it is E_λ, of the horizontal position (n, 2) E_P, of desired against measured torque (n, k)
    E_τ, as [FFMPC] defines them in section VI.
    """
    return float(np.mean(np.abs(error_of(actual, reference))))


def max_error(actual: Array, reference: Array) -> float:
    """Largest absolute error over time and axes, in the unit of the arguments. Raises ShapeError as `rmse`."""
    return float(np.max(np.abs(error_of(actual, reference))))


def moving_average(values: Array, window: int = AUTHORS_WINDOW) -> Array:
    """Centred moving average, as the authors of [FFMPC] smooth before they compute their errors. For the variant
    beside, never instead.

    Args:
        values: (n,) or (n, k).
        window: samples, odd; near the ends the window shrinks to what is there, equally on both sides.

    Returns:
        The same shape and unit.

    Raises:
        ShapeError: no sample, or the window is not odd and positive.
    """
    values = some_values(values)
    if window < 1 or window % 2 == 0:
        raise ShapeError(f"the window of a centred moving average must be an odd number of samples, got {window}")
    n = values.shape[0]
    index = np.arange(n)
    half = np.minimum(window // 2, np.minimum(index, n - 1 - index))
    sums = np.concatenate((np.zeros((1, *values.shape[1:])), np.cumsum(values, axis=0)))
    counts = (2 * half + 1).reshape(-1, *(1,) * (values.ndim - 1))
    return (sums[index + half + 1] - sums[index - half]) / counts


# ---------------------------------------------------------------------- torque


def torque_variation(torque: Array, period: float) -> float:
    """Torque variation: mean over joints and time of `|τ_t − τ_{t−1}| / T_s`.

    Args:
        torque: (n, k) N·m of successive ticks, none left out.
        period: T_s, s.

    Returns:
        N·m/s.

    Raises:
        ShapeError: fewer than two samples.
    """
    return float(np.mean(np.abs(_steps(torque)))) / period


def peak(values: Array) -> float:
    """Largest magnitude over time and axes, in the unit of the argument. For torques: peak torque, N·m; for f_z:
    λ_max, N.

    Raises:
        ShapeError: there is no sample.
    """
    return float(np.max(np.abs(some_values(values))))


def torque_step_fraction(torque: Array, limits: Array) -> float:
    """Largest change of torque from one tick to the next as a fraction of the joint's limit.

    Args:
        torque: (n, k) N·m.
        limits: (k,) N·m.

    Returns:
        A fraction: 0.15 is 15 %.

    Raises:
        ShapeError: fewer than two samples.
    """
    return float(np.max(np.abs(_steps(torque)) / limits))


# ---------------------------------------------------------------------- phases and energy


def switch_rate(phase: npt.NDArray[np.generic], period: float) -> float:
    """Switches of phase per second, mean over axes.

    Args:
        phase: (n,) or (n, k) a number per phase.
        period: s between two samples.

    Returns:
        1/s.

    Raises:
        ShapeError: fewer than two samples.
    """
    changes = _steps(np.asarray(phase, dtype=np.float64)) != 0.0
    return float(np.mean(changes)) / period


def storage_margin(supplied: Array, stored: Array) -> float:
    """Passivity margin of a port: the smallest of `supplied_t − (stored_t − stored_0)` over time.

    Args:
        supplied: (n,) J, energy that went in through the port up to each sample.
        stored: (n,) J.

    Returns:
        J. At 0 or above the port gave out no more than it had; below, it made that much energy.

    Raises:
        ShapeError: the shapes differ or there is no sample.
    """
    gained = error_of(stored, np.full_like(some_values(stored), stored[0]))
    return float(np.min(error_of(supplied, np.full_like(supplied, supplied[0])) - gained))


# ---------------------------------------------------------------------- checks


def error_of(actual: Array, reference: Array) -> Array:
    actual, reference = some_values(actual), np.asarray(reference, dtype=np.float64)
    if actual.shape != reference.shape:
        raise ShapeError(f"a metric needs two arrays of one shape, got {actual.shape} and {reference.shape}")
    return actual - reference


def some_values(values: npt.ArrayLike) -> Array:
    array = np.asarray(values, dtype=np.float64)
    if array.ndim == 0 or array.shape[0] == 0:
        raise ShapeError("a metric needs at least one sample, got none: is the window outside the run?")
    return array


def _steps(values: npt.ArrayLike) -> Array:
    array = some_values(values)
    if array.shape[0] < 2:
        raise ShapeError("a rate of change needs at least two samples, got one")
    return np.diff(array, axis=0)
