"""Compiled views of an array against NumPy's own slices."""

from __future__ import annotations

import gc
import sys

import numpy as np
import pytest

from pliant._values import NamedViews, Views
from pliant.named_rows import NamedRows


def test_views_are_numpys_slices() -> None:
    numbers = np.arange(30.0)
    whole, part, matrix = Views([(0, 30), (4, 6), (8, 3, 4)]).of(numbers)
    for ours, theirs in ((whole, numbers[:]), (part, numbers[4:10]), (matrix, numbers[8:20].reshape(3, 4))):
        assert np.array_equal(ours, theirs)
        assert (ours.strides, ours.flags.c_contiguous) == (theirs.strides, theirs.flags.c_contiguous)
        assert np.shares_memory(ours, numbers)
        assert ours.flags.writeable
    part[0] = -1.0
    assert numbers[4] == -1.0
    assert Views([(0, 30), (4, 6), (8, 3, 4)]).size == 30


def test_views_of_what_is_read_only_are_so() -> None:
    numbers = np.arange(4.0)
    numbers.setflags(write=False)
    (view,) = Views([(0, 2)]).of(numbers)
    with pytest.raises(ValueError, match="read-only"):
        view[0] = 1.0


def test_a_view_keeps_its_numbers_and_nothing_else() -> None:
    numbers = np.arange(6.0)
    before = sys.getrefcount(numbers)
    views = Views([(0, 2), (2, 2)]).of(numbers)
    assert sys.getrefcount(numbers) == before + 2
    del views
    assert sys.getrefcount(numbers) == before
    (view,) = Views([(0, 6)]).of(np.arange(6.0))
    gc.collect()
    assert view.sum() == 15.0


def test_values_by_name() -> None:
    numbers = np.arange(30.0)
    rows = NamedRows(("a", "b"), 2, 3, 3)
    found = rows.of(numbers)
    assert list(found) == ["a", "b"]
    assert np.array_equal(found["b"], numbers[11:20].reshape(3, 3))
    assert (rows.end, NamedRows((), 4, 6).of(numbers)) == (20, {})


def test_values_are_added_to_those_that_have_names() -> None:
    numbers, views = np.arange(6.0), NamedViews(["a", "b"], [(0, 2), (2, 2)])
    named: dict[str, object] = {"c": 1.0, "b": 2.0}
    before = sys.getrefcount(numbers)
    views.into(numbers, named)
    assert list(named) == ["c", "b", "a"]
    assert np.array_equal(named["b"], [2.0, 3.0])  # type: ignore[arg-type]
    named.clear()
    assert sys.getrefcount(numbers) == before
    with pytest.raises(ValueError, match="every place"):
        views.into(numbers[:3], named)


@pytest.mark.parametrize(
    "numbers", [np.zeros(4), np.zeros((2, 3)), np.zeros(6, dtype=int), np.zeros(12)[::2], [0.0] * 6, None]
)
def test_other_arrays_are_refused(numbers: object) -> None:
    assert len(Views([(0, 5)]).of(np.zeros(6))) == 1
    for views in (Views([(0, 5)]), NamedViews(["a"], [(0, 5)])):
        with pytest.raises((ValueError, TypeError)):
            views.of(numbers)  # type: ignore[arg-type]


@pytest.mark.parametrize("place", [(3,), (-1, 2), (0, -2)])
def test_places_without_a_shape_are_refused(place: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="where it begins, and its shape"):
        Views([place])
