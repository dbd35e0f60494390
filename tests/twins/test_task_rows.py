"""The compiled rows of a task, their parts and previews, against the same in Python."""

from __future__ import annotations

import numpy as np
import pytest

from pliant._references import RowsAhead, columns_of, parts_of
from pliant.interfaces import CLOCK_ROUNDING
from pliant.spatial import Array
from tests.twins.task_rows_twin import Height, RowsAheadTwin, StretchTwin, parts_twin, preview_twin

RANDOM = np.random.default_rng(5)
WIDTH = 57 + 7
_PHASES, _RATES = RANDOM.normal(size=WIDTH), RANDOM.normal(size=WIDTH)
OFFSET = np.array([0.1, -0.2, 0.3])
HEIGHTS: list[Height | None] = [None, (0.02, 0.0, 0.0), (0.02, -0.3, 4.0)]


def rows_of(times: Array) -> Array:
    return np.sin(_PHASES + np.multiply.outer(times, _RATES))


def same(ours: object, theirs: object) -> None:
    assert isinstance(ours, np.ndarray)
    np.testing.assert_array_equal(ours, theirs)


def clocks() -> list[tuple[float, float]]:
    """(time, period) of ticks: regular, back, on, and with no period."""
    regular = [(1e-3 * tick, 1e-3) for tick in range(700)]
    jumps = [(0.1, 1e-3), (0.101, 1e-3), (0.4, 0.0), (0.4004, 0.0), (5.0, 1e-3), (5.001, 1e-3)]
    slower = [(6.0 + 4e-3 * tick, 4e-3) for tick in range(300)]
    return [*regular, *jumps, *slower, (0.0, 0.0), (0.0, 4e-3)]


def test_a_clock_of_every_kind_gets_the_rows_of_the_twin() -> None:
    core, twin = RowsAhead(rows_of, CLOCK_ROUNDING), RowsAheadTwin(rows_of)
    table, nodes = np.empty((6, WIDTH)), 0.007 + 0.003 * np.arange(6)
    for time, period in clocks():
        same(core.row(time, period), twin.row(time, period))
        core.fill(table, 0, 6, time + nodes, 0.0, period, None, ())
        same(table, twin.rows(time + nodes))
        core.fill(table, 2, 5, time + 0.3 * nodes, 0.0, period, None, ())
        same(table[2:5], twin.rows((time + 0.3 * nodes)[2:5]))
    assert not np.array_equal(core.row(0.5, 0.0), twin.row(0.501, 0.0)), "another instant"


@pytest.mark.parametrize("height", HEIGHTS)
@pytest.mark.parametrize("offset", [None, OFFSET])
def test_the_parts_of_a_row_are_those_of_the_twin(offset: Array | None, height: Height | None) -> None:
    core, row = RowsAhead(rows_of, CLOCK_ROUNDING), rows_of(np.array([0.25]))[0]
    for found in (parts_of(row, offset, height or ()), core.task(0.25, 0.0, offset, height or ())):
        for ours, theirs in zip(found, parts_twin(row, offset, height), strict=True):
            same(ours, theirs)
            assert ours is not None
            assert not ours.flags.writeable
    other = parts_twin(row, OFFSET + 1e-9, (0.02, -0.3, 4.0 + 1e-9))
    for place in (0, 3):
        assert not np.array_equal(parts_of(row, OFFSET, (0.02, -0.3, 4.0))[place], other[place])
    assert parts_of(row[:57], None, ())[-1] is None


@pytest.mark.parametrize("height", HEIGHTS)
def test_a_preview_is_that_of_the_twin(height: Height | None) -> None:
    core, nodes = RowsAhead(rows_of, CLOCK_ROUNDING), 0.003 * np.arange(6)
    found = core.preview(0.5, nodes, 0.2, 0.0, OFFSET, height or (), True, WIDTH)
    times = 0.5 + nodes
    same(found[0], times)
    rows = RowsAheadTwin(rows_of).rows(times - 0.2)
    whole = preview_twin([StretchTwin(rows, OFFSET, [height] * 6 if height else [])])
    for ours, theirs in zip(found[1:], whole, strict=True):
        same(ours, theirs)
    assert core.preview(0.5, nodes, 0.2, 0.0, None, (), False, 57)[5:] == (None, None)
    early = core.preview(0.5, nodes, 0.2 - 1e-6, 0.0, OFFSET, height or (), True, WIDTH)
    assert not np.array_equal(early[1], whole[0]), "another start"


def test_a_preview_of_two_phases_is_that_of_the_twin() -> None:
    first, second = RowsAhead(rows_of, CLOCK_ROUNDING), RowsAhead(lambda times: rows_of(times)[:, :57].copy(), 1e-9)
    table, times = np.empty((6, 57)), 0.5 + 0.003 * np.arange(6)
    heights: list[Height] = [(0.01 * k, 0.1, 2.0) for k in range(4)]
    first.fill(table, 0, 2, times, 0.2, 1e-3, OFFSET, ())
    second.fill(table, 2, 6, times, 0.505, 1e-3, None, [part for height in heights for part in height])
    twins = [
        StretchTwin(rows_of(np.round(times[:2] - 0.2, 9)), OFFSET, []),
        StretchTwin(rows_of(np.round(times[2:] - 0.505, 9))[:, :57], None, heights),
    ]
    found = columns_of(times, table, True)
    assert found[0] is times
    assert found[5] is None
    for ours, theirs in zip((*found[1:5], found[6]), (*preview_twin(twins)[:4], preview_twin(twins)[5]), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-15)
        assert ours is not None
        assert ours.base is table
    swapped = preview_twin([twins[0], twins[1]._replace(heights=heights[::-1])])
    assert not np.allclose(found[1], swapped[0], atol=1e-6), "heights of other nodes"


def test_parts_that_do_not_fit_are_refused() -> None:
    table, times, row = np.empty((6, WIDTH)), np.linspace(0.0, 1.0, 6), np.zeros(WIDTH)
    core = RowsAhead(rows_of, CLOCK_ROUNDING)
    core.fill(table, 0, 6, times, 0.0, 0.0, None, ())  # control
    for begin, end, given in ((3, 3, times), (0, 7, times), (0, 5, times[:5])):
        with pytest.raises(ValueError, match="a row for each time"):
            core.fill(table, begin, end, given, 0.0, 0.0, None, ())
    with pytest.raises(ValueError, match="fewer numbers"):
        core.fill(np.empty((6, WIDTH + 1)), 0, 6, times, 0.0, 0.0, None, ())
    with pytest.raises(ValueError, match="height"):
        core.fill(table, 0, 6, times, 0.0, 0.0, None, [0.0] * 4)
    with pytest.raises(ValueError, match="three float64"):
        parts_of(row, np.zeros(2), ())
    with pytest.raises(ValueError, match="57 numbers"):
        parts_of(row[:56], None, ())
    with pytest.raises(ValueError, match="three numbers"):
        parts_of(row, None, [0.0])
    with pytest.raises(ValueError, match="57 numbers"):
        columns_of(times, np.empty((6, 56)), False)
    for rows in (lambda _: np.zeros((1, 57)), lambda times: rows_of(times)[:, ::2], lambda _: None):
        with pytest.raises(ValueError, match="a row of float64 for each time"):
            RowsAhead(rows, CLOCK_ROUNDING).fill(table, 0, 6, times, 0.0, 0.0, None, ())  # type: ignore[arg-type]
