"""Metrics of steadiness: variation of a signal while its reference is constant."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt

from pliant.errors import ShapeError
from pliant.spatial import Array
from pliant.telemetry.metrics import error_of

SETTLED = 0.5  # s that are left out after each change of the reference


def swing(value: Array, wanted: Array, period: float, window: float = 1.0) -> float:
    """Largest standard deviation of a signal in windows with a constant reference, as a share of the reference.

    Args:
        value: (n,) in equal steps.
        wanted: (n,), not zero where it stands still.
        period: of the samples, s.
        window: s; windows begin half a second after each change of `wanted` and follow each other.

    Returns:
        A share: 0.03 is 3 %; NaN where no window is whole.

    Raises:
        ShapeError: the shapes differ or there is no sample.
    """
    found = [float(np.std(part) / abs(asked)) for part, asked in _windows(value, wanted, period, window)]
    return max(found, default=np.nan)


def largest_line(
    value: Array, wanted: Array, period: float, window: float = 1.0, band: tuple[float, float] = (2.0, 100.0)
) -> float:
    """Largest amplitude of a sine in a signal while its reference is constant, as a share of the reference: a limit
    cycle.

    Args:
        value: (n,) in equal steps.
        wanted: (n,), not zero where it stands still.
        period: of the samples, s.
        window: s, as `swing`.
        band: lowest and highest frequency, Hz.

    Returns:
        A share; NaN where no window is whole. A sine of amplitude a in the middle of a step of the spectrum shows a,
        between two steps at least 0.85 a.

    Raises:
        ShapeError: the shapes differ or there is no sample.
    """
    found: list[float] = []
    for part, asked in _windows(value, wanted, period, window):
        hann = np.hanning(len(part) + 1)[:-1]
        amplitude = 2.0 * np.abs(np.fft.rfft((part - np.mean(part)) * hann)) / np.sum(hann)
        frequency = np.fft.rfftfreq(len(part), period)
        inside = (frequency >= band[0]) & (frequency <= band[1])
        found.append(float(np.max(amplitude[inside], initial=0.0)) / abs(asked))
    return max(found, default=np.nan)


def _windows(value: Array, wanted: Array, period: float, window: float) -> list[tuple[npt.NDArray[np.float64], float]]:
    """Complete windows, with the reference in each."""
    error_of(value, wanted)  # the shapes
    if value.ndim != 1:
        raise ShapeError(f"the steadiness of one signal (n,), got an array of shape {value.shape}")
    length, skipped = round(window / period), round(SETTLED / period)
    change = np.flatnonzero(np.abs(np.diff(wanted)) > 1e-9 * np.max(np.abs(wanted), initial=1e-300)) + 1
    edges = [0, *change.tolist(), len(value)]
    found: list[tuple[npt.NDArray[np.float64], float]] = []
    for begin, end in pairwise(edges):
        if wanted[begin] == 0.0:
            continue
        starts = range(begin + skipped, end - length + 1, length)
        found += [(value[start : start + length], float(wanted[begin])) for start in starts]
    return found
