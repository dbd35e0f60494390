"""The compiled spline against the same in Python."""

from __future__ import annotations

import bisect

import numpy as np
import pytest

from pliant._references import Spline as CompiledSpline
from pliant.references.trajectories.spline import Spline
from pliant.spatial import Array

REGULAR = np.linspace(0.5, 2.5, 9)
IRREGULAR = np.cumsum([0.5, 0.1, 0.4, 0.2, 0.3, 0.25])


def in_python(times: Array, values: Array, pieces: Array, time: float) -> Array:
    """Value, rate and acceleration (3k,): powers of the time since the piece began, times its coefficients."""
    zero = np.zeros(2 * values.shape[1])
    if time < times[0]:
        return np.concatenate([values[0], zero])
    if time > times[-1]:
        return np.concatenate([values[-1], zero])
    piece = min(bisect.bisect_right(times.tolist(), time) - 1, len(pieces) - 1)
    t = time - times[piece]
    return np.array([1.0, t, t**2, t**3]) @ pieces[piece]


@pytest.mark.parametrize("times", [REGULAR, IRREGULAR], ids=["regular", "irregular"])
@pytest.mark.parametrize("rests", [False, True])
def test_it_is_its_twin(times: Array, rests: bool) -> None:
    values = np.random.default_rng(3).normal(size=(len(times), 5))
    spline = Spline(times, values, rests)
    asked = np.concatenate([times, times[:-1] + 0.37 * np.diff(times), [times[0] - 1.0, times[-1] + 1.0]])
    whole = np.hstack(spline.rows(asked))
    for time, row in zip(asked.tolist(), whole, strict=True):
        twin = in_python(times, values, spline._table, time)
        assert np.allclose(spline.row(time), twin, rtol=1e-12, atol=1e-12)
        assert np.allclose(spline.row(time), row, rtol=1e-12, atol=1e-12)
        assert np.array_equal(np.concatenate(spline.at(time)), spline.row(time))
    other = in_python(times, values, np.roll(spline._table, 1, axis=0), asked[-4])
    assert not np.allclose(spline.row(asked[-4]), other, atol=1e-3), "another piece's coefficients"


def test_what_it_gives_is_the_callers() -> None:
    spline = Spline(REGULAR, np.random.default_rng(4).normal(size=(9, 2)))
    for time in (0.0, 1.0, 9.0):
        before = spline.row(time)
        spline.row(time)[:] = 7.0
        spline.at(time).value[:] = 7.0
        assert np.array_equal(spline.row(time), before)


def test_parts_that_do_not_fit_are_refused() -> None:
    table, row = np.zeros((2, 4, 3)), np.zeros(3)
    assert CompiledSpline([0.0, 1.0, 2.0], 1.0, table, row.tolist(), row.tolist()).at(0.5, row) is None
    for times, pieces, first in (([0.0], table, row), ([0.0, 1.0], table, row), ([0.0, 1.0, 2.0], table, row[:2])):
        with pytest.raises(ValueError, match=r"spline|coefficients"):
            CompiledSpline(times, 1.0, pieces, first.tolist(), row.tolist())
    spline = Spline(REGULAR, np.zeros((9, 2)))
    with pytest.raises(ValueError, match="must be a number"):
        spline.at(float("nan"))
