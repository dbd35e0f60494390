"""Cubic splines through samples: two continuous derivatives, evaluated in a few microseconds."""

from __future__ import annotations

import numpy as np

from pliant._references import Spline as CompiledSpline
from pliant._values import Views
from pliant.references.trajectories.trajectory import Point, Trajectory
from pliant.spatial import Array


class Spline(Trajectory):
    """The cubic spline through samples. Its end slopes are those of the cubics through the first and last four samples,
    or zero.

    Before the first sample the first value is held, after the last one the last.

    Args:
        times: (m,) s, increasing, m ≥ 2.
        values: (m, k).
        rests: whether it begins and ends at rest.
    """

    def __init__(self, times: Array, values: Array, rests: bool = False) -> None:
        slopes = _spline_slopes(times, values, rests)
        h = np.diff(times)[:, None]
        chord = np.diff(values, axis=0) / h
        c_2 = (3.0 * chord - 2.0 * slopes[:-1] - slopes[1:]) / h
        c_3 = (slopes[:-1] + slopes[1:] - 2.0 * chord) / h**2
        self._table = _with_derivatives(values[:-1], slopes[:-1], c_2, c_3)
        self._starts = np.array(times, dtype=np.float64)
        self._last_piece = len(self._table) - 1
        steps = np.diff(times)
        self._step = float(steps[0]) if np.allclose(steps, steps[0], rtol=1e-9, atol=0.0) else 0.0
        self.size, self.duration = int(values.shape[1]), float(times[-1])
        k = self.size
        self._value, self._rate, self._acceleration = slice(0, k), slice(k, 2 * k), slice(2 * k, 3 * k)
        zero = np.zeros(k)
        self._first = Point(values[0].copy(), zero, zero)
        self._last = Point(values[-1].copy(), zero, zero)
        ends = [np.concatenate(end).tolist() for end in (self._first, self._last)]
        self._core = CompiledSpline(self._starts.tolist(), self._step, self._table, *ends)
        self._parts = Views([(0, k), (k, k), (2 * k, k)]).of

    def at(self, time: float) -> Point:
        return Point(*self._parts(self.row(time)))

    def row(self, time: float) -> Array:
        """Value, rate and acceleration (3k,) at a time in s, side by side."""
        row = np.empty(3 * self.size)
        self._core.at(time, row)
        return row

    def table(self, times: Array) -> Array:
        """`row` (k, 3 size) at each of several times (k,) in s."""
        rows = np.empty((len(times), 3 * self.size))
        self._core.rows(times, rows)
        return rows

    def rows(self, times: Array) -> Point:
        starts = self._starts
        index = np.clip(np.searchsorted(starts, times, side="right") - 1, 0, self._last_piece)
        if self._step > 0.0:
            inside = np.minimum(np.maximum(times - starts[0], 0.0) / self._step, self._last_piece)
            index = inside.astype(np.intp)
        t, c = (times - starts[index])[:, None], self._table[index]
        table = c[:, 0] + t * c[:, 1] + (t * t) * c[:, 2] + (t * t * t) * c[:, 3]
        for outside, held in ((times > starts[-1], self._last), (times < starts[0], self._first)):
            if outside.any():
                table[outside] = np.concatenate(held)
        return Point(table[:, self._value], table[:, self._rate], table[:, self._acceleration])


def _with_derivatives(c_0: Array, c_1: Array, c_2: Array, c_3: Array) -> Array:
    """Coefficients (m-1, 4, 3k) of value, rate and acceleration side by side: one product gives all three."""
    zero = np.zeros_like(c_0)
    value = np.stack([c_0, c_1, c_2, c_3], axis=1)
    rate = np.stack([c_1, 2.0 * c_2, 3.0 * c_3, zero], axis=1)
    acceleration = np.stack([2.0 * c_2, 6.0 * c_3, zero, zero], axis=1)
    return np.concatenate([value, rate, acceleration], axis=2)


def _spline_slopes(times: Array, values: Array, rests: bool) -> Array:
    """Slopes (m, k) at the samples that make the second derivative continuous (tridiagonal system, ends given)."""
    count = times.shape[0]
    if count == 2:
        if rests:
            return np.zeros_like(values)
        return np.repeat(np.diff(values, axis=0) / np.diff(times)[:, None], 2, axis=0)
    h = np.diff(times)
    chord = np.diff(values, axis=0) / h[:, None]
    slopes = np.empty_like(values)
    slopes[0] = 0.0 if rests else _end_slope(times[:4], values[:4])
    slopes[-1] = 0.0 if rests else _end_slope(times[-1:-5:-1], values[-1:-5:-1])
    # h_i d_{i-1} + 2 (h_{i-1} + h_i) d_i + h_{i-1} d_{i+1} = 3 (h_i c_{i-1} + h_{i-1} c_i), eliminated forwards
    right = 3.0 * (h[1:, None] * chord[:-1] + h[:-1, None] * chord[1:])
    right[0] -= h[1] * slopes[0]
    right[-1] -= h[-2] * slopes[-1]
    diagonal = 2.0 * (h[:-1] + h[1:])
    for i in range(1, count - 2):
        factor = h[i + 1] / diagonal[i - 1]
        diagonal[i] -= factor * h[i - 1]
        right[i] -= factor * right[i - 1]
    slopes[-2] = right[-1] / diagonal[-1]
    for i in range(count - 4, -1, -1):
        slopes[i + 1] = (right[i] - h[i] * slopes[i + 2]) / diagonal[i]
    return slopes


def _end_slope(times: Array, values: Array) -> Array:
    """Slope (k,) at the first of up to four samples, of the polynomial through them."""
    t = times - times[0]
    weights = np.linalg.solve(np.vander(t, increasing=True).T, np.eye(t.shape[0])[1])
    return weights @ values
