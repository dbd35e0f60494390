"""References worked out ahead in arrays: the same as one by one, and worked out once."""

from __future__ import annotations

import numpy as np
import pytest

from pliant._references import RowsAhead
from pliant.interfaces import CLOCK_ROUNDING, Lookahead
from pliant.references.trajectories.excerpt import Excerpt, TurningExcerpt
from pliant.references.trajectories.rotation import Fixed, QuaternionSpline, Turning, WarpedTurning
from pliant.references.trajectories.time_scaling import EaseIn, Scale
from pliant.references.trajectories.trajectory import Hold, Trajectory
from pliant.references.trajectories.waypoints import Waypoints
from pliant.spatial import Array
from tests.references.test_phases import _estimate, _source
from tests.references.test_trajectories import smooth_trajectories

TIMES = np.concatenate([np.arange(0.0, 6.0, 0.037), [1.5, 2.0, 3.0, 5.0]])  # s; before, at and after ends
RANDOM = np.random.default_rng(3)


def _trajectories() -> dict[str, Trajectory]:
    wave = smooth_trajectories()
    return {
        **wave,
        "held": Hold([1.0, 2.0]),
        "part": Excerpt(wave["spline"], 0.3, 2.0),
        "ramp": Waypoints([0.5, 2.0], [[0.0], [3.0]], "ramp"),
        "steps": Waypoints([0.5, 2.0], [[0.0], [3.0]], "step"),
    }


def _turnings() -> dict[str, Turning]:
    turning = QuaternionSpline(np.linspace(0.0, 3.0, 8), RANDOM.normal(size=(8, 4)))
    return {
        "fixed": Fixed(np.eye(3)),
        "turning": turning,
        "eased": WarpedTurning(turning, EaseIn(1.0)),
        "scaled": WarpedTurning(turning, Scale(0.5)),
        "part": TurningExcerpt(turning, 0.5, 2.0),
    }


@pytest.mark.parametrize("one", [*_trajectories().values(), *_turnings().values()], ids=lambda one: type(one).__name__)
def test_rows_are_what_single_times_give_whatever_their_neighbours(one: Trajectory | Turning) -> None:
    together, apart = one.rows(TIMES), [one.at(float(time)) for time in TIMES]
    for part, table in enumerate(together):
        np.testing.assert_allclose(table, np.array([found[part] for found in apart]), rtol=1e-12, atol=1e-12)
        alone = np.concatenate([one.rows(TIMES[i : i + 1])[part] for i in range(len(TIMES))])
        np.testing.assert_array_equal(table, alone)
    if not isinstance(one, Hold | Fixed):  # control: other times have other rows
        assert not np.allclose(one.rows(TIMES + 0.2)[0], together[0], atol=1e-6)


class Counted:
    """Rows (m, 57): time, its square, and zeros. Counts the times that it was asked for."""

    def __init__(self) -> None:
        self.asked: list[float] = []

    def __call__(self, times: Array) -> Array:
        self.asked += times.tolist()
        return np.pad(np.column_stack([times, times**2]), ((0, 0), (0, 55)))


def counted_row(time: float) -> Array:
    time = round(time, 9)
    return np.array([time, time**2])


def ahead(samples: RowsAhead, times: Array, start: float = 0.0) -> Array:
    """Time and square (m, 2) that it gives ahead of a clock of 1 kHz."""
    table = np.empty((len(times), 57))
    samples.fill(table, 0, len(times), times, start, 1e-3, None, ())
    return table[:, :2]


def test_each_tick_of_a_clock_is_worked_out_once_and_nodes_ahead_are_among_them() -> None:
    counted = Counted()
    samples = RowsAhead(counted, CLOCK_ROUNDING)
    for tick in range(200):
        time = 1e-3 * tick
        np.testing.assert_array_equal(samples.row(time, 1e-3)[:2], counted_row(time))
        later = time + 0.005 + 0.003 * np.arange(6)
        np.testing.assert_array_equal(ahead(samples, later), np.array([counted_row(float(t)) for t in later]))
    assert len(set(counted.asked)) == len(counted.asked) < 200 + 128
    ahead(samples, np.array([0.2005, 0.2015]))  # control: instants between ticks are worked out beside
    assert 0.2005 in counted.asked


@pytest.mark.parametrize("begin", [0.1, 0.1004])
def test_ticks_of_a_clock_that_has_not_begun_are_worked_out_once_too(begin: float) -> None:
    """Previews reach into a phase before its first tick, which is later than its begin by a part of a period."""
    counted = Counted()
    samples = RowsAhead(counted, CLOCK_ROUNDING)
    first = 1e-3 * np.ceil(begin / 1e-3 - 1e-6)
    for tick in range(300):
        time = 1e-3 * tick
        if time >= first - 1e-9:
            found = samples.row(time - begin, 1e-3)[:2]
            np.testing.assert_allclose(found, counted_row(time - begin), rtol=1e-14)
        later = time + 0.003 * np.arange(6)
        later = later[later >= first - 1e-9]
        if len(later):
            wanted = np.array([counted_row(max(float(t) - begin, 0.0)) for t in later])
            np.testing.assert_allclose(ahead(samples, later, begin), wanted, rtol=1e-14)
    assert len(set(counted.asked)) == len(counted.asked) < 200 + 128
    samples.row(0.1 + 0.3e-3, 1e-3)  # control: a clock with other ticks is worked out anew
    assert len(counted.asked) > 2 * 128


def test_a_clock_that_goes_back_jumps_or_stutters_gets_its_own_rows() -> None:
    samples = RowsAhead(Counted(), CLOCK_ROUNDING)
    for time, period in [(0.0, 0.0), (0.001, 0.001), (0.05, 0.0), (0.002, 0.001), (9.0, 0.001), (9.0004, 0.0)]:
        np.testing.assert_array_equal(samples.row(time, period)[:2], counted_row(time))
        np.testing.assert_array_equal(ahead(samples, np.array([time + 0.01])), [counted_row(time + 0.01)])


def test_a_task_says_the_same_to_a_regular_and_to_an_irregular_clock() -> None:
    """The regular one's references are worked out ahead, the other one's when they are asked for."""
    ahead = Lookahead(5, 0.003, 0.002)
    regular, irregular = _source(found=False, lookahead=ahead), _source(found=False, lookahead=ahead)
    state, other = regular.init(_estimate(0.0)), irregular.init(_estimate(0.0))
    for tick in range(300):
        found, state = regular.step(_estimate(1e-3 * tick), state)
        if tick % 7 in (0, 1, 4):
            said, other = irregular.step(_estimate(1e-3 * tick), other)
            assert found.preview is not None
            assert said.preview is not None
            for name in ("position", "velocity", "acceleration", "wrench"):
                np.testing.assert_allclose(getattr(found.tasks[0], name), getattr(said.tasks[0], name), atol=1e-12)
            np.testing.assert_allclose(found.preview.position, said.preview.position, atol=1e-12)
            np.testing.assert_allclose(found.preview.wrench, said.preview.wrench, atol=1e-12)
            assert found.preview.phase == said.preview.phase
